// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/definition/experiment_parser.h"

#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <utility>

#include "base/nearest_name.h"
#include "eval/experiment/definition/timing.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

constexpr std::int64_t kMaxTrials = 1'000'000'000;
constexpr std::size_t kMaxConditions = 10'000;

const std::vector<std::string>& RootKeys() {
  static const std::vector<std::string> keys = {
      "name",         "title",        "text",       "kind",       "seed",       "trials",
      "quick_trials", "timed_trials", "same_seeds", "parameters", "conditions", "grid",
      "solvers",      "metrics",      "tables",     "plots"};
  return keys;
}

}  // namespace

Expected<Experiment> ExperimentParser::Parse(const YamlNode& root) {
  Experiment experiment;
  fields_.IsMap(root, "experiment", RootKeys());
  experiment.name =
      OptionalFileName(root, "name", std::filesystem::path(fields_.file()).stem().string());
  experiment.title = OptionalText(root, "title", experiment.name);
  if (fields_.ok() && root.Find("text") != nullptr) {
    experiment.text = fields_.ParagraphAt(root, "text");
  }
  FindKind(root);
  ParseCounts(root, experiment);
  if (!fields_.ok()) return fields_.TakeError();
  experiment.kind = kind_->name;
  experiment.trials_per_block = kind_->trials_per_block;
  experiment.metrics = kind_->metrics;
  std::vector<Draft> drafts = ParseConditions(root);
  if (const YamlNode* grid = root.Find("grid"); grid != nullptr && fields_.ok()) {
    drafts = CrossWithGrid(*grid, std::move(drafts), experiment);
  }
  MakeTrials(std::move(drafts), experiment);
  ParseTables(root, experiment);
  ParsePlots(root, experiment);
  ParseMetrics(root, experiment);
  if (!fields_.ok()) return fields_.TakeError();
  return experiment;
}

std::string ExperimentParser::OptionalText(const YamlNode& map, std::string_view key,
                                           std::string otherwise) {
  return fields_.ok() && map.Find(key) != nullptr ? fields_.TextAt(map, key) : std::move(otherwise);
}

std::string ExperimentParser::OptionalFileName(const YamlNode& map, std::string_view key,
                                               std::string otherwise) {
  YamlNode unnamed;
  unnamed.kind = YamlNode::Kind::kText;
  unnamed.line = map.line;
  unnamed.text = std::move(otherwise);
  const YamlNode* named = map.Find(key);
  return fields_.FileName(named != nullptr ? *named : unnamed, key);
}

bool ExperimentParser::Flag(const YamlNode& map, std::string_view key) {
  const std::string text = OptionalText(map, key, "false");
  if (fields_.ok() && text != "true" && text != "false") {
    fields_.Fail(map.Find(key)->line, key, "expected true or false, got " + Quoted(text));
  }
  return text == "true";
}

void ExperimentParser::ParseCounts(const YamlNode& root, Experiment& experiment) {
  const auto count = [&](std::string_view key, std::int64_t low, std::int64_t otherwise) {
    const YamlNode* node = fields_.ok() ? root.Find(key) : nullptr;
    if (node == nullptr) return static_cast<std::uint64_t>(otherwise);
    const Expected<std::int64_t> value = ParseInteger(
        node->text, low, kMaxTrials, {.file = fields_.file(), .line = node->line, .name = key});
    if (!value) fields_.Fail(value.error());
    return static_cast<std::uint64_t>(value.value_or(low));
  };
  fields_.Require(root, "trials");
  experiment.trials = count("trials", 1, 1);
  experiment.seed = count("seed", 0, 1);
  const std::uint64_t some = std::max<std::uint64_t>(20, experiment.trials / 20);
  experiment.quick_trials =
      count("quick_trials", 1, static_cast<std::int64_t>(std::min(experiment.trials, some)));
  experiment.timed_trials = count("timed_trials", 0, 0);
  experiment.same_seeds = Flag(root, "same_seeds");
}

