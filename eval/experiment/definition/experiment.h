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

/// What is tried `trials` times: the kind under one set of parameters.
struct Condition {
  std::string name{};
  std::string base{};  ///< Its name in the list of conditions, without the grid; may be empty.
  /// Its place on the axes of the grid, in their order; empty without a grid.
  std::vector<std::string> place{};
  OptionValues parameters{};  ///< All that the file sets, the condition's own last.
  TrialsPtr trials{};
};

/// A table of the report: subjects down; statistics, or places of one axis, across.
struct TableSpec {
  std::string title;
  std::vector<Statistic> columns;
  bool intervals = true;  ///< Each figure with its 95 percent interval.
  std::string across;     ///< Axis whose places are the columns (of one statistic); empty: none.
};

/// A plot of the report: a line a subject.
struct PlotSpec {
  std::string title;
  std::string name;  ///< Of the file, without extension.
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
  std::string text;  ///< What it is for; a paragraph of the report.
  std::string kind;
  int trials_per_block = 100;
  std::uint64_t seed = 1;
  std::uint64_t trials = 0;
  std::uint64_t quick_trials = 0;
  std::uint64_t timed_trials = 0;  ///< So many are timed, alone on one thread; 0: none.
  bool same_seeds = false;         ///< Every condition draws from the same seeds: paired.
  std::vector<std::string> axes;   ///< Of the grid.
  std::vector<Condition> conditions;
  std::vector<Metric> metrics;  ///< All of the kind.
  std::bitset<kMaxMetrics> wanted;
  std::vector<TableSpec> tables;
  std::vector<PlotSpec> plots;
};

/// Reads and checks all that can be known before the first trial: keys, kind, parameters, solvers,
/// metrics, statistics. Formats: docs/experiments.md. Errors name file, line and key (kParse,
/// kUnknownName with the nearest known, kInvalidOption); kIo.
///
/// `solvers` (specs, separated by commas) take the place of all that the file names; conditions
/// that they have no data for are then left out.
Expected<Experiment> ReadExperiment(const std::filesystem::path& path,
                                    const std::vector<TrialKind>& kinds,
                                    const SolverRegistry& registry,
                                    const std::string& solvers = "");
Expected<Experiment> ParseExperiment(std::string_view text, const std::string& file,
                                     const std::vector<TrialKind>& kinds,
                                     const SolverRegistry& registry,
                                     const std::string& solvers = "");

/// The seed of a trial: by the experiment's seed and name, the condition's name and the trial.
std::uint64_t SeedOf(const Experiment& experiment, const Condition& condition, std::uint64_t trial);

}  // namespace sextant
