// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "solvers/core/rig_problem.h"
#include "solvers/rig/rig_model.h"

namespace sextant {

/// The poses of a board that explain one observation alone, best first: the stated one, or that of
/// the measured points and lines (Kabsch), both of a planar print (IPPE), or a rough one of returns
/// and edges. None where it leaves a direction undetermined, as a plane does.
std::vector<Rigid3d> PosesAlone(const RigObservation& seen, const RigSensor& sensor,
                                const Board& board);

/// The plane of a board's front in the sensor frame: its normal points away from the sensor.
struct BoardPlaneAlone {
  Eigen::Vector3d normal;
  double distance_m = 0.0;
};
std::optional<BoardPlaneAlone> PlaneAlone(const RigObservation& seen,
                                          const std::vector<Rigid3d>& poses);

/// Two sensors and the boards that both of them see.
struct RigPair {
  std::size_t a = 0;
  std::size_t b = 0;
  std::vector<std::size_t> placements{};
  std::optional<Rigid3d> a_from_b{};  ///< None where these boards do not determine it.
};

/// Every pair of sensors, the one with the most common boards first, with a pose from the boards'
/// poses alone: that which most of the boards agree on.
std::vector<RigPair> PairsOf(const RigProblem& problem);

/// The sensors that pairs connect with the root, along the tree of the most common boards.
struct RigTree {
  std::vector<std::optional<Rigid3d>> sensor_from_root;
  std::vector<std::string> unconnected;  ///< For each sensor without a pose, what would connect it.
};
RigTree TreeOf(const RigProblem& problem, const std::vector<RigPair>& pairs, std::size_t root);

/// Poses and motions of all boards for sensors with these poses: each that of the observation that
/// explains the others best.
RigState StateOf(const RigProblem& problem, const RigModel& model,
                 const std::vector<Rigid3d>& sensor_from_root);

}  // namespace sextant
