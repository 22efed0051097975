// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "eval/experiment/definition/experiment.h"
#include "io/text/yaml_fields.h"

namespace sextant {

/// Parses an experiment from the YAML tree of its file and keeps the first error.
class ExperimentParser {
 public:
  ExperimentParser(std::string file, const std::vector<TrialKind>& kinds,
                   const SolverRegistry& registry, const std::vector<SpecNode>& instead)
      : fields_(std::move(file)), kinds_(kinds), registry_(registry) {
    for (const SpecNode& spec : instead) instead_.push_back(FormatSpec(spec));
  }

  Expected<Experiment> Parse(const YamlNode& root);

 private:
  // A condition whose trials are not made yet.
  struct Draft {
    Condition condition;
    std::vector<SolverPtr> solvers;
    int line = 0;
  };

  void ParseCounts(const YamlNode& root, Experiment& experiment);
  void FindKind(const YamlNode& root);
  void ParseMetrics(const YamlNode& root, Experiment& experiment);
  std::vector<std::string> SpecsOf(const std::string& text) const;
  void AddSolvers(const std::string& text, int line, std::vector<SolverPtr>& solvers);
  std::vector<SolverPtr> ParseSolvers(const YamlNode& node);
  OptionValues ParseParameters(const YamlNode& node, const std::vector<std::string>& besides);
  std::string ParseValue(const YamlNode& node, std::string_view name);
  std::vector<Draft> ParseConditions(const YamlNode& root);
  std::vector<Draft> CrossWithGrid(const YamlNode& grid, std::vector<Draft> drafts,
                                   Experiment& experiment);
  void MakeTrials(std::vector<Draft> drafts, Experiment& experiment);
  Statistic ParseStatisticOf(const YamlNode& node, const Experiment& experiment);
  void ParseTables(const YamlNode& root, Experiment& experiment);
  void ParsePlots(const YamlNode& root, Experiment& experiment);
  int ParseMetric(const YamlNode& map, std::string_view key, const Experiment& experiment);
  void ParsePlotData(const YamlNode& node, const Experiment& experiment, PlotSpec& plot);
  std::string ParseAxis(const YamlNode& map, std::string_view key, const Experiment& experiment,
                        bool may_be_index);
  std::string OptionalText(const YamlNode& map, std::string_view key, std::string otherwise);
  /// A name that becomes a file's (IsFileName), the default too.
  std::string OptionalFileName(const YamlNode& map, std::string_view key, std::string otherwise);
  bool Flag(const YamlNode& map, std::string_view key);

  YamlFields fields_;
  const std::vector<TrialKind>& kinds_;
  const SolverRegistry& registry_;
  /// Solvers that replace those of the file; empty: no replacement.
  std::vector<std::string> instead_;
  const TrialKind* kind_ = nullptr;
};

}  // namespace sextant
