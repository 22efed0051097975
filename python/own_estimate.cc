// SPDX-License-Identifier: Apache-2.0
#include "python/own_estimate.h"

#include <fmt/core.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <numeric>

#include "geometry/symmetric.h"
#include "python/arrays.h"
#include "python/module_types.h"
#include "python/raise.h"

namespace sextant::python {
namespace {

[[noreturn]] void RefuseAnswer(ErrorCode code, std::string message) {
  throw ErrorException({code, std::move(message)});
}

Matrix6d CovarianceFrom(const py::object& object) {
  const Matrix6d covariance = MatrixFrom(object, "covariance", 6, 6);
  const bool is_symmetric =
      covariance.allFinite() && covariance.isApprox(covariance.transpose(), 1e-9);
  if (!is_symmetric || EigenOf(covariance).values(0) < -1e-9 * covariance.norm()) {
    RefuseAnswer(ErrorCode::kInvalidInput,
                 "covariance: expected a symmetric positive matrix of (dphi [rad], dt [m])");
  }
  return 0.5 * (covariance + covariance.transpose());
}

std::size_t CountPairs(const CalibrationProblem& problem, const DataNeeds& needs) {
  if (needs.pairs_3d3d > 0) return problem.pairs_3d3d.size();
  return needs.pairs_2d3d > 0 ? problem.pairs_2d3d.size() : 0;
}

void CompleteInliers(std::size_t count, bool are_stated, std::vector<int>& inliers) {
  if (!are_stated) {
    inliers.resize(count);
    std::iota(inliers.begin(), inliers.end(), 0);
    return;
  }
  std::ranges::sort(inliers);
  inliers.erase(std::unique(inliers.begin(), inliers.end()), inliers.end());
  if (inliers.empty() || (inliers.front() >= 0 && inliers.back() < static_cast<int>(count))) return;
  RefuseAnswer(ErrorCode::kInvalidInput,
               fmt::format("inliers: expected numbers of pairs from 0 to {}, got {}",
                           static_cast<long>(count) - 1,
                           inliers.front() < 0 ? inliers.front() : inliers.back()));
}

}  // namespace

OwnEstimate MakeOwnEstimate(const py::object& matrix, const py::object& covariance,
                            const py::object& inliers, const py::object& alternatives,
                            const py::object& warnings, int iterations) {
  OwnEstimate own;
  own.estimate.cam_from_lidar = PoseFrom(matrix, "matrix");
  own.estimate.iterations = iterations;
  if (!covariance.is_none()) own.estimate.covariance = CovarianceFrom(covariance);
  own.states_inliers = !inliers.is_none();
  if (own.states_inliers) {
    own.estimate.inliers = IntegersFrom(inliers, "inliers", py::len(inliers));
  }
  for (const py::handle& other : alternatives) {
    own.estimate.alternatives.push_back(PoseFrom(other, "alternatives"));
  }
  own.estimate.warnings = warnings.cast<std::vector<std::string>>();
  return own;
}

Estimate EstimateFromAnswer(const py::object& answer, const CalibrationProblem& problem,
                            const DataNeeds& needs) {
  if (answer.is_none()) RefuseAnswer(ErrorCode::kNoConsensus, "found no pose (it returned None)");
  OwnEstimate own;
  if (py::isinstance<OwnEstimate>(answer)) {
    own = answer.cast<OwnEstimate>();
  } else if (py::isinstance<ModuleSolution>(answer)) {
    own = {.estimate = answer.cast<const ModuleSolution&>().report, .states_inliers = true};
  } else {
    own.estimate.cam_from_lidar = PoseFrom(answer, "its answer");
  }
  CompleteInliers(CountPairs(problem, needs), own.states_inliers, own.estimate.inliers);
  return std::move(own.estimate);
}

}  // namespace sextant::python
