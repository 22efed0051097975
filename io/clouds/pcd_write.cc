// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <lzf.h>

#include <cassert>
#include <cmath>
#include <cstring>
#include <functional>
#include <iterator>
#include <vector>

#include "io/clouds/pcd_file.h"

namespace sextant {
namespace {

// A field to write: a float or two unsigned bytes.
struct PcdColumn {
  const char* name;
  bool is_ring = false;
  std::function<double(std::size_t)> value;

  std::size_t size() const { return is_ring ? sizeof(std::uint16_t) : sizeof(float); }
};

std::vector<PcdColumn> ColumnsOf(const PointCloud& cloud) {
  std::vector<PcdColumn> columns;
  const char* const names[] = {"x", "y", "z"};
  for (int axis = 0; axis < 3; ++axis) {
    columns.push_back(
        {names[axis], false, [&cloud, axis](std::size_t i) { return cloud.points[i][axis]; }});
  }
  if (!cloud.intensity.empty()) {
    columns.push_back({"intensity", false, [&cloud](std::size_t i) {
                         return static_cast<double>(cloud.intensity[i]);
                       }});
  }
  if (!cloud.ring.empty()) {
    columns.push_back(
        {"ring", true, [&cloud](std::size_t i) { return static_cast<double>(cloud.ring[i]); }});
  }
  if (!cloud.time_s.empty()) {
    columns.push_back({"time", false, [&cloud](std::size_t i) { return cloud.time_s[i]; }});
  }
  return columns;
}

std::string Header(const std::vector<PcdColumn>& columns, std::size_t points,
                   std::string_view encoding) {
  std::string fields;
  std::string sizes;
  std::string types;
  std::string counts;
  for (const PcdColumn& column : columns) {
    fields += fmt::format(" {}", column.name);
    sizes += fmt::format(" {}", column.size());
    types += column.is_ring ? " U" : " F";
    counts += " 1";
  }
  return fmt::format(
      "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS{}\nSIZE{}\nTYPE{}\n"
      "COUNT{}\nWIDTH {}\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS {}\nDATA {}\n",
      fields, sizes, types, counts, points, points, encoding);
}

void AppendAscii(const PcdColumn& column, std::size_t point, std::string& text) {
  const double value = column.value(point);
  if (std::isnan(value)) {
    text += "nan";
  } else if (column.is_ring) {
    fmt::format_to(std::back_inserter(text), "{}", static_cast<int>(value));
  } else {
    fmt::format_to(std::back_inserter(text), "{}", static_cast<float>(value));
  }
}

void AppendBytes(const PcdColumn& column, std::size_t point, std::string& data) {
  char bytes[sizeof(float)];
  if (column.is_ring) {
    const auto value = static_cast<std::uint16_t>(column.value(point));
    std::memcpy(bytes, &value, sizeof(value));
  } else {
    const auto value = static_cast<float>(column.value(point));
    std::memcpy(bytes, &value, sizeof(value));
  }
  data.append(bytes, column.size());
}

// Two sizes, then liblzf's stream.
std::string Compressed(const std::string& data) {
  // Incompressible data grows by one byte in 32.
  std::string packed(data.size() + data.size() / 16 + 64, '\0');
  const unsigned size = data.empty()
                            ? 0
                            : lzf_compress(data.data(), static_cast<unsigned>(data.size()),
                                           packed.data(), static_cast<unsigned>(packed.size()));
  assert(data.empty() || size > 0);
  packed.resize(size);
  const std::uint32_t sizes[] = {size, static_cast<std::uint32_t>(data.size())};
  std::string body(sizeof(sizes), '\0');
  std::memcpy(body.data(), sizes, sizeof(sizes));
  return body + packed;
}

}  // namespace

std::string FormatPcd(const PointCloud& cloud, PcdEncoding encoding) {
  const std::vector<PcdColumn> columns = ColumnsOf(cloud);
  const std::size_t points = cloud.points.size();
  if (encoding == PcdEncoding::kBinaryCompressed) {
    std::string data;
    for (const PcdColumn& column : columns) {
      for (std::size_t i = 0; i < points; ++i) AppendBytes(column, i, data);
    }
    return Header(columns, points, ToString(encoding)) + Compressed(data);
  }
  const bool is_ascii = encoding == PcdEncoding::kAscii;
  std::string text = Header(columns, points, ToString(encoding));
  for (std::size_t i = 0; i < points; ++i) {
    for (std::size_t k = 0; k < columns.size(); ++k) {
      if (!is_ascii) {
        AppendBytes(columns[k], i, text);
        continue;
      }
      if (k > 0) text += ' ';
      AppendAscii(columns[k], i, text);
    }
    if (is_ascii) text += '\n';
  }
  return text;
}

}  // namespace sextant
