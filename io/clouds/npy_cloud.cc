// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/npy_cloud.h"

#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/text/path_text.h"
#include "io/clouds/cloud_builder.h"
#include "io/clouds/scalar_type.h"
#include "io/text/number_text.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

constexpr std::size_t kMaxNpyHeader = std::size_t{1} << 16;
constexpr std::size_t kMaxNpyColumns = 16;
constexpr std::size_t kMaxSize = std::size_t{1} << 18;  // Sums of such fields cannot overflow.

// A number of each point, or bytes that are none (padding, text).
struct NpyField {
  std::string name{};
  std::optional<ScalarType> type{};
  bool big_endian = false;
  std::size_t size = 0;
  std::size_t offset = 0;  // In a row.
};

struct NpyArray {
  std::vector<NpyField> fields{};
  bool has_names = false;
  bool by_columns = false;  // Fortran's order.
  std::size_t rows = 0;
  std::size_t row_bytes = 0;
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

// Takes the parts of a Python expression from its beginning.
class PythonReader {
 public:
  explicit PythonReader(std::string_view text) : rest_(text) {}

  bool Take(char mark) {
    SkipBlanks();
    if (!rest_.starts_with(mark)) return false;
    rest_.remove_prefix(1);
    return true;
  }
  std::optional<std::string_view> Text() {
    if (!Take('\'')) return std::nullopt;
    const std::size_t end = rest_.find('\'');
    if (end == std::string_view::npos) return std::nullopt;
    const std::string_view text = rest_.substr(0, end);
    rest_.remove_prefix(end + 1);
    return text;
  }
  std::optional<std::size_t> Number() {
    SkipBlanks();
    std::size_t number = 0;
    const auto [stop, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), number);
    if (error != std::errc()) return std::nullopt;
    rest_.remove_prefix(static_cast<std::size_t>(stop - rest_.data()));
    Take('L');  // Python 2 writes it.
    return number;
  }
  // "(3,)" or "(64, 1024)"; none for anything else.
  std::optional<std::vector<std::size_t>> Shape() {
    std::vector<std::size_t> shape;
    if (!Take('(')) return std::nullopt;
    while (!Take(')')) {
      const std::optional<std::size_t> length = Number();
      if (!length || shape.size() == 8) return std::nullopt;
      shape.push_back(*length);
      if (!Take(',') && !rest_.starts_with(')')) return std::nullopt;
    }
    return shape;
  }

 private:
  void SkipBlanks() { rest_.remove_prefix(std::min(rest_.find_first_not_of(' '), rest_.size())); }

  std::string_view rest_;
};

std::optional<ScalarType> NumberType(char kind, std::size_t size) {
  if (kind == 'f' && size == 4) return ScalarType::kFloat32;
  if (kind == 'f' && size == 8) return ScalarType::kFloat64;
  if (kind != 'i' && kind != 'u') return std::nullopt;
  const bool is_signed = kind == 'i';
  if (size == 1) return is_signed ? ScalarType::kInt8 : ScalarType::kUint8;
  if (size == 2) return is_signed ? ScalarType::kInt16 : ScalarType::kUint16;
  if (size == 4) return is_signed ? ScalarType::kInt32 : ScalarType::kUint32;
  if (size == 8) return is_signed ? ScalarType::kInt64 : ScalarType::kUint64;
  return std::nullopt;
}

// NumPy's name of a type, as "<f4"; none for objects and what NumPy does not have.
std::optional<NpyField> FieldOfType(std::string_view type) {
  constexpr std::string_view kKinds = "fiubcSUVmM";
  if (type.size() < 3 || kKinds.find(type[1]) == std::string_view::npos) return std::nullopt;
  NpyField field{.big_endian = type[0] == '>'};
  const std::optional<std::size_t> size = PythonReader(type.substr(2)).Number();
  if (!size || *size > kMaxSize / 4) return std::nullopt;
  field.size = type[1] == 'U' ? 4 * *size : *size;
  field.type = NumberType(type[1], field.size);
  return field;
}

// "[('x', '<f4'), ('', '|V4'), ('normal', '<f4', (3,))]"; several numbers under one name have none.
bool TakeFields(std::string_view descr, NpyArray& array) {
  constexpr std::size_t kMaxFields = 256;
  PythonReader in(descr);
  array.has_names = in.Take('[');
  while (array.has_names && !in.Take(']')) {
    const auto name = in.Take('(') ? in.Text() : std::nullopt;
    const auto type = name && in.Take(',') ? in.Text() : std::nullopt;
    std::optional<NpyField> field = type ? FieldOfType(*type) : std::nullopt;
    if (!field || array.fields.size() == kMaxFields) return false;
    field->name = std::string(*name);
    field->offset = array.row_bytes;
    if (in.Take(',')) {
      const std::optional<std::vector<std::size_t>> shape = in.Shape();
      if (!shape) return false;
      for (const std::size_t length : *shape) {
        if (length > kMaxSize / std::max<std::size_t>(field->size, 1)) return false;
        field->size *= length;
      }
      field->type.reset();
    }
    if (!in.Take(')')) return false;
    in.Take(',');
    array.row_bytes += field->size;
    array.fields.push_back(std::move(*field));
  }
  return array.has_names;
}

// "'<f4'" for an array of numbers without names.
std::optional<NpyField> PlainType(std::string_view descr) {
  const std::optional<std::string_view> name = PythonReader(descr).Text();
  std::optional<NpyField> field = name ? FieldOfType(*name) : std::nullopt;
  const bool is_real =
      field && (field->type == ScalarType::kFloat32 || field->type == ScalarType::kFloat64);
  return is_real ? field : std::nullopt;
}

