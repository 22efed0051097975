// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/options.h"
#include "eval/metrics/metrics.h"
#include "solvers/core/solver.h"

namespace sextant {

/// Measurements of the trials of an experiment: one row per subject (and step, for sequences).
class TrialRows {
 public:
  TrialRows(std::size_t metrics, std::bitset<kMaxMetrics> wanted)
      : metrics_(metrics), wanted_(wanted) {}

  struct Key {
    std::uint64_t trial = 0;
    std::uint16_t subject = 0;
    std::uint32_t index = 0;
  };

  /// Rows added from here on belong to this trial; called by the runner.
  void BeginTrial(std::uint64_t trial) { trial_ = trial; }

  /// Appends a row of NaN, to be filled before the next one is added. `subject` is an index into
  /// Trials::subjects(); `index` numbers the steps of a sequence (iterations of an average).
  MetricValues Add(int subject, int index = 0);

  bool Wants(int metric) const { return wanted_[static_cast<std::size_t>(metric)]; }
  std::size_t metrics() const { return metrics_; }
  const std::vector<Key>& keys() const { return keys_; }
  /// All metrics of each row, row by row.
  const std::vector<double>& values() const { return values_; }

 private:
  std::size_t metrics_;
  std::bitset<kMaxMetrics> wanted_;
  std::uint64_t trial_ = 0;
  std::vector<Key> keys_;
  std::vector<double> values_;
};

/// Identifies a trial; everything random in it is derived from the seed.
struct TrialId {
  std::uint64_t trial = 0;
  std::uint64_t seed = 0;
};

/// The trials of one condition. Immutable and thread-safe; the same id gives the same rows.
class Trials {
 public:
  virtual ~Trials() = default;
  Trials() = default;
  Trials(const Trials&) = delete;
  Trials& operator=(const Trials&) = delete;

  /// What the rows compare: solvers by canonical name, or the kind's own subjects.
  virtual const std::vector<std::string>& subjects() const = 0;
  /// Runs one trial. If it fails for a subject, its row says so (answered = 0, or NaN).
  virtual void Run(const TrialId& id, TrialRows& rows) const = 0;
  /// The problem of a trial as solvers see it. Error: kInvalidInput for trials that have none.
  virtual Expected<CalibrationProblem> ProblemOf(const TrialId& /*id*/) const {
    return MakeError(ErrorCode::kInvalidInput, "the trials of this kind are no problems of pairs");
  }
};
using TrialsPtr = std::shared_ptr<const Trials>;

/// Arguments of TrialKind::make: parameters whose names are checked, and the solvers to compare.
struct KindArguments {
  OptionValues parameters;
  std::vector<SolverPtr> solvers;
  std::filesystem::path folder;  ///< Folder of the experiment file, to which relative paths refer.
  std::string condition = {};    ///< Its name, by which imported poses are found.
};

/// A kind of experiment, selected by `kind:` in an experiment file.
struct TrialKind {
  std::string name;
  std::string summary;  ///< Describes one trial in one line.
  bool takes_solvers = true;
  /// A condition whose data is absent (kMissingData) is left out; Experiment::absent says so.
  bool skips_absent_data = false;
  std::vector<OptionDoc> parameters = {};
  std::vector<Metric> metrics = {};  ///< At most kMaxMetrics.
  /// Number of trials per stored block. A killed run loses its unfinished blocks, so slow trials
  /// use smaller ones.
  int trials_per_block = 100;
  std::function<Expected<TrialsPtr>(const KindArguments&)> make;
};

/// All kinds of this library; the table is in kinds/builtin_kinds.cc.
std::vector<TrialKind> BuiltinKinds();

}  // namespace sextant
