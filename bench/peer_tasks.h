// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/rigid3d.h"

namespace sextant::bench {

/// Points of both sensors: joined by their place in the lists, or not joined at all.
struct PointProblem {
  std::vector<Eigen::Vector3d> in_cam;
  std::vector<Eigen::Vector3d> in_lidar;
  double sigma_m = 0.01;  ///< Noise of in_cam, per axis.
  Rigid3d cam_from_lidar;
};

/// An answer is cam_from_lidar; none where the peer has none. Only the call is timed: what it needs
/// in the peer's own types is made when it is prepared. The problem outlives it.
using PeerCall = std::function<std::optional<Rigid3d>()>;
using Prepare = std::function<PeerCall(const PointProblem&)>;

/// Registers the peer's benchmarks of a task. Each checks its answers against the truth first, over
/// all problems; in how many it was wrong is its label, and it is not timed where it was in more
/// than a tenth.

/// "pairs/<peer>/N": all pairs are true.
void RegisterPairs(const std::string& peer, const Prepare& prepare);
/// "pairs_<percent>/<peer>/N": so many percent of the pairs join different points. Right is within
/// 1.5 times the error of the true pairs' least squares, or half a degree.
void RegisterOutliers(const std::string& peer, const Prepare& prepare);
/// "corners/<peer>/8": eight corners without their pairing, from a start 3 degrees off.
void RegisterCorners(const std::string& peer, const Prepare& prepare);
/// "room/<peer>/16": two scans of a room by 16 rings, 10 cm and 5 degrees apart.
void RegisterRooms(const std::string& peer, const Prepare& prepare);

/// What a local search begins with: the problems are made so that this is near.
inline Rigid3d LocalStart() { return Rigid3d{}; }

/// One a package; those that were not found are not there.
void RegisterOurs();
void RegisterEigen();
void RegisterOpengv();
void RegisterPcl();
void RegisterOpen3d();

}  // namespace sextant::bench