void ExperimentParser::FindKind(const YamlNode& root) {
  const std::string name = fields_.TextAt(root, "kind");
  std::vector<std::string> known;
  for (const TrialKind& kind : kinds_) {
    known.push_back(kind.name);
    if (kind.name == name) kind_ = &kind;
  }
  if (kind_ != nullptr || !fields_.ok()) return;
  fields_.Fail(root.Find("kind")->line, "kind",
               fmt::format("unknown kind {}; {}", Quoted(name), SuggestName(name, known)));
}

void ExperimentParser::ParseMetrics(const YamlNode& root, Experiment& experiment) {
  const YamlNode* node = fields_.ok() ? root.Find("metrics") : nullptr;
  if (node == nullptr) {
    for (std::size_t i = 0; i < experiment.metrics.size(); ++i) {
      experiment.wanted[i] = experiment.metrics[i].name != kTimeMetric;
    }
    return;
  }
  if (!fields_.IsSequence(*node, "metrics")) return;
  std::vector<std::string> known;
  for (const Metric& metric : experiment.metrics) known.push_back(metric.name);
  for (const YamlNode& item : node->items) {
    if (item.text == kTimeMetric) {
      fields_.Fail(item.line, "metrics", "time differs from run to run; use timed_trials instead");
      return;
    }
    const auto found = std::find(known.begin(), known.end(), item.text);
    if (found == known.end()) {
      fields_.Fail(
          item.line, "metrics",
          fmt::format("unknown metric {}; {}", Quoted(item.text), SuggestName(item.text, known)));
      return;
    }
    experiment.wanted.set(static_cast<std::size_t>(found - known.begin()));
  }
  // Metrics that the report shows are measured as well.
  const auto want = [&experiment](const Statistic& statistic) {
    for (const int metric : {statistic.metric, statistic.reference, statistic.where}) {
      if (metric >= 0) experiment.wanted.set(static_cast<std::size_t>(metric));
    }
  };
  for (const TableSpec& table : experiment.tables) {
    for (const Statistic& column : table.columns) want(column);
    if (table.ranked >= 0) experiment.wanted.set(static_cast<std::size_t>(table.ranked));
  }
  for (const PlotSpec& plot : experiment.plots) {
    if (plot.metric < 0) want(plot.y);
    if (plot.metric >= 0) experiment.wanted.set(static_cast<std::size_t>(plot.metric));
  }
}

std::string ExperimentParser::ParseValue(const YamlNode& node, std::string_view name) {
  if (node.kind == YamlNode::Kind::kText) return fields_.Text(node, name);
  if (!fields_.IsSequence(node, name)) return {};
  std::string text;
  for (const YamlNode& item : node.items)
    text += (text.empty() ? "" : " ") + fields_.Text(item, name);
  return text;
}

OptionValues ExperimentParser::ParseParameters(const YamlNode& node,
                                               const std::vector<std::string>& besides) {
  std::vector<std::string> known = besides;
  for (const OptionDoc& parameter : kind_->parameters) known.push_back(parameter.name);
  OptionValues values;
  if (!fields_.IsMap(node, "parameters", known)) return values;
  for (std::size_t i = 0; i < node.keys.size(); ++i) {
    if (std::find(besides.begin(), besides.end(), node.keys[i]) != besides.end()) continue;
    values.emplace_back(node.keys[i], ParseValue(node.items[i], node.keys[i]));
  }
  return values;
}

std::vector<ExperimentParser::Draft> ExperimentParser::ParseConditions(const YamlNode& root) {
  OptionValues base;
  if (const YamlNode* node = root.Find("parameters")) base = ParseParameters(*node, {});
  std::vector<SolverPtr> solvers;
  if (const YamlNode* node = fields_.ok() ? root.Find("solvers") : nullptr) {
    solvers = ParseSolvers(*node);
  }
  const YamlNode* list = fields_.ok() ? root.Find("conditions") : nullptr;
  if (list == nullptr)
    return {{.condition = {.parameters = base}, .solvers = solvers, .line = root.line}};
  std::vector<Draft> drafts;
  if (!fields_.IsSequence(*list, "conditions", kMaxConditions)) return drafts;
  for (const YamlNode& node : list->items) {
    Draft draft{.condition = {.parameters = base}, .solvers = solvers, .line = node.line};
    const OptionValues own = ParseParameters(node, {"name", "solvers"});
    draft.condition.name = fields_.TextAt(node, "name");
    draft.condition.base = draft.condition.name;
    draft.condition.parameters.insert(draft.condition.parameters.end(), own.begin(), own.end());
    if (const YamlNode* special = fields_.ok() ? node.Find("solvers") : nullptr) {
      draft.solvers = ParseSolvers(*special);
    }
    if (!fields_.ok()) return {};
    drafts.push_back(std::move(draft));
  }
  if (drafts.empty()) fields_.Fail(list->line, "conditions", "expected at least one condition");
  return drafts;
}

