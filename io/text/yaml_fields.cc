// SPDX-License-Identifier: Apache-2.0
#include "io/text/yaml_fields.h"

#include <fmt/core.h>

#include <algorithm>

#include "base/nearest_name.h"
#include "base/text/code_point.h"
#include "base/text/file_name.h"
#include "geometry/coordinate_range.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

const YamlNode kNothing;

const char* KindName(const YamlNode& node) {
  switch (node.kind) {
    case YamlNode::Kind::kNull:
      return "nothing";
    case YamlNode::Kind::kText:
      return "a single value";
    case YamlNode::Kind::kSequence:
      return "a list";
    case YamlNode::Kind::kMap:
      return "a map";
  }
  return "something else";
}

}  // namespace

void YamlFields::Fail(Error error) {
  if (ok()) error_ = std::move(error);
}

void YamlFields::Fail(int line, std::string_view name, std::string_view message) {
  Fail(
      {ErrorCode::kParse,
       fmt::format("{}: {}", ToString(Place{.file = file_, .line = line, .name = name}), message)});
}

bool YamlFields::IsMap(const YamlNode& node, std::string_view what,
                       std::span<const std::string> known) {
  if (!ok()) return false;
  if (node.kind != YamlNode::Kind::kMap) {
    Fail(node.line, what, fmt::format("expected a map, got {}", KindName(node)));
    return false;
  }
  for (std::size_t i = 0; i < node.keys.size(); ++i) {
    const std::string& key = node.keys[i];
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    Fail(node.items[i].line, what,
         fmt::format("unknown key {}; {}", Quoted(key), SuggestName(key, known)));
    return false;
  }
  return true;
}

bool YamlFields::IsSequence(const YamlNode& node, std::string_view what) {
  if (!ok()) return false;
  if (node.kind == YamlNode::Kind::kSequence) return true;
  Fail(node.line, what, fmt::format("expected a list, got {}", KindName(node)));
  return false;
}

bool YamlFields::IsSequence(const YamlNode& node, std::string_view what, std::size_t max_size) {
  if (!IsSequence(node, what)) return false;
  if (node.items.size() <= max_size) return true;
  Fail(node.line, what,
       fmt::format("expected at most {} items, got {}", max_size, node.items.size()));
  return false;
}

const YamlNode& YamlFields::Require(const YamlNode& map, std::string_view key) {
  if (!ok()) return kNothing;
  if (const YamlNode* found = map.Find(key)) return *found;
  Fail(map.line, key, "expected this key, but it is missing");
  return kNothing;
}

double YamlFields::Real(const YamlNode& node, std::string_view name) {
  if (!ok()) return 0.0;
  if (node.kind != YamlNode::Kind::kText) {
    Fail(node.line, name, fmt::format("expected a number, got {}", KindName(node)));
    return 0.0;
  }
  Expected<double> value = ParseFinite(node.text, {.file = file_, .line = node.line, .name = name});
  if (value) return *value;
  Fail(std::move(value.error()));
  return 0.0;
}

double YamlFields::RealAt(const YamlNode& map, std::string_view key, double default_value) {
  const YamlNode* found = ok() ? map.Find(key) : nullptr;
  return found == nullptr ? default_value : Real(*found, key);
}

double YamlFields::NonNegativeAt(const YamlNode& map, std::string_view key, double default_value) {
  const double value = RealAt(map, key, default_value);
  if (value < 0.0) {
    Fail(map.Find(key)->line, key, fmt::format("expected zero or more, got {}", value));
  }
  return value;
}

int YamlFields::IntegerAt(const YamlNode& map, std::string_view key, int low, int high) {
  const YamlNode& node = Require(map, key);
  if (!ok()) return 0;
  Expected<std::int64_t> value =
      ParseInteger(node.text, low, high, {.file = file_, .line = node.line, .name = key});
  if (value) return static_cast<int>(*value);
  Fail(std::move(value.error()));
  return 0;
}

int YamlFields::IntegerAt(const YamlNode& map, std::string_view key, int low, int high,
                          int default_value) {
  return ok() && map.Find(key) != nullptr ? IntegerAt(map, key, low, high) : default_value;
}

std::string YamlFields::Text(const YamlNode& node, std::string_view name) {
  if (!ok()) return {};
  if (node.kind != YamlNode::Kind::kText) {
    Fail(node.line, name, fmt::format("expected text, got {}", KindName(node)));
    return {};
  }
  if (IsPlainLine(node.text)) return node.text;
  Fail(node.line, name, fmt::format("expected text of one line, got {}", Quoted(node.text)));
  return {};
}

std::string YamlFields::ParagraphAt(const YamlNode& map, std::string_view key) {
  const YamlNode& node = Require(map, key);
  if (node.kind != YamlNode::Kind::kText) return Text(node, key);
  return ok() ? node.text : std::string();
}

std::string YamlFields::FileName(const YamlNode& node, std::string_view name) {
  std::string text = Text(node, name);
  if (!ok() || IsFileName(text)) return text;
  Fail(node.line, name,
       fmt::format("expected a name for a file: {}; got {}", kFileNameRule, Quoted(text)));
  return {};
}

void YamlFields::Reals(const YamlNode& node, std::string_view name, std::span<double> values) {
  if (!IsSequence(node, name)) return;
  if (node.items.size() != values.size()) {
    Fail(node.line, name,
         fmt::format("expected {} numbers, got {}", values.size(), node.items.size()));
    return;
  }
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = Real(node.items[i], name);
}

std::vector<double> YamlFields::RealList(const YamlNode& node, std::string_view name,
                                         std::size_t max_size) {
  std::vector<double> values;
  if (!IsSequence(node, name)) return values;
  if (node.items.size() > max_size) {
    Fail(node.line, name,
         fmt::format("expected at most {} numbers, got {}", max_size, node.items.size()));
    return values;
  }
  for (const YamlNode& item : node.items) values.push_back(Real(item, name));
  return values;
}

Eigen::Vector2d YamlFields::Point2At(const YamlNode& map, std::string_view key,
                                     const Eigen::Vector2d& default_value) {
  const YamlNode* found = ok() ? map.Find(key) : nullptr;
  if (found == nullptr) return default_value;
  Eigen::Vector2d point = Eigen::Vector2d::Zero();
  Reals(*found, key, {point.data(), 2});
  return point;
}

Eigen::Vector3d YamlFields::Point(const YamlNode& node, std::string_view name) {
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  Reals(node, name, {point.data(), 3});
  if (ok() && !(point.array().abs() <= kMaxCoordinate_m).all()) {
    Fail(node.line, name,
         fmt::format("expected coordinates up to {:g} m, got {:g} {:g} {:g}; are they in metres?",
                     kMaxCoordinate_m, point.x(), point.y(), point.z()));
  }
  return point;
}

}  // namespace sextant
