// SPDX-License-Identifier: Apache-2.0
// Parses the tables and plots of an experiment file.
#include <fmt/core.h>

#include <algorithm>

#include "base/nearest_name.h"
#include "eval/experiment/definition/experiment_parser.h"
#include "eval/experiment/definition/timing.h"
#include "io/text/number_text.h"

namespace sextant {

Statistic ExperimentParser::ParseStatisticOf(const YamlNode& node, const Experiment& experiment) {
  if (!fields_.ok()) return {};
  Expected<Statistic> statistic = ParseStatistic(node.text, experiment.metrics);
  if (statistic) return *statistic;
  fields_.Fail(node.line, "statistic", statistic.error().message);
  return {};
}

std::string ExperimentParser::ParseAxis(const YamlNode& map, std::string_view key,
                                        const Experiment& experiment, bool may_be_index) {
  std::string name = fields_.TextAt(map, key);
  std::vector<std::string> known = experiment.axes;
  if (may_be_index) known.emplace_back("index");
  if (!fields_.ok() || std::find(known.begin(), known.end(), name) != known.end()) return name;
  fields_.Fail(map.Find(key)->line, key,
               fmt::format("{} is not an axis of the grid; {}", Quoted(name),
                           known.empty() ? "the grid has no axes" : SuggestName(name, known)));
  return {};
}

void ExperimentParser::ParseTables(const YamlNode& root, Experiment& experiment) {
  const YamlNode* list = fields_.ok() ? root.Find("tables") : nullptr;
  if (list == nullptr || !fields_.IsSequence(*list, "tables")) return;
  const std::vector<std::string> keys = {"title",  "columns",   "labels",
                                         "across", "intervals", "ranks"};
  for (const YamlNode& node : list->items) {
    TableSpec table;
    if (!fields_.IsMap(node, "tables", keys)) return;
    table.title = OptionalText(node, "title", "");
    if (node.Find("across") != nullptr) table.across = ParseAxis(node, "across", experiment, false);
    if (node.Find("intervals") != nullptr) table.intervals = Flag(node, "intervals");
    if (node.Find("ranks") != nullptr) {
      table.ranked = ParseMetric(node, "ranks", experiment);
      experiment.tables.push_back(std::move(table));
      continue;
    }
    const YamlNode& columns = fields_.Require(node, "columns");
    if (!fields_.IsSequence(columns, "columns")) return;
    for (const YamlNode& item : columns.items) {
      table.columns.push_back(ParseStatisticOf(item, experiment));
    }
    if (const YamlNode* labels = node.Find("labels"); labels != nullptr && fields_.ok()) {
      if (!fields_.IsSequence(*labels, "labels")) return;
      if (labels->items.size() != table.columns.size()) {
        fields_.Fail(labels->line, "labels",
                     fmt::format("expected {} labels, as many as columns, got {}",
                                 table.columns.size(), labels->items.size()));
        return;
      }
      for (std::size_t i = 0; i < table.columns.size(); ++i) {
        table.columns[i].label = fields_.Text(labels->items[i], "labels");
      }
    }
    const bool wrong_count =
        table.across.empty() ? table.columns.empty() : table.columns.size() != 1;
    if (fields_.ok() && wrong_count) {
      fields_.Fail(columns.line, "columns",
                   table.across.empty() ? "expected at least one statistic"
                                        : "expected one statistic, as the axis gives the columns");
    }
    experiment.tables.push_back(std::move(table));
  }
}

int ExperimentParser::ParseMetric(const YamlNode& map, std::string_view key,
                                  const Experiment& experiment) {
  const std::string name = fields_.TextAt(map, key);
  std::vector<std::string> known;
  for (const Metric& metric : experiment.metrics) known.push_back(metric.name);
  const auto found = std::find(known.begin(), known.end(), name);
  if (fields_.ok() && (found == known.end() || name == kTimeMetric)) {
    fields_.Fail(map.Find(key)->line, key,
                 fmt::format("unknown metric {}; {}", Quoted(name), SuggestName(name, known)));
    return 0;
  }
  return static_cast<int>(found - known.begin());
}

// What the plot shows: the type, and the data of the two axes.
void ExperimentParser::ParsePlotData(const YamlNode& node, const Experiment& experiment,
                                     PlotSpec& plot) {
  const std::vector<std::string> types = {"lines", "cdf", "coverage", "time"};
  const std::string type = OptionalText(node, "type", types.front());
  const auto found = std::find(types.begin(), types.end(), type);
  if (fields_.ok() && found == types.end()) {
    fields_.Fail(node.Find("type")->line, "type",
                 fmt::format("unknown type {}; {}", Quoted(type), SuggestName(type, types)));
    return;
  }
  plot.type = static_cast<PlotType>(found - types.begin());
  plot.max = fields_.NonNegativeAt(node, "max", 0.0);
  plot.condition = OptionalText(node, "condition", "");
  const bool is_known =
      plot.condition.empty() ||
      std::ranges::count(experiment.conditions, plot.condition, &Condition::name) > 0 ||
      !experiment.absent.empty();
  if (fields_.ok() && !is_known) {
    fields_.Fail(node.Find("condition")->line, "condition",
                 "no condition has the name " + Quoted(plot.condition));
  }
  if (plot.type == PlotType::kCdf || plot.type == PlotType::kCoverage) {
    plot.metric = ParseMetric(node, "x", experiment);
    plot.x = plot.type == PlotType::kCdf ? fields_.TextAt(node, "x") : "nominal level";
    plot.y.label = plot.type == PlotType::kCdf ? "share of all trials" : "observed share";
    return;
  }
  if (plot.type == PlotType::kTime) {
    plot.x = "median time [us]";
    if (fields_.ok() && experiment.timed_trials == 0) {
      fields_.Fail(node.line, "type", "a plot against time needs timed_trials");
    }
  } else {
    plot.x = ParseAxis(node, "x", experiment, true);
  }
  plot.y = ParseStatisticOf(fields_.Require(node, "y"), experiment);
}

void ExperimentParser::ParsePlots(const YamlNode& root, Experiment& experiment) {
  const YamlNode* list = fields_.ok() ? root.Find("plots") : nullptr;
  if (list == nullptr || !fields_.IsSequence(*list, "plots")) return;
  const std::vector<std::string> keys = {"name", "title",   "type",    "condition", "max",  "x",
                                         "y",    "x_label", "y_label", "log_x",     "log_y"};
  for (const YamlNode& node : list->items) {
    PlotSpec plot;
    if (!fields_.IsMap(node, "plots", keys)) return;
    plot.name = OptionalFileName(node, "name", fmt::format("plot{}", experiment.plots.size() + 1));
    const bool is_new = std::ranges::count(experiment.plots, plot.name, &PlotSpec::name) == 0;
    if (fields_.ok() && !is_new) {
      fields_.Fail(node.line, "name", "another plot has the name " + Quoted(plot.name));
    }
    plot.title = OptionalText(node, "title", "");
    ParsePlotData(node, experiment, plot);
    plot.x_label = OptionalText(node, "x_label", plot.x);
    plot.y_label = OptionalText(node, "y_label", plot.y.label);
    plot.log_x = Flag(node, "log_x");
    plot.log_y = Flag(node, "log_y");
    experiment.plots.push_back(std::move(plot));
  }
}

}  // namespace sextant