std::vector<ExperimentParser::Draft> ExperimentParser::CrossWithGrid(const YamlNode& grid,
                                                                     std::vector<Draft> drafts,
                                                                     Experiment& experiment) {
  std::vector<std::string> known;
  for (const OptionDoc& parameter : kind_->parameters) known.push_back(parameter.name);
  if (!fields_.IsMap(grid, "grid", known)) return {};
  for (std::size_t axis = 0; axis < grid.keys.size(); ++axis) {
    const std::string& key = grid.keys[axis];
    const YamlNode& values = grid.items[axis];
    if (!fields_.IsSequence(values, key)) return {};
    experiment.axes.push_back(key);
    const std::size_t conditions = drafts.size() * values.items.size();
    if (conditions == 0 || conditions > kMaxConditions) {
      fields_.Fail(
          values.line, key,
          fmt::format("expected 1 to {} conditions in all, got {}", kMaxConditions, conditions));
      return {};
    }
    std::vector<Draft> crossed;
    for (const Draft& draft : drafts) {
      for (const YamlNode& item : values.items) {
        Draft next = draft;
        const std::string value = ParseValue(item, key);
        next.condition.parameters.emplace_back(key, value);
        next.condition.place.push_back(value);
        next.condition.name +=
            fmt::format("{}{}={}", next.condition.name.empty() ? "" : ", ", key, value);
        crossed.push_back(std::move(next));
      }
    }
    drafts = std::move(crossed);
  }
  return drafts;
}

void ExperimentParser::MakeTrials(std::vector<Draft> drafts, Experiment& experiment) {
  std::set<std::string> names;
  for (Draft& draft : drafts) {
    if (!fields_.ok()) return;
    Condition& condition = draft.condition;
    const std::string what = condition.name.empty() ? "parameters" : condition.name;
    if (!names.insert(condition.name).second) {
      fields_.Fail(draft.line, what, "a second condition has this name");
      return;
    }
    if (kind_->takes_solvers && draft.solvers.empty()) {
      fields_.Fail(draft.line, what, "expected solvers, a list with at least one entry");
      return;
    }
    Expected<TrialsPtr> trials =
        kind_->make({.parameters = condition.parameters,
                     .solvers = draft.solvers,
                     .folder = std::filesystem::path(fields_.file()).parent_path(),
                     .condition = condition.name});
    if (!trials && kind_->skips_absent_data && trials.error().code == ErrorCode::kMissingData) {
      experiment.absent.push_back(what + ": " + trials.error().message);
      continue;
    }
    if (!trials && !instead_.empty() && trials.error().code == ErrorCode::kMissingData) continue;
    if (!trials) {
      fields_.Fail(
          {trials.error().code,
           fmt::format("{}: {}",
                       ToString(Place{.file = fields_.file(), .line = draft.line, .name = what}),
                       trials.error().message)});
      return;
    }
    condition.trials = std::move(*trials);
    experiment.conditions.push_back(std::move(condition));
  }
  if (fields_.ok() && experiment.conditions.empty() && !experiment.absent.empty()) {
    fields_.Fail({ErrorCode::kMissingData, experiment.absent.front()});
  }
  if (fields_.ok() && experiment.conditions.empty()) {
    fields_.Fail(0, "solvers", "no condition has the data that these solvers need");
  }
}

}  // namespace sextant
