// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <map>
#include <memory>
#include <string>

#include "solvers/core/solver.h"

namespace sextant::python {

/// A Python function f(problem) behind the interface of solvers. Any thread may call it: it takes
/// the GIL for the call alone. What the function raises becomes a refusal with the exception's
/// text and place; so does an answer that is not a rigid transform.
class PythonSolver final : public Solver {
 public:
  /// Needs the GIL; may be destroyed without it.
  PythonSolver(SolverSpec spec, pybind11::function function);

 private:
  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override;

  std::shared_ptr<const pybind11::function> function_;
};

/// How often the function of a solver raised an exception other than sextant.Error, or answered
/// with something that is no pose, and the first message: these are mistakes and no refusals.
struct SolverFaults {
  long count = 0;
  std::string first;
};

/// The faults by solver since the last call, which are then forgotten. Needs the GIL.
std::map<std::string, SolverFaults> TakeFaults();

}  // namespace sextant::python
