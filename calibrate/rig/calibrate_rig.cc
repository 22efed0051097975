// SPDX-License-Identifier: Apache-2.0
#include "calibrate/rig/calibrate_rig.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "base/version.h"
#include "geometry/symmetric.h"
#include "solvers/rig/rig_model.h"
#include "solvers/rig/solve_rig.h"

namespace sextant {
namespace {

std::vector<RigResultSensor> SensorsOf(const RigFile& rig, const RigEstimate& estimate) {
  std::vector<RigResultSensor> sensors;
  for (std::size_t s = 0; s < rig.problem.sensors.size(); ++s) {
    const RigSensor& of = rig.problem.sensors[s];
    RigResultSensor sensor{.name = of.name, .camera = of.camera};
    if (estimate.sensor_from_root[s]) {
      const UncertainPose pose = estimate.Between(estimate.root, s);
      sensor.root_from_sensor = pose.b_from_a;
      if (s != estimate.root) sensor.covariance = pose.covariance;
    }
    for (const RigObservationFit& fit : estimate.fits) {
      if (fit.sensor != s) continue;
      ++sensor.views;
      sensor.used += fit.used ? 1 : 0;
    }
    if (!rig.true_rig_from_sensor.empty()) {
      sensor.true_root_from_sensor =
          rig.true_rig_from_sensor[rig.root].Inverse() * rig.true_rig_from_sensor[s];
    }
    sensors.push_back(std::move(sensor));
  }
  return sensors;
}

std::vector<RigResultView> ViewsOf(const RigFile& rig, const RigEstimate& estimate) {
  std::vector<RigResultView> views;
  std::size_t placement = rig.problem.placements.size();
  for (const RigObservationFit& fit : estimate.fits) {
    if (fit.placement != placement) {
      placement = fit.placement;
      const RigPlacement& of = rig.problem.placements[placement];
      views.push_back(
          {.moment = of.name.empty() ? std::to_string(of.moment) : of.name, .board = of.board});
    }
    views.back().seen.push_back({rig.problem.sensors[fit.sensor].name, fit.used, fit.rms});
  }
  return views;
}

std::vector<RigResultNumber> NumbersOf(const RigFile& rig, const RigEstimate& estimate) {
  std::vector<RigResultNumber> numbers;
  for (const RigEstimatedNumber& number : estimate.numbers) {
    numbers.push_back(
        {rig.problem.sensors[number.sensor].name, number.name, number.value, number.sigma});
  }
  for (const RigNoiseLevel& noise : estimate.noise) {
    numbers.push_back({rig.problem.sensors[noise.sensor].name,
                       "noise of " + std::string(NameOf(noise.kind)), noise.level, std::nullopt});
  }
  return numbers;
}

struct SensorPair {
  std::size_t a = 0;
  std::size_t b = 0;
};

// Whether the offsets of clocks were estimated, which SolveRig does only if the boards move.
bool HasTimeOffsets(const RigEstimate& estimate) {
  return std::ranges::any_of(estimate.numbers, [](const RigEstimatedNumber& number) {
    return number.name == kTimeOffset;
  });
}

// The pair alone has time offsets where all sensors together have, so that both are comparable.
RigResultPair PairOf(const RigFile& rig, const RigEstimate& estimate, const SensorPair& of) {
  const UncertainPose joint = estimate.Between(of.a, of.b);
  RigResultPair pair{.a = rig.problem.sensors[of.a].name,
                     .b = rig.problem.sensors[of.b].name,
                     .a_from_b = joint.b_from_a,
                     .covariance = joint.covariance};
  const std::array<std::size_t, 2> sensors = {of.a, of.b};
  const RigProblem part = Restricted(rig.problem, sensors);
  pair.views = static_cast<int>(part.placements.size());
  if (part.placements.empty()) return pair;
  const bool has_offsets = HasTimeOffsets(estimate);
  const Expected<RigEstimate> alone =
      SolveRig(part, {.estimate_time = has_offsets, .boards_move = has_offsets});
  if (!alone) return pair;
  const UncertainPose pose = alone->Between(0, 1);
  pair.alone_a_from_b = pose.b_from_a;
  pair.alone_covariance = pose.covariance;
  const Vector6d off = PoseDifference(joint.b_from_a, pose.b_from_a);
  const double squared = SquaredMahalanobis<6>(off, pose.covariance);
  if (std::isfinite(squared)) pair.alone_sigmas = std::sqrt(squared / 6.0);
  return pair;
}

std::vector<RigResultPair> PairsOf(const RigFile& rig, const RigEstimate& estimate,
                                   const ProgressCallback& progress) {
  std::vector<SensorPair> connected;
  for (std::size_t a = 0; a < rig.problem.sensors.size(); ++a) {
    for (std::size_t b = a + 1; b < rig.problem.sensors.size(); ++b) {
      if (estimate.sensor_from_root[a] && estimate.sensor_from_root[b]) connected.push_back({a, b});
    }
  }
  std::vector<RigResultPair> pairs(connected.size());
  ProgressCounter counter(progress, "pairs of sensors", connected.size());
  tbb::parallel_for(std::size_t{0}, connected.size(), [&](std::size_t i) {
    pairs[i] = PairOf(rig, estimate, connected[i]);
    counter.Step();
  });
  counter.Finish();
  return pairs;
}

}  // namespace

Expected<RigResult> CalibrateRig(const RigFile& rig, bool estimate_time,
                                 const ProgressCallback& progress) {
  const RigOptions options{.root = rig.root, .estimate_time = estimate_time, .progress = progress};
  SEXTANT_ASSIGN_OR_RETURN(const RigEstimate estimate, SolveRig(rig.problem, options));
  return RigResult{.version = std::string(Version()),
                   .root = rig.problem.sensors[rig.root].name,
                   .sensors = SensorsOf(rig, estimate),
                   .pairs = PairsOf(rig, estimate, progress),
                   .views = ViewsOf(rig, estimate),
                   .numbers = NumbersOf(rig, estimate),
                   .unconnected = estimate.unconnected,
                   .warnings = estimate.warnings,
                   .refutations = estimate.refutations};
}

RigResult RigOfTransforms(const std::vector<Rigid3d>& cam_from_lidar) {
  RigResult result{.version = std::string(Version()), .root = "lidar"};
  result.sensors.push_back({.name = "lidar", .root_from_sensor = Rigid3d{}});
  for (std::size_t i = 0; i < cam_from_lidar.size(); ++i) {
    result.sensors.push_back({.name = "camera_" + std::to_string(i + 1),
                              .root_from_sensor = cam_from_lidar[i].Inverse()});
  }
  for (std::size_t a = 0; a < result.sensors.size(); ++a) {
    for (std::size_t b = a + 1; b < result.sensors.size(); ++b) {
      result.pairs.push_back({.a = result.sensors[a].name,
                              .b = result.sensors[b].name,
                              .a_from_b = result.sensors[a].root_from_sensor->Inverse() *
                                          *result.sensors[b].root_from_sensor});
    }
  }
  return result;
}

}  // namespace sextant
