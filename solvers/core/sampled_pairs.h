// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "geometry/calibration_problem.h"
#include "solvers/core/solver.h"
#include "solvers/kernels/pair_terms.h"

namespace sextant {

/// As many pairs as fix a pose: indices into the pairs of a problem.
inline constexpr std::size_t kPairTriple = 3;
using PairTriple = std::array<int, kPairTriple>;

/// A pose in the form that a few residuals need.
struct MatrixPose {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;

  Eigen::Vector3d At(const Eigen::Vector3d& p) const;
  Rigid3d Rigid() const;
};

MatrixPose MatrixOf(const Rigid3d& pose);

/// The pairs of one kind of a problem, for a search by random samples; squared residuals are in
/// variances of the stated noise, or in m^2 or px^2 where none is stated.
class SampledPairs {
 public:
  /// `camera` may be null for 3D-3D pairs. Keeps references to both.
  SampledPairs(const CalibrationProblem& problem, PairKind kind, const Camera* camera)
      : problem_(problem), kind_(kind), camera_(camera) {}

  /// Infinite for a point that does not project.
  double Squared(int index, const MatrixPose& pose) const;
  /// The largest of the pairs that the answer used.
  double LargestSquared(const SolveReport& answer) const;

  std::vector<int> Agreeing(const std::vector<int>& among, const MatrixPose& pose,
                            double max_squared) const;
  /// Whether most pairs agree, by a few of them: false as soon as three more contradict the pose
  /// than agree, which of a pose that three of four agree on is one in 27.
  bool MostMayAgree(const std::vector<int>& among, const MatrixPose& pose,
                    double max_squared) const;

  /// Appends the poses that three pairs have: one of points, up to four of pixels.
  void AddPosesOf(const PairTriple& sample, std::vector<MatrixPose>& poses) const;
  /// None where a point of those used does not project on the way.
  std::optional<Rigid3d> LeastSquares(const std::vector<int>& used, const Rigid3d& start) const;

  /// The probability that a random pair agrees with a pose: the ball or disc of the largest
  /// residual over the box of the camera's points or pixels.
  double ChanceOfOne(double max_squared) const;

 private:
  void AddPoseOfPoints(const PairTriple& sample, std::vector<MatrixPose>& poses) const;
  void AddPosesOfPixels(const PairTriple& sample, std::vector<MatrixPose>& poses) const;

  const CalibrationProblem& problem_;
  PairKind kind_;
  const Camera* camera_;
};

}  // namespace sextant