// The product, at most `limit` + 1.
std::size_t ProductUpTo(std::size_t limit, std::span<const std::size_t> factors) {
  std::size_t product = 1;
  for (const std::size_t factor : factors) {
    if (factor == 0) return 0;
    product = factor > limit / product ? limit + 1 : product * factor;
  }
  return product;
}

// Rows of the stated columns, rows of rows (an organised cloud), or the coordinates of all points
// one after the other; false for other shapes.
bool TakeColumns(std::span<const std::size_t> shape, const NpyField& type, NpyArray& array) {
  const auto are_columns = [](std::size_t n) { return n >= 3 && n <= kMaxNpyColumns; };
  if (shape.size() != 2 && shape.size() != 3) return false;
  std::size_t columns = shape.back();
  std::span<const std::size_t> rows = shape.first(shape.size() - 1);
  if (shape.size() == 2 && !are_columns(columns) && columns > kMaxNpyColumns &&
      are_columns(shape[0])) {
    columns = shape[0];
    rows = shape.last(1);
    array.by_columns = !array.by_columns;
  }
  if (!are_columns(columns) || (shape.size() == 3 && array.by_columns)) return false;
  array.row_bytes = columns * type.size;
  array.rows = ProductUpTo(array.numbers.size(), rows);
  for (std::size_t i = 0; i < columns; ++i) {
    array.fields.push_back(type);
    array.fields.back().offset = i * type.size;
  }
  return array.rows > 0;
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
  const std::size_t at = kNpyMagic.size();
  if (!header) return RefuseNpy(file, at, "expected the header of a .npy file");
  const std::string_view descr = ValueOf(*header, "descr");
  NpyArray array{.by_columns = ValueOf(*header, "fortran_order").starts_with("True")};
  array.numbers =
      bytes.substr(static_cast<std::size_t>(header->data() + header->size() - bytes.data()));
  const std::optional<NpyField> plain = PlainType(descr);
  if (!plain && !TakeFields(descr, array)) {
    return RefuseNpy(file, at,
                     fmt::format("expected numbers of type float32 or float64, or fields with "
                                 "names, got {}; save numpy.stack([x, y, z], axis=1)",
                                 Quoted(descr.substr(0, 20))));
  }
  const auto shape = PythonReader(ValueOf(*header, "shape")).Shape();
  const bool fits = plain ? shape && TakeColumns(*shape, *plain, array)
                          : shape && ProductUpTo(array.numbers.size(), *shape) > 0;
  if (!fits) {
    return RefuseNpy(file, at,
                     fmt::format("expected an array of points x 3 to {} columns, got the shape {}",
                                 kMaxNpyColumns, Quoted(ValueOf(*header, "shape").substr(0, 20))));
  }
  if (!plain) array.rows = ProductUpTo(array.numbers.size(), *shape);
  if (array.row_bytes == 0 || array.numbers.size() % array.row_bytes != 0 ||
      array.numbers.size() / array.row_bytes != array.rows) {
    return RefuseNpy(file, bytes.size(),
                     fmt::format("the header states the shape {} with {} bytes a point, the file "
                                 "has {} bytes after it",
                                 Quoted(ValueOf(*header, "shape").substr(0, 40)), array.row_bytes,
                                 array.numbers.size()));
  }
  return array;
}

// The fields that are numbers, by their names; others have none.
Expected<CloudColumns> NpyColumns(const NpyArray& array, const std::string& file) {
  std::vector<NamedColumn> columns;
  for (const NpyField& field : array.fields) {
    columns.push_back({field.type ? field.name : "", field.type && IsInteger(*field.type)});
  }
  return AtPlace(FindCloudColumns(columns), {.file = file, .name = "descr"});
}

}  // namespace

Expected<PointCloud> ReadNpyCloud(const std::filesystem::path& path) {
  return ReadWith(path, ParseNpyCloud);
}

Expected<PointCloud> ParseNpyCloud(std::string_view bytes, const std::string& file) {
  SEXTANT_ASSIGN_OR_RETURN(const NpyArray array, ParseNpyArray(bytes, file));
  const auto number = [&array](std::size_t row, std::size_t column) {
    const NpyField& field = array.fields[column];
    const std::size_t place = array.by_columns && !array.has_names
                                  ? (column * array.rows + row) * field.size
                                  : row * array.row_bytes + field.offset;
    return LoadScalar(array.numbers.data() + place, *field.type, field.big_endian);
  };
  CloudColumns columns;
  if (array.has_names) {
    SEXTANT_ASSIGN_OR_RETURN(columns, NpyColumns(array, file));
  } else {
    bool has_rings = array.fields.size() == 5;
    for (std::size_t row = 0; has_rings && row < array.rows; ++row) {
      has_rings = IsRingNumber(number(row, 4));
    }
    columns = UnnamedColumns(array.fields.size(), has_rings);
  }
  CloudBuilder builder(columns, array.rows);
  for (std::size_t row = 0; row < array.rows; ++row) {
    const Expected<void> added =
        builder.Add([&](std::size_t column) { return number(row, column); });
    if (!added) {
      return MakeError(added.error().code,
                       fmt::format("{}: point {}: {}", PathText(file), row, added.error().message));
    }
  }
  return std::move(builder).Finish();
}

}  // namespace sextant
