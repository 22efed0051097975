// SPDX-License-Identifier: Apache-2.0
#include "io/text/json_as_yaml.h"

#include <fmt/core.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/text/escape.h"
#include "io/text/yaml_text.h"

namespace sextant {
namespace {

using Json = nlohmann::ordered_json;

bool IsOneLine(const Json& value) {
  if (value.is_object()) return false;
  return !value.is_array() || std::all_of(value.begin(), value.end(), [](const Json& item) {
    return !item.is_structured() && !item.is_string();
  });
}

std::string OneLine(const Json& value) {
  if (value.is_array()) {
    std::string text;
    for (const Json& item : value) text += (text.empty() ? "" : ", ") + OneLine(item);
    return "[" + text + "]";
  }
  if (value.is_string()) return YamlQuoted(value.get<std::string>());
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());
  return JsonLine(value);
}

void Write(const Json& value, std::size_t indent, std::string& text);

// The first line of an item follows its dash.
void WriteItem(const Json& item, std::size_t indent, std::string& text) {
  text += std::string(indent, ' ') + "- ";
  if (IsOneLine(item)) {
    text += OneLine(item) + "\n";
    return;
  }
  std::string lines;
  Write(item, indent + 2, lines);
  text += lines.substr(std::min(indent + 2, lines.size()));
}

void WriteEntry(const std::string& key, const Json& value, std::size_t indent, std::string& text) {
  text += std::string(indent, ' ') + key + ":";
  if (IsOneLine(value)) {
    text += " " + OneLine(value) + "\n";
    return;
  }
  text += "\n";
  Write(value, indent + 2, text);
}

void Write(const Json& value, std::size_t indent, std::string& text) {
  if (value.is_array()) {
    for (const Json& item : value) WriteItem(item, indent, text);
    return;
  }
  for (const auto& entry : value.items()) {
    if (!entry.value().is_null()) WriteEntry(entry.key(), entry.value(), indent, text);
  }
}

}  // namespace

std::string JsonAsYaml(const Json& map) {
  std::string text;
  Write(map, 0, text);
  return text;
}

}  // namespace sextant
