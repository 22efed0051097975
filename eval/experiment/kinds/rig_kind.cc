// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/random.h"
#include "base/units.h"
#include "eval/experiment/definition/trials.h"
#include "eval/synthetic/simulate_rig.h"
#include "geometry/symmetric.h"
#include "geometry/uncertain_pose.h"
#include "solvers/rig/solve_rig.h"

namespace sextant {
namespace {

struct RigSettings : RigSimulation {
  double clock_sigma_s = 0.0;
};

enum RigMeasured : int {
  kRigTranslationMm,
  kRigRotationDeg,
  kRigNees,
  kRigOverBound,
  kRigChainedMm,
  kRigChainedDeg,
  kRigClockMs,
  kRigClockNees
};

const std::vector<Metric>& RigMetrics() {
  static const std::vector<Metric> metrics = {
      {"translation_mm", "translation error of the pair's pose, all sensors solved together"},
      {"rotation_deg", "rotation error of the same"},
      {"nees", "squared error of the same over the stated covariance, per axis: 1 if it is right"},
      {"over_bound", "error of the same over the Cramer-Rao bound, root of the mean over the axes"},
      {"chained_mm", "translation error of the pair by chaining pairs through the first LiDAR"},
      {"chained_deg", "rotation error of the same"},
      {"clock_ms", "error of the time offset between the pair, where boards move"},
      {"clock_nees", "its square over the stated variance"},
  };
  return metrics;
}

// Converts members of RigSimulation to members of RigSettings, as OptionSet requires.
template <class T>
T RigSettings::*RigMember(T RigSimulation::*member) {
  return member;
}

const OptionSet<RigSettings>& RigParameters() {
  static const OptionSet<RigSettings> set =
      OptionSet<RigSettings>()
          .Count("cameras", RigMember(&RigSimulation::cameras), 0, 20,
                 "cameras with overlapping views")
          .Count("lidars", RigMember(&RigSimulation::lidars), 1, 20, "LiDARs with 16 rings")
          .Count("moments", RigMember(&RigSimulation::moments), 2, 10000,
                 "moments, each with a new pose of the board")
          .Real("takes_part", RigMember(&RigSimulation::takes_part), "1", 0.1, 1.0,
                "probability that a sensor takes part in a moment")
          .Real("speed_m_s", RigMember(&RigSimulation::speed_m_s), "m/s", 0.0, 5.0,
                "speed of the board; above 0 every sensor sees it three times at 10 Hz")
          .Real("acceleration_m_s2", RigMember(&RigSimulation::acceleration_m_s2), "m/s^2", 0.0,
                10.0, "acceleration of a board that moves")
          .Real("clock_sigma_s", &RigSettings::clock_sigma_s, "s", 0.0, 0.1,
                "standard deviation of the clocks' offsets; above 0 they are estimated");
  return set;
}

/// A rig that is simulated, solved at once and by chaining its pairs, for each pair of sensors.
class RigTrials final : public Trials {
 public:
  explicit RigTrials(const RigSettings& settings) : settings_(settings) {
    // Sensors about whose systematic errors nothing is known.
    settings_.sensors.errors = LidarErrorModel{};
    const int sensors = settings.cameras + settings.lidars;
    for (int a = 0; a < sensors; ++a) {
      for (int b = a + 1; b < sensors; ++b) {
        pairs_.push_back({static_cast<std::size_t>(a), static_cast<std::size_t>(b)});
        names_.push_back(NameOf(a) + ", " + NameOf(b));
      }
    }
  }

  const std::vector<std::string>& subjects() const override { return names_; }

  void Run(const TrialId& id, TrialRows& rows) const override {
    RigSimulation simulation = settings_;
    simulation.seed = id.seed;
    DrawClocks(id.seed, simulation);
    const SimulatedRig rig = SimulateRig(simulation);
    const bool clocks = settings_.clock_sigma_s > 0.0;
    const auto all = SolveRig(rig.problem, {.estimate_time = clocks});
    const std::optional<RigEstimate> bound = all ? BoundOf(rig, *all) : std::nullopt;
    const std::vector<std::optional<Rigid3d>> from_hub = FromHub(rig);
    for (std::size_t k = 0; k < pairs_.size(); ++k) {
      MetricValues values = rows.Add(static_cast<int>(k));
      const auto& [a, b] = pairs_[k];
      const Rigid3d truth = rig.TrueBetween(a, b);
      if (all && all->sensor_from_root[a] && all->sensor_from_root[b]) {
        MeasurePair(*all, bound, pairs_[k], truth, values);
        if (clocks) MeasureClock(*all, simulation, pairs_[k], values);
      }
      if (!from_hub[a] || !from_hub[b]) continue;
      const PoseDistance off = DistanceBetween(*from_hub[a] * from_hub[b]->Inverse(), truth);
      values.Set(kRigChainedMm, kMmPerM * off.translation_m);
      values.Set(kRigChainedDeg, kDegPerRad * off.rotation_rad);
    }
  }

 private:
  struct Pair {
    std::size_t a = 0;
    std::size_t b = 0;
  };

