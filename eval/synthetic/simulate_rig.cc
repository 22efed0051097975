// SPDX-License-Identifier: Apache-2.0
#include "eval/synthetic/simulate_rig.h"

#include <fmt/core.h>

#include <set>

#include "base/random.h"
#include "eval/synthetic/board_observations.h"
#include "eval/synthetic/typical_sensors.h"
#include "geometry/so3.h"

namespace sextant {
namespace {

// A LiDAR within some decimetres of the rig's origin, level to a few degrees, facing forward.
Rigid3d DrawMount(Random& random) {
  Vector6d delta;
  for (int k = 0; k < 3; ++k) delta[k] = random.Uniform(-0.05, 0.05);
  for (int k = 3; k < 6; ++k) delta[k] = random.Uniform(-0.3, 0.3);
  return Perturb(Rigid3d{}, delta);
}

class RigSimulator {
 public:
  explicit RigSimulator(const RigSimulation& simulation)
      : simulation_(simulation), board_(BoardOf(simulation.sensors)) {
    rig_.problem.boards = {board_};
    const auto draw = [&](const char* what, int i) {
      return Random(DeriveSeed(simulation.seed, what, static_cast<std::uint64_t>(i), 0));
    };
    for (int i = 0; i < simulation.cameras; ++i) {
      Random random = draw("simulate rig: camera", i);
      rig_.sensor_from_rig.push_back(DrawExtrinsic(random));
      rig_.problem.sensors.push_back({.name = fmt::format("cam_{}", i), .camera = ZedLikeCamera()});
      AddUnit(0);
    }
    for (int i = 0; i < simulation.lidars; ++i) {
      Random random = draw("simulate rig: lidar", i);
      rig_.sensor_from_rig.push_back(DrawMount(random));
      rig_.problem.sensors.push_back(
          {.name = fmt::format("lidar_{}", i), .lidar_errors = simulation.sensors.errors});
      AddUnit(i);
    }
    looking_ = DrawExtrinsic(random_);
  }

  SimulatedRig Run() {
    for (int moment = 0; moment < simulation_.moments; ++moment) {
      while (!TryMoment(moment)) continue;
    }
    return std::move(rig_);
  }

 private:
  void AddUnit(int lidar) {
    ViewSimulation own = simulation_.sensors;
    own.seed =
        DeriveSeed(simulation_.seed, "simulate rig: unit", static_cast<std::uint64_t>(lidar), 0);
    units_.push_back(DrawUnit(own));
    own_.push_back(own);
  }

  bool TryMoment(int moment) {
    RigPlacement placement{.moment = moment, .board = board_.id, .name = std::to_string(moment)};
    const Rigid3d rig_from_board =
        looking_.Inverse() * DrawBoardPose(simulation_.sensors, looking_, random_);
    const bool moves = simulation_.speed_m_s > 0.0;
    if (moves) DrawMotion();
    std::set<std::size_t> sensors;
    for (std::size_t s = 0; s < rig_.problem.sensors.size(); ++s) {
      if (random_.Uniform() > simulation_.takes_part) continue;
      if (moves ? ObserveMoving(s, rig_from_board, placement)
                : ObserveAt(s, moment, rig_from_board, placement)) {
        sensors.insert(s);
      }
    }
    if (sensors.size() < 2) return false;
    rig_.problem.placements.push_back(std::move(placement));
    rig_.rig_from_board.push_back(rig_from_board);
    return true;
  }

  bool ObserveAt(std::size_t s, int view, const Rigid3d& rig_from_board, RigPlacement& placement) {
    RigObservation seen{.sensor = s};
    if (!Observe(s, view, rig_.sensor_from_rig[s] * rig_from_board, seen)) return false;
    placement.seen.push_back(std::move(seen));
    return true;
  }

  Eigen::Vector3d DrawDirection() {
    Eigen::Vector3d direction;
    for (double& along : direction) along = random_.Normal();
    return direction.normalized();
  }

  void DrawMotion() {
    velocity_m_s_ = simulation_.speed_m_s * DrawDirection();
    turn_rad_s_ = simulation_.turn_rad_s * DrawDirection();
    acceleration_m_s2_ = simulation_.acceleration_m_s2 * DrawDirection();
  }

  // In the board's frame, after the middle of the moment.
  Rigid3d MovedBy(double time_s) const {
    return {ExpSo3(time_s * turn_rad_s_),
            time_s * velocity_m_s_ + 0.5 * time_s * time_s * acceleration_m_s2_};
  }

  bool ObserveMoving(std::size_t s, const Rigid3d& rig_from_board, RigPlacement& placement) {
    constexpr int kScans = 3;
    const double first = random_.Uniform(-1.5, -0.5) * kScanInterval_s;
    const double ahead = simulation_.clock_ahead_s.empty() ? 0.0 : simulation_.clock_ahead_s[s];
    bool any = false;
    for (int k = 0; k < kScans; ++k) {
      const double time_s = first + k * kScanInterval_s;
      if (!ObserveAt(s, kScans * placement.moment + k, rig_from_board * MovedBy(time_s),
                     placement)) {
        continue;
      }
      placement.seen.back().time_s = placement.moment + time_s + ahead;
      any = true;
    }
    return any;
  }

  bool Observe(std::size_t s, int moment, const Rigid3d& sensor_from_board, RigObservation& seen) {
    const ViewSimulation& own = own_[s];
    if (const auto& camera = rig_.problem.sensors[s].camera) {
      if (!IsInImage(*camera, board_, sensor_from_board)) return false;
      AddTag(own, *camera, board_, sensor_from_board, seen.raw, random_);
      return true;
    }
    seen.raw.range_sigma_m = own.range_sigma_m;
    const Rigid3d shifted = sensor_from_board * DrawViewShift(own, moment);
    AddReturns(own, units_[s], board_, shifted, seen.raw, random_);
    return HasAllSides(seen.raw);
  }

  const RigSimulation& simulation_;
  Board board_;
  Random random_{DeriveSeed(simulation_.seed, "simulate rig: moments", 0, 0)};
  Rigid3d looking_;
  Eigen::Vector3d velocity_m_s_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d turn_rad_s_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d acceleration_m_s2_ = Eigen::Vector3d::Zero();
  std::vector<ViewSimulation> own_;
  std::vector<UnitErrors> units_;
  SimulatedRig rig_;
};

}  // namespace

SimulatedRig SimulateRig(const RigSimulation& simulation) { return RigSimulator(simulation).Run(); }

}  // namespace sextant
