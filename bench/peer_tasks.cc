// SPDX-License-Identifier: Apache-2.0
#include "bench/peer_tasks.h"

#include <benchmark/benchmark.h>
#include <fmt/core.h>

#include <cstdio>
#include <memory>

#include "base/random.h"
#include "base/units.h"
#include "bench/check.h"
#include "eval/extractors/scan_pairs.h"
#include "eval/synthetic/mismatched_pairs.h"
#include "eval/synthetic/random_scene.h"
#include "solvers/kernels/kabsch.h"

namespace sextant::bench {
namespace {

using Problems = std::vector<PointProblem>;

constexpr double kSigma = 0.01;

PointProblem FromScene(const RandomScene& scene) {
  PointProblem problem{
      .in_cam = {}, .in_lidar = {}, .sigma_m = kSigma, .cam_from_lidar = scene.cam_from_lidar};
  for (const Pair3d3d& pair : scene.problem.pairs_3d3d) {
    problem.in_cam.push_back(pair.point_in_cam);
    problem.in_lidar.push_back(pair.point_in_lidar);
  }
  return problem;
}

Problems PairProblems(int pairs, double outliers) {
  const RandomSceneOptions options{.pairs = pairs, .sigma_m = kSigma};
  Random random(3);
  Problems problems;
  for (std::size_t i = 0; i < SceneCount(pairs); ++i) {
    RandomScene scene = MakeRandomScene(options, random);
    MismatchPairs(options, InlierCount(pairs, outliers), random, scene);
    problems.push_back(FromScene(scene));
  }
  return problems;
}

// The error of least squares on the true pairs; no solver is expected to do better.
double OracleError(const PointProblem& problem, double outliers) {
  const auto inliers =
      static_cast<std::size_t>(InlierCount(static_cast<int>(problem.in_cam.size()), outliers));
  const std::span<const Eigen::Vector3d> in_cam(problem.in_cam);
  const std::span<const Eigen::Vector3d> in_lidar(problem.in_lidar);
  const Expected<KabschFit> fit = FitKabsch(in_cam.first(inliers), in_lidar.first(inliers));
  return fit ? DistanceBetween(fit->b_from_a, problem.cam_from_lidar).rotation_rad : 1.0;
}

// Eight corners of two boards, in a different order in the second list.
Problems CornerProblems() {
  Random random(5);
  Problems problems(64);
  for (PointProblem& problem : problems) {
    Vector6d off;
    for (double& x : off) x = 3.0 * kRadPerDeg / 1.732 * random.Normal();
    problem.cam_from_lidar = Perturb(LocalStart(), off);
    for (const double side : {-0.5, 0.5}) {
      for (const auto& [across, up] :
           {std::pair{0.0, 0.3}, std::pair{0.3, 0.0}, std::pair{0.0, -0.3}, std::pair{-0.3, 0.0}}) {
        problem.in_lidar.push_back({side + across, up, 2.0 + 0.4 * side + 0.2 * across});
      }
    }
    for (const Eigen::Vector3d& point : problem.in_lidar) {
      Eigen::Vector3d noise;
      for (double& x : noise) x = 0.5 * kSigma * random.Normal();
      problem.in_cam.push_back(problem.cam_from_lidar * point + noise);
    }
    std::rotate(problem.in_cam.begin(), problem.in_cam.begin() + 3, problem.in_cam.end());
  }
  return problems;
}

Problems RoomProblems() {
  LidarModel model = *FindLidarModel("vlp16");
  model.ring_bias_sigma_m = 0.0;
  Problems problems;
  for (std::uint64_t room = 0; room < 3; ++room) {
    const Expected<ScanPair> pair = ScanRoomTwice(model, room);
    if (!pair) continue;
    problems.push_back({.in_cam = pair->in_target,
                        .in_lidar = pair->in_source,
                        .sigma_m = 0.02,
                        .cam_from_lidar = pair->target_from_source});
  }
  return problems;
}

// Allowed errors of each problem.
using Allowed = std::vector<Tolerance>;

// The calls of a peer, prepared and checked once for all repetitions.
struct Checked {
  Problems problems;
  std::vector<PeerCall> calls;
  std::size_t wrong = 0;
  double worst_rad = 0.0;
};

std::shared_ptr<const Checked> Check(Problems problems, const Allowed& allowed,
                                     const Prepare& prepare) {
  const auto checked = std::make_shared<Checked>();
  checked->problems = std::move(problems);
  for (std::size_t i = 0; i < checked->problems.size(); ++i) {
    checked->calls.push_back(prepare(checked->problems[i]));
    const std::optional<Rigid3d> answer = checked->calls.back()();
    const PoseDistance off = answer ? DistanceBetween(*answer, checked->problems[i].cam_from_lidar)
                                    : PoseDistance{.rotation_rad = 3.14, .translation_m = 1e9};
    checked->worst_rad = std::max(checked->worst_rad, off.rotation_rad);
    checked->wrong +=
        off.rotation_rad > allowed[i].rotation_rad || off.translation_m > allowed[i].translation_m
            ? 1U
            : 0U;
  }
  return checked;
}

void Time(benchmark::State& state, const Checked& checked) {
  const std::size_t all = checked.calls.size();
  if (checked.wrong > 0) state.SetLabel(fmt::format("{} of {} wrong", checked.wrong, all));
  if (10 * checked.wrong > all) {
    return state.SkipWithError(fmt::format("wrong in {} of {}, by up to {:.2g} deg", checked.wrong,
                                           all, checked.worst_rad / kRadPerDeg)
                                   .c_str());
  }
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(checked.calls[next]());
    next = next + 1 < all ? next + 1 : 0;
  }
}

template <class Make>
void Register(const std::string& task, const std::string& peer, int count, const Prepare& prepare,
              const Make& make) {
  benchmark::RegisterBenchmark(
      fmt::format("{}/{}/{}", task, peer, count).c_str(),
      [prepare, make, checked = std::shared_ptr<const Checked>()](benchmark::State& state) mutable {
        if (!checked) {
          auto [problems, allowed] = make();
          checked = Check(std::move(problems), allowed, prepare);
        }
        Time(state, *checked);
      });
}

}  // namespace