  std::string NameOf(int sensor) const {
    return sensor < settings_.cameras ? "cam_" + std::to_string(sensor)
                                      : "lidar_" + std::to_string(sensor - settings_.cameras);
  }

  void DrawClocks(std::uint64_t seed, RigSimulation& simulation) const {
    Random random(DeriveSeed(seed, "rig: clocks", 0, 0));
    for (int s = 0; s < settings_.cameras + settings_.lidars; ++s) {
      simulation.clock_ahead_s.push_back(settings_.clock_sigma_s * random.Normal());
    }
  }

  // Not for boards that move, whose motion is no part of the simulation's truth.
  std::optional<RigEstimate> BoundOf(const SimulatedRig& rig, const RigEstimate& all) const {
    if (settings_.speed_m_s > 0.0 || !all.unconnected.empty()) return std::nullopt;
    std::vector<Rigid3d> sensors;
    std::vector<Rigid3d> boards;
    for (std::size_t s = 0; s < rig.sensor_from_rig.size(); ++s) {
      sensors.push_back(rig.TrueBetween(s, 0));
    }
    for (const Rigid3d& board : rig.rig_from_board)
      boards.push_back(rig.sensor_from_rig[0] * board);
    const auto covariance = RigBound(rig.problem, 0, sensors, boards);
    if (!covariance) return std::nullopt;
    RigEstimate bound = all;
    bound.covariance = *covariance;
    return bound;
  }

  // The pose of every sensor against the first LiDAR, by the views of these two alone.
  std::vector<std::optional<Rigid3d>> FromHub(const SimulatedRig& rig) const {
    const auto hub = static_cast<std::size_t>(settings_.cameras);
    std::vector<std::optional<Rigid3d>> from_hub(rig.sensor_from_rig.size());
    for (std::size_t s = 0; s < from_hub.size(); ++s) {
      const std::array<std::size_t, 2> sensors = {s, hub};
      if (s == hub) {
        from_hub[s] = Rigid3d{};
        continue;
      }
      const auto alone = SolveRig(Restricted(rig.problem, sensors),
                                  {.estimate_time = settings_.clock_sigma_s > 0.0});
      if (alone) from_hub[s] = alone->Between(0, 1).b_from_a;
    }
    return from_hub;
  }

  static void MeasurePair(const RigEstimate& all, const std::optional<RigEstimate>& bound,
                          const Pair& pair, const Rigid3d& truth, MetricValues& values) {
    const UncertainPose pose = all.Between(pair.a, pair.b);
    const Vector6d error = PoseDifference(pose.b_from_a, truth);
    const PoseDistance off = DistanceBetween(pose.b_from_a, truth);
    values.Set(kRigTranslationMm, kMmPerM * off.translation_m);
    values.Set(kRigRotationDeg, kDegPerRad * off.rotation_rad);
    values.Set(kRigNees, SquaredMahalanobis<6>(error, pose.covariance) / 6.0);
    if (!bound) return;
    const Matrix6d least = bound->Between(pair.a, pair.b).covariance;
    values.Set(kRigOverBound, std::sqrt(SquaredMahalanobis<6>(error, least) / 6.0));
  }

  // The root's clock is the first sensor's; only its pairs have the offset's own variance.
  static void MeasureClock(const RigEstimate& all, const RigSimulation& simulation,
                           const Pair& pair, MetricValues& values) {
    for (const RigEstimatedNumber& number : all.numbers) {
      if (pair.a != 0 || number.sensor != pair.b || number.name != kTimeOffset) continue;
      const double truth = simulation.clock_ahead_s[pair.b] - simulation.clock_ahead_s[0];
      const double error = number.value - truth;
      values.Set(kRigClockMs, 1e3 * error);
      values.Set(kRigClockNees, error * error / (number.sigma * number.sigma));
    }
  }

  RigSettings settings_;
  std::vector<Pair> pairs_;
  std::vector<std::string> names_;
};

Expected<TrialsPtr> MakeRigTrials(const KindArguments& arguments) {
  SEXTANT_ASSIGN_OR_RETURN(const RigSettings settings, RigParameters().Parse(arguments.parameters));
  if (settings.cameras + settings.lidars < 2) {
    return MakeError(ErrorCode::kInvalidOption, "a rig has two sensors or more");
  }
  if (settings.clock_sigma_s > 0.0 && !(settings.speed_m_s > 0.0)) {
    return MakeError(ErrorCode::kInvalidOption,
                     "clock_sigma_s needs a board that moves: give speed_m_s");
  }
  return std::make_shared<RigTrials>(settings);
}

}  // namespace

TrialKind RigKind() {
  return {.name = "rig",
          .summary =
              "cameras and LiDARs that see one board at several moments, solved together and by "
              "chaining pairs; one row for each pair of sensors",
          .takes_solvers = false,
          .parameters = RigParameters().Describe(),
          .metrics = RigMetrics(),
          .trials_per_block = 5,
          .make = MakeRigTrials};
}

}  // namespace sextant
