// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <optional>

#include "solvers/core/solver.h"

namespace sextant::python {

/// sextant.Estimate: what a solver in Python returns where it knows more than the pose.
struct OwnEstimate {
  Estimate estimate;
  bool states_inliers = false;  ///< False: the answer rests on all pairs.
};

/// An OwnEstimate of Python's arguments. Throws ErrorException (kInvalidInput, which names the
/// argument) for what is not a rigid transform, or not a covariance.
OwnEstimate MakeOwnEstimate(const pybind11::object& matrix, const pybind11::object& covariance,
                            const pybind11::object& inliers, const pybind11::object& alternatives,
                            const pybind11::object& warnings, int iterations);

/// The estimate that the function of a solver returned for a problem: a sextant.Estimate, a
/// sextant.Solution, a matrix, or None for no pose (kNoConsensus). Needs the GIL; throws as above.
Estimate EstimateFromAnswer(const pybind11::object& answer, const CalibrationProblem& problem,
                            const DataNeeds& needs);

}  // namespace sextant::python