void RegisterPairs(const std::string& peer, const Prepare& prepare) {
  for (const int pairs : {8, 100, 1000}) {
    Register("pairs", peer, pairs, prepare, [pairs] {
      const Problems problems = PairProblems(pairs, 0.0);
      return std::pair(problems, Allowed(problems.size(), {0.05, 0.2}));
    });
  }
}

void RegisterOutliers(const std::string& peer, const Prepare& prepare) {
  const auto add = [&](int pairs, int percent) {
    Register(fmt::format("pairs_{}", percent), peer, pairs, prepare, [pairs, percent] {
      const Problems problems = PairProblems(pairs, 0.01 * percent);
      Allowed allowed;
      for (const PointProblem& problem : problems) {
        const double oracle = OracleError(problem, 0.01 * percent);
        allowed.push_back({std::max(0.5 * kRadPerDeg, 1.5 * oracle), 0.3});
      }
      return std::pair(problems, allowed);
    });
  };
  for (const int percent : {20, 50, 80, 95}) add(100, percent);
  for (const int percent : {50, 80, 95}) add(1000, percent);
}

void RegisterCorners(const std::string& peer, const Prepare& prepare) {
  Register("corners", peer, 8, prepare, [] {
    const Problems problems = CornerProblems();
    return std::pair(problems, Allowed(problems.size(), {0.05, 0.1}));
  });
}

void RegisterRooms(const std::string& peer, const Prepare& prepare) {
  Register("room", peer, 16, prepare, [] {
    const Problems problems = RoomProblems();
    return std::pair(problems, Allowed(problems.size(), {0.1 * kRadPerDeg, 0.02}));
  });
}

}  // namespace sextant::bench
