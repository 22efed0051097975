// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/npy_cloud.h"

#include <fmt/core.h>

#include <charconv>
#include <optional>

#include "base/text/path_text.h"
#include "io/clouds/cloud_builder.h"
#include "io/clouds/scalar_type.h"
#include "io/text/number_text.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

constexpr std::size_t kMaxNpyHeader = std::size_t{1} << 16;

struct NpyArray {
  ScalarType type = ScalarType::kFloat32;
  bool big_endian = false;
  bool by_columns = false;  // Fortran's order.
  std::size_t rows = 0;
  std::size_t columns = 0;
  std::string_view numbers{};
};

tl::unexpected<Error> RefuseNpy(const std::string& file, std::size_t byte, std::string_view what) {
  return MakeError(ErrorCode::kParse, fmt::format("{}: byte {}: {}", PathText(file), byte, what));
}

// What follows `'key':` in the header, a Python dictionary, without blanks before it.
std::string_view ValueOf(std::string_view header, std::string_view key) {
  const std::size_t at = header.find(fmt::format("'{}':", key));
  if (at == std::string_view::npos) return {};
  const std::string_view value = header.substr(at + key.size() + 3);
  return value.substr(std::min(value.find_first_not_of(' '), value.size()));
}

bool TakeType(std::string_view descr, NpyArray& array) {
  if (descr.size() < 5 || descr[0] != '\'' || descr[4] != '\'') return false;
  const std::string_view kind = descr.substr(2, 2);
  array.big_endian = descr[1] == '>';
  array.type = kind == "f4" ? ScalarType::kFloat32 : ScalarType::kFloat64;
  return (descr[1] == '<' || descr[1] == '>') && (kind == "f4" || kind == "f8");
}

// "(rows, columns)".
bool TakeShape(std::string_view shape, NpyArray& array) {
  if (!shape.starts_with('(')) return false;
  const char* const end = shape.data() + shape.size();
  const auto rows = std::from_chars(shape.data() + 1, end, array.rows);
  if (rows.ec != std::errc() || end - rows.ptr < 2 || *rows.ptr != ',') return false;
  const char* second = rows.ptr + 1;
  while (second < end && *second == ' ') ++second;
  const auto columns = std::from_chars(second, end, array.columns);
  return columns.ec == std::errc() && columns.ptr < end && *columns.ptr == ')';
}

// The header's text; its length is 2 bytes in version 1, 4 bytes later.
std::optional<std::string_view> HeaderOf(std::string_view bytes) {
  constexpr std::size_t kVersion = kNpyMagic.size();
  if (bytes.size() < kVersion + 2) return std::nullopt;
  const bool is_short = bytes[kVersion] == 1;
  const std::size_t begin = kVersion + (is_short ? 4 : 6);
  if (bytes.size() < begin) return std::nullopt;
  const double size = LoadScalar(bytes.data() + kVersion + 2,
                                 is_short ? ScalarType::kUint16 : ScalarType::kUint32, false);
  if (size > static_cast<double>(std::min(bytes.size() - begin, kMaxNpyHeader))) {
    return std::nullopt;
  }
  return bytes.substr(begin, static_cast<std::size_t>(size));
}

Expected<NpyArray> ParseNpyArray(std::string_view bytes, const std::string& file) {
  const std::optional<std::string_view> header = HeaderOf(bytes);
  if (!header) return RefuseNpy(file, kNpyMagic.size(), "expected the header of a .npy file");
  NpyArray array;
  if (!TakeType(ValueOf(*header, "descr"), array)) {
    return RefuseNpy(file, kNpyMagic.size(),
                     fmt::format("expected numbers of type float32 or float64, got {}; save "
                                 "numpy.stack([x, y, z], axis=1)",
                                 Quoted(ValueOf(*header, "descr").substr(0, 20))));
  }
  if (!TakeShape(ValueOf(*header, "shape"), array) || array.columns < 3 || array.columns > 6 ||
      array.rows == 0) {
    return RefuseNpy(file, kNpyMagic.size(),
                     fmt::format("expected an array of points x 3 to 6 columns, got the shape {}",
                                 Quoted(ValueOf(*header, "shape").substr(0, 20))));
  }
  array.by_columns = ValueOf(*header, "fortran_order").starts_with("True");
  const auto begin = static_cast<std::size_t>(header->data() + header->size() - bytes.data());
  array.numbers = bytes.substr(begin);
  const std::size_t row_bytes = array.columns * SizeOf(array.type);
  if (array.numbers.size() % row_bytes != 0 || array.numbers.size() / row_bytes != array.rows) {
    return RefuseNpy(
        file, bytes.size(),
        fmt::format("the header states {} x {} numbers, the file has room for {}", array.rows,
                    array.columns, array.numbers.size() / SizeOf(array.type)));
  }
  return array;
}

}  // namespace

Expected<PointCloud> ReadNpyCloud(const std::filesystem::path& path) {
  return ReadWith(path, ParseNpyCloud);
}

Expected<PointCloud> ParseNpyCloud(std::string_view bytes, const std::string& file) {
  SEXTANT_ASSIGN_OR_RETURN(const NpyArray array, ParseNpyArray(bytes, file));
  const auto number = [&array](std::size_t row, std::size_t column) {
    const std::size_t place =
        array.by_columns ? column * array.rows + row : row * array.columns + column;
    return LoadScalar(array.numbers.data() + place * SizeOf(array.type), array.type,
                      array.big_endian);
  };
  bool has_rings = array.columns == 5;
  for (std::size_t row = 0; has_rings && row < array.rows; ++row) {
    has_rings = IsRingNumber(number(row, 4));
  }
  CloudBuilder builder(UnnamedColumns(array.columns, has_rings), array.rows);
  for (std::size_t row = 0; row < array.rows; ++row) {
    SEXTANT_RETURN_IF_ERROR(builder.Add([&](std::size_t column) { return number(row, column); }));
  }
  return std::move(builder).Finish();
}

}  // namespace sextant
