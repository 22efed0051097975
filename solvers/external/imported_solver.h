// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <utility>

#include "solvers/core/registry.h"

namespace sextant {

/// The poses of a solver that ran elsewhere, on the problems of an experiment (`sextant run
/// --export-problems`). It has an answer to a trial by its condition and number, and none to a
/// problem, of which it knows nothing. Immutable.
class ImportedSolver final : public Solver {
 public:
  /// Poses by condition and trial.
  using Poses = std::map<std::pair<std::string, std::uint64_t>, Rigid3d>;

  ImportedSolver(const std::string& name, Poses poses)
      : Solver({.name = name}), poses_(std::move(poses)) {}

  /// Its pose, evaluated on the trial's problem. Error: kNoConsensus where the file has none.
  Expected<SolveReport> AnswerTo(const CalibrationProblem& problem, const std::string& condition,
                                 std::uint64_t trial) const;

 private:
  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override;

  Poses poses_;
};

/// The answer of `solver` in a trial of an experiment: of its own to the problem, or an imported
/// one.
Expected<SolveReport> SolveTrial(const Solver& solver, const CalibrationProblem& problem,
                                 const std::string& condition, std::uint64_t trial);

/// `imported("poses.csv", solver=NAME)`: see io/results/imported_poses.h. The name may be left out
/// where the file has one solver.
SolverEntry ImportedEntry();

}  // namespace sextant
