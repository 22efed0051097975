// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <bitset>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "eval/experiment/definition/statistic.h"
#include "eval/experiment/definition/trials.h"
#include "solvers/core/registry.h"

namespace sextant {

/// One set of parameters of the kind, under which `trials` trials are run.
struct Condition {
  std::string name{};
  std::string base{};  ///< Name in the list of conditions, without the grid; may be empty.
  /// Values on the axes of the grid, in the order of the axes; empty without a grid.
  std::vector<std::string> place{};
  OptionValues parameters{};  ///< All parameters that the file sets; the condition's own come last.
  TrialsPtr trials{};
};

/// A table of the report: one row per subject; one column per statistic, or per value of one axis.
struct TableSpec {
  std::string title;
  std::vector<Statistic> columns;
  bool intervals = true;  ///< Show each figure with its 95 percent interval.
  std::string across;     ///< Axis whose values are the columns (of one statistic); empty: none.
  int ranked = -1;        ///< A metric by which the subjects are ranked, instead of columns.
};

/// What a plot shows of each subject.
enum class PlotType {
  kLines,     ///< A statistic along an axis of the grid, with its 95 percent intervals.
  kCdf,       ///< Share of all trials whose metric is at most x; those without one never are.
  kCoverage,  ///< Share of the trials within the region of each nominal level; the metric is NEES.
  kTime,      ///< A statistic against the median time; needs timed_trials.
};

/// A plot of the report with one line per subject.
struct PlotSpec {
  PlotType type = PlotType::kLines;
  int metric = -1;        ///< The x of kCdf and kCoverage.
  double max = 0.0;       ///< End of the axis of kCdf and limit of its area; 0: by the data.
  std::string condition;  ///< The only one that is shown; empty: all.
  std::string title;
  std::string name;  ///< File name without extension.
  std::string x;     ///< An axis of the grid, or "index" for the steps of a sequence.
  std::string x_label;
  std::string y_label;
  Statistic y;
  bool log_x = false;
  bool log_y = false;
};

/// An experiment file, checked and ready to run.
struct Experiment {
  std::string name;
  std::string title;
  std::string text;  ///< Purpose of the experiment; a paragraph of the report.
  std::string kind;
  int trials_per_block = 100;
  std::uint64_t seed = 1;
  std::uint64_t trials = 0;
  std::uint64_t quick_trials = 0;
  std::uint64_t timed_trials = 0;  ///< Number of trials that are timed on one thread; 0: none.
  bool same_seeds = false;  ///< All conditions use the same seeds, so their trials are paired.
  std::vector<std::string> axes;  ///< Names of the grid's axes.
  std::vector<Condition> conditions;
  std::vector<std::string> absent;  ///< Conditions without their data, and which data that is.
  std::vector<Metric> metrics;      ///< All metrics of the kind.
  std::bitset<kMaxMetrics> wanted;
  std::vector<TableSpec> tables;
  std::vector<PlotSpec> plots;
};

/// Reads an experiment file and checks everything that can be checked before the first trial: keys,
/// kind, parameters, solvers, metrics, statistics. Format: docs/experiments.md. Errors name file,
/// line and key (kParse, kUnknownName with the nearest known name, kInvalidOption); kIo.
/// Time and memory are those of ParseYaml (io/text/yaml_node.h) and of at most 10,000 conditions.
///
/// `solvers` (specs separated by commas) replaces all solvers that the file names; conditions
/// without the data that they need are then left out.
Expected<Experiment> ReadExperiment(const std::filesystem::path& path,
                                    const std::vector<TrialKind>& kinds,
                                    const SolverRegistry& registry,
                                    const std::string& solvers = "");
Expected<Experiment> ParseExperiment(std::string_view text, const std::string& file,
                                     const std::vector<TrialKind>& kinds,
                                     const SolverRegistry& registry,
                                     const std::string& solvers = "");

/// The seed of a trial, derived from the experiment's seed and name, the condition's name and the
/// trial's number.
std::uint64_t SeedOf(const Experiment& experiment, const Condition& condition, std::uint64_t trial);

}  // namespace sextant
