// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "geometry/calibration_problem.h"

namespace sextant {

/// A camera observation and a LiDAR point that are taken to be the same point: indices of pairs.
struct Correspondence {
  int cam = 0;
  int lidar = 0;
  friend bool operator==(const Correspondence&, const Correspondence&) = default;
};

struct CorrespondenceFit {
  Rigid3d cam_from_lidar;
  double sum_squares =
      0.0;  ///< The sum of the squared distances in the camera's data [m^2 or px^2].
};

/// What a search of correspondences needs to know of pairs, alike for 3D-3D and for 2D-3D pairs.
/// The noise that pairs state is not used: all count the same.
class CorrespondenceModel {
 public:
  using Triple = std::array<int, 3>;

  virtual ~CorrespondenceModel() = default;
  CorrespondenceModel(const CorrespondenceModel&) = delete;
  CorrespondenceModel& operator=(const CorrespondenceModel&) = delete;

  std::size_t size() const { return in_lidar_.size(); }
  /// Points in the camera frame [m], or pixels with a third coordinate of zero.
  const std::vector<Eigen::Vector3d>& observed() const { return observed_; }
  const std::vector<Eigen::Vector3d>& in_lidar() const { return in_lidar_; }

  /// Residuals of a pair: 3, or 2 for pixels.
  virtual int dimension() const = 0;
  /// Where the camera would observe a LiDAR point under the pose; none where it cannot.
  virtual std::optional<Eigen::Vector3d> Predict(const Rigid3d& cam_from_lidar,
                                                 const Eigen::Vector3d& in_lidar) const = 0;
  /// Appends the poses of three correspondences: at most one by Kabsch, four by P3P.
  virtual void AddPosesOf(const Triple& cam, const Triple& lidar,
                          std::vector<Rigid3d>& poses) const = 0;
  /// Least squares of the correspondences, for pixels from `start`. None for degenerate data.
  virtual std::optional<CorrespondenceFit> Fit(std::span<const Correspondence> correspondences,
                                               const Rigid3d& start) const = 0;

 protected:
  CorrespondenceModel() = default;
  std::vector<Eigen::Vector3d> observed_;
  std::vector<Eigen::Vector3d> in_lidar_;
};

std::unique_ptr<CorrespondenceModel> ModelOf(std::span<const Pair3d3d> pairs);
/// A pixel without a ray (outside the camera's domain) gives no pose by P3P.
std::unique_ptr<CorrespondenceModel> ModelOf(std::span<const Pair2d3d> pairs, const Camera& camera);

}  // namespace sextant
