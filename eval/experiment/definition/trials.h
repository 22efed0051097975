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

/// What the trials of an experiment measured, a row a subject (and step, for sequences).
class TrialRows {
 public:
  TrialRows(std::size_t metrics, std::bitset<kMaxMetrics> wanted)
      : metrics_(metrics), wanted_(wanted) {}

  struct Key {
    std::uint64_t trial = 0;
    std::uint16_t subject = 0;
    std::uint32_t index = 0;
  };

  /// Rows added from here on are of this trial; the runner calls it.
  void BeginTrial(std::uint64_t trial) { trial_ = trial; }

  /// A new row of NaN, to be filled before the next is added. `subject` counts in the order of
  /// Trials::subjects(); `index` numbers the steps of a sequence (iterations of an average).
  MetricValues Add(int subject, int index = 0);

  bool Wants(int metric) const { return wanted_[static_cast<std::size_t>(metric)]; }
  std::size_t metrics() const { return metrics_; }
  const std::vector<Key>& keys() const { return keys_; }
  /// Row by row, all metrics of each.
  const std::vector<double>& values() const { return values_; }

 private:
  std::size_t metrics_;
  std::bitset<kMaxMetrics> wanted_;
  std::uint64_t trial_ = 0;
  std::vector<Key> keys_;
  std::vector<double> values_;
};

/// One trial's place; everything random in it comes from the seed.
struct TrialId {
  std::uint64_t trial = 0;
  std::uint64_t seed = 0;
};

/// What is tried under one condition. Immutable, thread-safe; the same id adds the same rows.
class Trials {
 public:
  virtual ~Trials() = default;
  Trials() = default;
  Trials(const Trials&) = delete;
  Trials& operator=(const Trials&) = delete;

  /// Whom the rows are about: solvers by canonical name, or what the kind itself compares.
  virtual const std::vector<std::string>& subjects() const = 0;
  /// Where a trial cannot be carried out for a subject, its row says so (answered = 0, or NaN).
  virtual void Run(const TrialId& id, TrialRows& rows) const = 0;
};
using TrialsPtr = std::shared_ptr<const Trials>;

/// What the maker of a kind gets: parameters whose names are checked, and the solvers to compare.
struct KindArguments {
  OptionValues parameters;
  std::vector<SolverPtr> solvers;
  std::filesystem::path folder;  ///< Of the experiment file: relative paths start here.
};

/// A kind of experiment, as `kind:` of an experiment file names it.
struct TrialKind {
  std::string name;
  std::string summary;  ///< What one trial is, in one line.
  bool takes_solvers = true;
  std::vector<OptionDoc> parameters = {};
  std::vector<Metric> metrics = {};  ///< At most kMaxMetrics.
  /// Trials are stored in blocks of so many, and a kill loses the blocks in flight: fewer for
  /// trials that take long.
  int trials_per_block = 100;
  std::function<Expected<TrialsPtr>(const KindArguments&)> make;
};

/// Every kind of this library; the table stands in builtin_kinds.cc.
std::vector<TrialKind> BuiltinKinds();

}  // namespace sextant
