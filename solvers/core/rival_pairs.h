// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <vector>

#include "geometry/calibration_problem.h"
#include "solvers/core/solver.h"
#include "solvers/kernels/pair_terms.h"

namespace sextant {

/// Indices of as many pairs as fix a pose.
inline constexpr std::size_t kSampleSize = 3;
using PairSample = std::array<int, kSampleSize>;

/// A pose in the form that a few residuals need.
struct MatrixPose {
  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;

  Eigen::Vector3d At(const Eigen::Vector3d& p) const {
    return rotation.col(0) * p.x() + rotation.col(1) * p.y() + rotation.col(2) * p.z() +
           translation;
  }
  Rigid3d Rigid() const { return {Eigen::Quaterniond(rotation).normalized(), translation}; }
};

MatrixPose MatrixOf(const Rigid3d& pose);

/// Pairs of one kind of a problem, with residuals in their sigmas, and the poses that some of them
/// fix. Refers to its arguments; the camera may be null for 3D-3D pairs.
class RivalPairs {
 public:
  RivalPairs(const CalibrationProblem& problem, PairKind kind, const Camera* camera)
      : problem_(problem), kind_(kind), camera_(camera) {}

  /// The largest of the pairs that the answer used.
  double LargestSquared(const SolveReport& answer) const;

  std::vector<int> Agreeing(const std::vector<int>& among, const MatrixPose& pose,
                            double max_squared) const;

  /// Whether most pairs agree, by a few of them: false as soon as three more contradict the pose
  /// than agree, which of a pose that three of four agree on is one in 27.
  bool MostMayAgree(const std::vector<int>& among, const MatrixPose& pose,
                    double max_squared) const;

  void AddPosesOf(const PairSample& sample, std::vector<MatrixPose>& poses) const;

  std::optional<Rigid3d> LeastSquares(const std::vector<int>& used, const Rigid3d& start) const;

  /// The probability that a random pair agrees with a pose: the ball or disc of the largest
  /// residual over the box of the camera's points or pixels.
  double ChanceOfOne(double max_squared) const;

 private:
  double Squared(int index, const MatrixPose& pose) const;
  void AddPoseOfPoints(const PairSample& sample, std::vector<MatrixPose>& poses) const;
  void AddPosesOfPixels(const PairSample& sample, std::vector<MatrixPose>& poses) const;

  const CalibrationProblem& problem_;
  PairKind kind_;
  const Camera* camera_;
};

}  // namespace sextant
