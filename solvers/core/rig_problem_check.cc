// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/rig_problem_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>
#include <utility>

#include "solvers/core/board_view_check.h"

namespace sextant {
namespace {

class ObservationCheck {
 public:
  ObservationCheck(const RigProblem& problem, const RigPlacement& placement,
                   const RigObservation& seen)
      : problem_(problem), placement_(placement), seen_(seen) {}

  Expected<void> Run() const {
    if (seen_.sensor >= problem_.sensors.size()) return Wrong("names no sensor");
    BoardView view = seen_.raw;
    view.view = placement_.moment;
    view.board = placement_.board;
    SEXTANT_RETURN_IF_ERROR(CheckBoardView(view, problem_.boards));
    const bool returns = !view.face_in_lidar.empty() || !view.edges.empty();
    if (!view.printed.empty() && !problem_.sensors[seen_.sensor].camera) {
      return Wrong("has pixels, and its sensor has no intrinsics: give it a camera");
    }
    if (returns && problem_.sensors[seen_.sensor].camera) {
      return Wrong("has returns of a LiDAR, and its sensor is a camera");
    }
    SEXTANT_RETURN_IF_ERROR(CheckFeatures());
    if (seen_.time_s && !std::isfinite(*seen_.time_s)) {
      return Wrong("has a time that is not finite", ErrorCode::kNonFinite);
    }
    if (view.printed.empty() && !returns && seen_.points.empty() && !seen_.plane &&
        seen_.lines.empty()) {
      return Wrong("is empty: give pixels, points, a plane, lines or returns");
    }
    if (!view.edges.empty() && view.face_in_lidar.size() < 3 && !seen_.sensor_from_board) {
      return Wrong("has edge rays without face returns or sensor_from_board, from which to start");
    }
    return {};
  }

 private:
  tl::unexpected<Error> Wrong(const std::string& what,
                              ErrorCode code = ErrorCode::kInvalidInput) const {
    const bool known = seen_.sensor < problem_.sensors.size();
    return MakeError(code, fmt::format("moment {}, board {}: the observation of {} {}",
                                       placement_.name.empty() ? std::to_string(placement_.moment)
                                                               : placement_.name,
                                       placement_.board,
                                       known ? problem_.sensors[seen_.sensor].name
                                             : fmt::format("sensor number {}", seen_.sensor),
                                       what));
  }

  static bool IsPositive(double sigma) { return sigma > 0.0 && std::isfinite(sigma); }

  Expected<void> CheckFeatures() const {
    for (const MeasuredPoint& point : seen_.points) {
      if (!point.in_board_m.allFinite() || !point.in_sensor_m.allFinite()) {
        return Wrong("has a point with a number that is not finite", ErrorCode::kNonFinite);
      }
      if (!IsPositive(point.sigma_m)) return Wrong("has a point whose sigma is not positive");
    }
    if (seen_.plane) {
      const MeasuredPlane& plane = *seen_.plane;
      if (!plane.normal.allFinite() || !std::isfinite(plane.distance_m)) {
        return Wrong("has a plane with a number that is not finite", ErrorCode::kNonFinite);
      }
      if (std::abs(plane.normal.norm() - 1.0) > 1e-6) return Wrong("has a normal that is no unit");
      if (!IsPositive(plane.sigma_m) || !IsPositive(plane.sigma_rad)) {
        return Wrong("has a plane whose sigmas are not positive");
      }
    }
    return CheckLines();
  }

  Expected<void> CheckLines() const {
    const Board& board = *FindBoard(problem_.boards, placement_.board);
    const int sides = board.hole ? 2 * kCornersPerBoard : kCornersPerBoard;
    for (const MeasuredLine& line : seen_.lines) {
      if (!line.point.allFinite() || !line.direction.allFinite()) {
        return Wrong("has a line with a number that is not finite", ErrorCode::kNonFinite);
      }
      if (std::abs(line.direction.norm() - 1.0) > 1e-6) {
        return Wrong("has a line whose direction is no unit vector");
      }
      if (line.side < 0 || line.side >= sides) {
        return Wrong(fmt::format("has a line on side {}, expected 0 to {}", line.side, sides - 1));
      }
      if (!IsPositive(line.sigma_m)) return Wrong("has a line whose sigma is not positive");
    }
    return {};
  }

  const RigProblem& problem_;
  const RigPlacement& placement_;
  const RigObservation& seen_;
};

}  // namespace

Expected<void> CheckRigProblem(const RigProblem& problem) {
  if (problem.sensors.size() < 2) {
    return MakeError(ErrorCode::kMissingData,
                     fmt::format("expected two sensors or more, got {}", problem.sensors.size()));
  }
  std::set<std::string> names;
  for (const RigSensor& sensor : problem.sensors) {
    if (!names.insert(sensor.name).second) {
      return MakeError(ErrorCode::kInvalidInput,
                       fmt::format("two sensors are named '{}'", sensor.name));
    }
    if (sensor.camera) SEXTANT_RETURN_IF_ERROR(ValidateCamera(*sensor.camera));
  }
  for (const RigPlacement& placement : problem.placements) {
    if (FindBoard(problem.boards, placement.board) == nullptr) {
      return MakeError(ErrorCode::kInvalidInput,
                       fmt::format("moment {} has board {}, which is not among the boards",
                                   placement.moment, placement.board));
    }
    const auto timed = std::ranges::count_if(
        placement.seen, [](const RigObservation& seen) { return seen.time_s.has_value(); });
    if (timed > 0 && timed < std::ssize(placement.seen)) {
      return MakeError(
          ErrorCode::kInvalidInput,
          fmt::format("moment {}, board {}: expected a time of every observation, or "
                      "of none",
                      placement.name.empty() ? std::to_string(placement.moment) : placement.name,
                      placement.board));
    }
    std::set<std::pair<std::size_t, std::optional<double>>> sensors;
    for (const RigObservation& seen : placement.seen) {
      SEXTANT_RETURN_IF_ERROR(ObservationCheck(problem, placement, seen).Run());
      if (sensors.insert({seen.sensor, seen.time_s}).second) continue;
      return MakeError(ErrorCode::kInvalidInput,
                       fmt::format("moment {} has board {} of sensor '{}' twice", placement.moment,
                                   placement.board, problem.sensors[seen.sensor].name));
    }
  }
  return {};
}

}  // namespace sextant
