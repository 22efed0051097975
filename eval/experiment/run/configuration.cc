// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/run/configuration.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "base/text/escape.h"
#include "base/version.h"
#include "io/text/json_depth.h"

namespace sextant {
namespace {

// Discarded if the text is not JSON.
nlohmann::json ParsedConfiguration(const std::string& configuration) {
  if (IsJsonTooDeep(configuration)) return nlohmann::json::value_t::discarded;
  return nlohmann::json::parse(configuration, nullptr, /*allow_exceptions=*/false);
}

}  // namespace

std::string ConfigurationOf(const Experiment& experiment) {
  using nlohmann::json;
  json conditions = json::array();
  for (const Condition& condition : experiment.conditions) {
    json parameters = json::object();
    for (const auto& [name, value] : condition.parameters) parameters[name] = value;
    conditions.push_back({{"name", condition.name},
                          {"place", condition.place},
                          {"parameters", parameters},
                          {"subjects", condition.trials->subjects()}});
  }
  json metrics = json::array();
  for (std::size_t i = 0; i < experiment.metrics.size(); ++i) {
    if (experiment.wanted[i]) metrics.push_back(experiment.metrics[i].name);
  }
  const json all = {{"sextant", Version()},
                    {"name", experiment.name},
                    {"kind", experiment.kind},
                    {"seed", experiment.seed},
                    {"trials", experiment.trials},
                    {"trials_per_block", experiment.trials_per_block},
                    {"same_seeds", experiment.same_seeds},
                    {"axes", experiment.axes},
                    {"metrics", metrics},
                    {"conditions", conditions}};
  return JsonLine(nlohmann::ordered_json(all));
}

std::size_t CountMetrics(const std::string& configuration) {
  const nlohmann::json json = ParsedConfiguration(configuration);
  if (!json.is_object() || !json.contains("metrics") || !json["metrics"].is_array()) return 0;
  return json["metrics"].size();
}

std::uint64_t CountBlocks(const std::string& configuration) {
  const nlohmann::json json = ParsedConfiguration(configuration);
  const auto number = [&json](const char* key) {
    return json.is_object() && json.contains(key) && json[key].is_number_unsigned()
               ? json[key].get<std::uint64_t>()
               : 0;
  };
  const std::uint64_t size = std::max<std::uint64_t>(1, number("trials_per_block"));
  const std::uint64_t conditions =
      json.is_object() && json.contains("conditions") ? json["conditions"].size() : 0;
  return conditions * ((number("trials") + size - 1) / size);
}

}  // namespace sextant
