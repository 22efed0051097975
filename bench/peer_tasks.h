// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "geometry/rigid3d.h"

namespace sextant::bench {

/// Points of both sensors, either paired by their index or unpaired.
struct PointProblem {
  std::vector<Eigen::Vector3d> in_cam;
  std::vector<Eigen::Vector3d> in_lidar;
  double sigma_m = 0.01;  ///< Noise of in_cam, per axis.
  Rigid3d cam_from_lidar;
};

/// A prepared call of a peer; it returns cam_from_lidar, or none if the peer fails. Only the call
/// is timed: inputs in the peer's own types are made during preparation. The problem must outlive
/// it.
using PeerCall = std::function<std::optional<Rigid3d>()>;
using Prepare = std::function<PeerCall(const PointProblem&)>;

/// Registers the peer's benchmarks of a task. Each first checks the results of all problems against
/// the truth; the number of wrong results becomes its label, and it is not timed if more than a
/// tenth are wrong.

/// "pairs/<peer>/N": all pairs are true.
void RegisterPairs(const std::string& peer, const Prepare& prepare);
/// "pairs_<percent>/<peer>/N": this percentage of the pairs joins different points. A result is
/// right within 1.5 times the error of least squares on the true pairs, or half a degree.
void RegisterOutliers(const std::string& peer, const Prepare& prepare);
/// "corners/<peer>/8": eight corners without correspondences, from a start 3 degrees off.
void RegisterCorners(const std::string& peer, const Prepare& prepare);
/// "room/<peer>/16": two scans of a room by 16 rings, 10 cm and 5 degrees apart.
void RegisterRooms(const std::string& peer, const Prepare& prepare);

/// The start of a local search; the problems are made so that it is near the solution.
inline Rigid3d LocalStart() { return Rigid3d{}; }

/// One function per package; only those of packages that were found are defined.
void RegisterOurs();
void RegisterEigen();
void RegisterOpengv();
void RegisterPcl();
void RegisterOpen3d();

}  // namespace sextant::bench
