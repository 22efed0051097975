// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "io/text/yaml_node.h"

namespace sextant {

/// Reads values from a YamlNode and keeps the first error, as LineReader does for lines: after an
/// error every call returns zeros or empty values.
class YamlFields {
 public:
  explicit YamlFields(std::string file) : file_(std::move(file)) {}

  /// Whether `node` is a map with only the keys `known`; the error for an unknown key suggests the
  /// most similar known one.
  bool IsMap(const YamlNode& node, std::string_view what, std::span<const std::string> known);
  bool IsSequence(const YamlNode& node, std::string_view what);
  /// The same, with at most `max_size` items.
  bool IsSequence(const YamlNode& node, std::string_view what, std::size_t max_size);

  /// The value of a key of a map; an error if it is absent.
  const YamlNode& Require(const YamlNode& map, std::string_view key);

  double Real(const YamlNode& node, std::string_view name);
  double RealAt(const YamlNode& map, std::string_view key) { return Real(Require(map, key), key); }
  /// With a default value, the key may be absent.
  double RealAt(const YamlNode& map, std::string_view key, double default_value);
  /// As RealAt; a negative number is an error.
  double NonNegativeAt(const YamlNode& map, std::string_view key, double default_value);
  int IntegerAt(const YamlNode& map, std::string_view key, int low, int high);
  int IntegerAt(const YamlNode& map, std::string_view key, int low, int high, int default_value);
  /// A text of one line.
  std::string Text(const YamlNode& node, std::string_view name);
  std::string TextAt(const YamlNode& map, std::string_view key) {
    return Text(Require(map, key), key);
  }
  /// A text that may have several lines.
  std::string ParagraphAt(const YamlNode& map, std::string_view key);
  /// A text that becomes the name of a file or folder (IsFileName).
  std::string FileName(const YamlNode& node, std::string_view name);

  /// A sequence of exactly values.size() numbers.
  void Reals(const YamlNode& node, std::string_view name, std::span<double> values);
  /// A sequence of at most `max_size` numbers.
  std::vector<double> RealList(const YamlNode& node, std::string_view name, std::size_t max_size);
  /// Three numbers of at most kMaxCoordinate_m (geometry/coordinate_range.h).
  Eigen::Vector3d Point(const YamlNode& node, std::string_view name);
  Eigen::Vector2d Point2At(const YamlNode& map, std::string_view key,
                           const Eigen::Vector2d& default_value);
  Eigen::Vector3d PointAt(const YamlNode& map, std::string_view key) {
    return Point(Require(map, key), key);
  }

  void Fail(int line, std::string_view name, std::string_view message);
  void Fail(Error error);
  bool ok() const { return !error_; }
  const std::string& file() const { return file_; }
  /// The first error. Requires !ok().
  tl::unexpected<Error> TakeError() { return tl::unexpected<Error>(*error_); }

 private:
  std::string file_;
  std::optional<Error> error_;
};

}  // namespace sextant
