// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/csv_cloud.h"

#include <fmt/core.h>

#include <limits>
#include <vector>

#include "io/clouds/cloud_builder.h"
#include "io/text/line_reader.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

std::vector<NamedColumn> ReadHeader(LineReader& in) {
  std::vector<NamedColumn> columns;
  if (!in.Require("a header line with the names of the columns")) return columns;
  for (std::size_t i = 0; i < in.field_count(); ++i) {
    columns.push_back({.name = std::string(in.Field(i))});
  }
  return columns;
}

}  // namespace

Expected<PointCloud> ReadCsvCloud(const std::filesystem::path& path) {
  return ReadWith(path, ParseCsvCloud);
}

Expected<PointCloud> ParseCsvCloud(std::string_view text, const std::string& file) {
  LineReader in(file, text, LineReader::Separator::kCommas);
  const std::vector<NamedColumn> names = ReadHeader(in);
  if (!in.ok()) return in.TakeError();
  const Expected<CloudColumns> columns = FindCloudColumns(names);
  if (!columns) {
    in.Fail(columns.error().code, columns.error().message);
    return in.TakeError();
  }
  const std::string form = fmt::format("{} values as in the header", names.size());
  CloudBuilder builder(*columns);
  while (in.Next() && in.HasFields(names.size(), form)) {
    const Expected<void> added = builder.Add([&](std::size_t column) {
      const std::string& name = names[column].name;
      const Place place{.file = file, .line = in.line(), .field = column + 1, .name = name};
      Expected<double> value = ParseFinite(in.Field(column), place);
      if (value) return *value;
      if (value.error().code == ErrorCode::kParse) in.Fail(std::move(value.error()));
      return std::numeric_limits<double>::quiet_NaN();
    });
    if (!added) in.Fail(added.error().code, added.error().message);
  }
  if (in.ok() && builder.size() == 0) {
    in.Fail(ErrorCode::kParse, "expected points after the header");
  }
  if (!in.ok()) return in.TakeError();
  return std::move(builder).Finish();
}

}  // namespace sextant
