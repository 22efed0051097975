// SPDX-License-Identifier: Apache-2.0
#include "calibrate/match/sensor_agreement.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/units.h"
#include "geometry/symmetric.h"

namespace sextant {
namespace {

constexpr double kPoseSigmas = 3.0;

const Rigid3d& CamFromBoard(const Observation& observation, const MatchedBoard& match) {
  const BoardPose& pose = observation.in_image[static_cast<std::size_t>(match.sighting)].pose;
  return match.other_pose ? *pose.ambiguous_with : pose.cam_from_board;
}

const Rigid3d& LidarFromBoard(const Observation& observation, const MatchedBoard& match) {
  return observation.in_scan[static_cast<std::size_t>(match.patch)]
      .placements[static_cast<std::size_t>(match.placement)]
      .lidar_from_board;
}

// Angle between the board's normal and the line of sight.
double Incidence(const Rigid3d& sensor_from_board) {
  const Eigen::Vector3d normal = sensor_from_board.rotation * Eigen::Vector3d::UnitZ();
  const double cosine = std::abs(normal.dot(sensor_from_board.translation.normalized()));
  return std::acos(std::min(1.0, cosine));
}

// Standard deviation of the camera's position in the board's frame, due to the board's tilt.
double PositionSigma(const BoardPose& pose) {
  const Eigen::Matrix3d tilt = pose.covariance.topLeftCorner<3, 3>();
  return pose.cam_from_board.translation.norm() * std::sqrt(std::max(0.0, EigenOf(tilt).values(2)));
}

// All ways in which a sighting may be a patch of the scan.
std::vector<MatchedBoard> Associations(const Observation& observation, int sighting) {
  std::vector<MatchedBoard> all;
  const CameraSighting& seen = observation.in_image[static_cast<std::size_t>(sighting)];
  for (std::size_t p = 0; p < observation.in_scan.size(); ++p) {
    const auto& placements = observation.in_scan[p].placements;
    for (std::size_t k = 0; k < placements.size(); ++k) {
      if (placements[k].board != seen.board) continue;
      for (int pose = 0; pose < (seen.pose.ambiguous_with ? 2 : 1); ++pose) {
        all.push_back({.sighting = sighting,
                       .patch = static_cast<int>(p),
                       .placement = static_cast<int>(k),
                       .other_pose = pose == 1});
      }
    }
  }
  return all;
}

}  // namespace

double SensorsApart(const Observation& observation, const MatchedBoard& match) {
  return (CamFromBoard(observation, match).Inverse().translation -
          LidarFromBoard(observation, match).Inverse().translation)
      .norm();
}

bool MayBeSameBoard(const Observation& observation, const MatchedBoard& match, double max_apart_m) {
  const BoardPose& pose = observation.in_image[static_cast<std::size_t>(match.sighting)].pose;
  return SensorsApart(observation, match) <= max_apart_m + kPoseSigmas * PositionSigma(pose);
}

std::optional<std::string> WhyNoneIsSameBoard(const Observation& observation, int sighting,
                                              double max_apart_m) {
  std::optional<MatchedBoard> nearest;
  double least = std::numeric_limits<double>::infinity();
  for (const MatchedBoard& match : Associations(observation, sighting)) {
    if (MayBeSameBoard(observation, match, max_apart_m)) return std::nullopt;
    const double apart = SensorsApart(observation, match);
    if (apart >= least) continue;
    least = apart;
    nearest = match;
  }
  if (!nearest) return std::nullopt;
  const Rigid3d& cam_from_board = CamFromBoard(observation, *nearest);
  const Rigid3d& lidar_from_board = LidarFromBoard(observation, *nearest);
  const double in_image_m = cam_from_board.translation.norm();
  const double in_scan_m = lidar_from_board.translation.norm();
  if (std::abs(in_image_m - in_scan_m) > max_apart_m) {
    return fmt::format(
        "the photo shows the board {:.1f} m away, the scan's candidate is {:.1f} m away",
        in_image_m, in_scan_m);
  }
  return fmt::format(
      "the photo shows the board turned {:.0f} deg away from the camera, the scan's candidate is "
      "turned {:.0f} deg away from the LiDAR: the sensors would be {:.1f} m apart",
      Incidence(cam_from_board) * kDegPerRad, Incidence(lidar_from_board) * kDegPerRad, least);
}

}  // namespace sextant
