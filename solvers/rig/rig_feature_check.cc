// SPDX-License-Identifier: Apache-2.0
#include "solvers/rig/rig_feature_check.h"

#include <fmt/core.h>

#include <cmath>
#include <vector>

#include "base/median.h"
#include "solvers/kernels/kabsch.h"

namespace sextant {
namespace {

/// What the observations of one sensor show, one value each.
struct SensorFeatures {
  std::vector<double> scales;       ///< Size of the measured points over that of the board's.
  std::vector<double> misfits;      ///< How far the points are from a rigid pose, over their size.
  std::vector<double> faces;        ///< 1 where the points show the front, -1 where the back.
  std::vector<double> ahead;        ///< 1 where a camera's plane is in front of it, -1 behind.
  std::vector<double> off_m;        ///< Distances of points and lines from the plane.
  std::vector<double> off_other_m;  ///< The same with the other sign of the distance.
};

struct Spread {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  double size = 0.0;  ///< Root of the mean squared distance from the centre.
};

Spread SpreadOf(const std::vector<Eigen::Vector3d>& points) {
  Spread spread;
  for (const Eigen::Vector3d& point : points) spread.centre += point;
  spread.centre /= static_cast<double>(points.size());
  for (const Eigen::Vector3d& point : points) {
    spread.size += (point - spread.centre).squaredNorm();
  }
  spread.size = std::sqrt(spread.size / static_cast<double>(points.size()));
  return spread;
}

void AddPoints(const RigObservation& seen, SensorFeatures& of) {
  std::vector<Eigen::Vector3d> in_board;
  std::vector<Eigen::Vector3d> in_sensor;
  for (const MeasuredPoint& point : seen.points) {
    in_board.push_back(point.in_board_m);
    in_sensor.push_back(point.in_sensor_m);
  }
  if (in_board.size() < 3) return;
  const double size = SpreadOf(in_board).size;
  const double scale = SpreadOf(in_sensor).size / size;
  if (!(size > 1e-9) || !(scale > 1e-9)) return;
  of.scales.push_back(scale);
  for (Eigen::Vector3d& point : in_board) point *= scale;
  const auto fit = FitKabsch(in_sensor, in_board);
  if (!fit) {
    // Points that are not on one line, and yet no pose: exchanged ones.
    if (FitKabsch(in_board, in_board)) of.misfits.push_back(1.0);
    return;
  }
  const double misfit = std::sqrt(fit->sum_squares / static_cast<double>(in_board.size()));
  of.misfits.push_back(misfit / (scale * size));
  // The board's z axis points into the board, away from who sees its front.
  const Eigen::Vector3d into = fit->b_from_a.rotation * Eigen::Vector3d::UnitZ();
  of.faces.push_back(into.dot(fit->b_from_a.translation) > 0.0 ? 1.0 : -1.0);
}

void AddPlane(const RigObservation& seen, const RigSensor& sensor, SensorFeatures& of) {
  if (!seen.plane) return;
  const MeasuredPlane& plane = *seen.plane;
  // Where the optical axis meets the plane.
  if (sensor.camera) of.ahead.push_back(plane.normal.z() * plane.distance_m > 0.0 ? 1.0 : -1.0);
  const auto add = [&](const Eigen::Vector3d& point) {
    of.off_m.push_back(std::abs(plane.normal.dot(point) - plane.distance_m));
    of.off_other_m.push_back(std::abs(plane.normal.dot(point) + plane.distance_m));
  };
  for (const MeasuredPoint& point : seen.points) add(point.in_sensor_m);
  for (const MeasuredLine& line : seen.lines) add(line.point);
}

tl::unexpected<Error> WrongFeatures(const RigSensor& sensor, const std::string& what) {
  return MakeError(ErrorCode::kInvalidInput, fmt::format("sensor '{}': {}", sensor.name, what));
}

Expected<void> CheckPoints(const RigSensor& sensor, SensorFeatures& of) {
  constexpr double kMaxScale = 1.25;
  constexpr double kMaxMisfit = 0.3;
  if (of.scales.empty()) return {};
  const double scale = Median(of.scales);
  if (scale > kMaxScale || scale < 1.0 / kMaxScale) {
    return WrongFeatures(sensor,
                         fmt::format("its points of a board are {:.4g} times as far apart as "
                                     "stated: are they in metres, and is the board's size right?",
                                     scale));
  }
  if (Median(of.misfits) > kMaxMisfit) {
    return WrongFeatures(sensor,
                         "its points do not have the form of the board: are they in the order of "
                         "the board's points (corners clockwise as seen from the front, from the "
                         "top left)?");
  }
  if (!of.faces.empty() && Median(of.faces) < 0.0) {
    return WrongFeatures(sensor,
                         "its points show the back of the board: they are numbered "
                         "counter-clockwise as seen from the sensor; expected clockwise");
  }
  return {};
}

Expected<void> CheckPlanes(const RigSensor& sensor, SensorFeatures& of) {
  constexpr double kFar_m = 0.1;
  const bool behind = !of.ahead.empty() && Median(of.ahead) < 0.0;
  const double off_m = Median(of.off_m);
  const bool other = off_m > kFar_m && 10.0 * Median(of.off_other_m) < off_m;
  if (behind || other) {
    return WrongFeatures(
        sensor, fmt::format("its planes {}: expected normal . point = distance; the number d of an "
                            "equation a x + b y + c z + d = 0 has the other sign",
                            behind ? "are behind the camera"
                                   : "are on the other side of it than its points and lines"));
  }
  if (off_m > kFar_m) {
    return WrongFeatures(sensor, fmt::format("its points and lines lie {:.3g} m from its planes: "
                                             "are they of the same board and frame?",
                                             off_m));
  }
  return {};
}

}  // namespace

Expected<void> CheckRigFeatures(const RigProblem& problem) {
  std::vector<SensorFeatures> sensors(problem.sensors.size());
  for (const RigPlacement& placement : problem.placements) {
    for (const RigObservation& seen : placement.seen) {
      AddPoints(seen, sensors[seen.sensor]);
      AddPlane(seen, problem.sensors[seen.sensor], sensors[seen.sensor]);
    }
  }
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    SEXTANT_RETURN_IF_ERROR(CheckPoints(problem.sensors[s], sensors[s]));
    SEXTANT_RETURN_IF_ERROR(CheckPlanes(problem.sensors[s], sensors[s]));
  }
  return {};
}

}  // namespace sextant
