// SPDX-License-Identifier: Apache-2.0
// Refinement of a rough pose and robust estimation with outliers, compared with Ceres' TinySolver
// and OpenCV.
#include <benchmark/benchmark.h>
#include <ceres/rotation.h>
#include <ceres/tiny_solver.h>
#include <ceres/tiny_solver_autodiff_function.h>

#include <Eigen/Geometry>
#include <optional>
#include <string>
#include <vector>

#include "bench/check.h"
#include "eval/synthetic/mismatched_pairs.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "solvers/least_squares/refine_pose.h"
#include "solvers/refine/p3p_start.h"

#ifdef SEXTANT_BENCH_OPENCV
#include <opencv2/calib3d.hpp>
#endif

namespace sextant::bench {
namespace {

constexpr Tolerance kRefined = {.rotation_rad = 0.05, .translation_m = 0.15};
constexpr Tolerance kSuccess = {.rotation_rad = 0.00873, .translation_m = 0.05};  // 0.5 deg, 5 cm.

struct RoughScene {
  RandomScene scene;
  Rigid3d start;  // 3 degrees and 5 cm off.
};

std::vector<RoughScene> RoughScenes(const benchmark::State& state) {
  Random random(2);
  std::vector<RoughScene> rough;
  for (RandomScene& scene :
       MakeScenes({.pairs = static_cast<int>(state.range(0)), .sigma_px = 1.0})) {
    Vector6d off;
    for (double& x : off) x = 0.05 * random.Normal() / 1.732;
    rough.push_back({scene, Perturb(scene.cam_from_lidar, off)});
  }
  return rough;
}

// Times call(i), the pose of problem i, after checking its results. Some failures are allowed: with
// 100 pairs and 80 percent outliers, peers fail in some scenes.
template <class Call>
void Time(benchmark::State& state, const std::vector<Rigid3d>& truths, const Tolerance& tolerance,
          std::size_t most_lost, const Call& call) {
  std::size_t lost = 0;
  for (std::size_t i = 0; i < truths.size(); ++i) {
    const PoseDistance off = DistanceBetween(call(i), truths[i]);
    lost += off.rotation_rad > tolerance.rotation_rad || off.translation_m > tolerance.translation_m
                ? 1U
                : 0U;
  }
  if (lost > 0)
    state.SetLabel(std::to_string(lost) + " of " + std::to_string(truths.size()) + " wrong");
  if (lost > most_lost) {
    state.SkipWithError(
        ("wrong in " + std::to_string(lost) + " of " + std::to_string(truths.size()) + " scenes")
            .c_str());
    return;
  }
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(call(next));
    next = next + 1 < truths.size() ? next + 1 : 0;
  }
}

std::vector<Rigid3d> TruthsOf(const std::vector<RoughScene>& scenes) {
  std::vector<Rigid3d> truths;
  for (const RoughScene& rough : scenes) truths.push_back(rough.scene.cam_from_lidar);
  return truths;
}

void Refine(benchmark::State& state) {
  const std::vector<RoughScene> scenes = RoughScenes(state);
  std::vector<PairTerms> terms;
  for (const RoughScene& rough : scenes) {
    terms.push_back(MakeTerms(rough.scene.problem, PairKind::k2d3d));
  }
  Time(state, TruthsOf(scenes), kRefined, 0, [&](std::size_t i) {
    return RefinePose(terms[i].View(), scenes[i].start, {}).cam_from_lidar;
  });
}
BENCHMARK(Refine)->Name("refine/sextant")->Arg(20);

std::vector<RandomScene> Scenes(const benchmark::State& state) {
  return MakeScenes({.pairs = static_cast<int>(state.range(0)), .sigma_px = 1.0});
}

std::vector<Rigid3d> TruthsOf(const std::vector<RandomScene>& scenes) {
  std::vector<Rigid3d> truths;
  for (const RandomScene& scene : scenes) truths.push_back(scene.cam_from_lidar);
  return truths;
}

// The kernels: least squares from pixels and points.
void RefinedP3p(benchmark::State& state) {
  const std::vector<RandomScene> scenes = Scenes(state);
  std::vector<PairTerms> terms;
  for (const RandomScene& scene : scenes) {
    terms.push_back(MakeTerms(scene.problem, PairKind::k2d3d));
  }
  Time(state, TruthsOf(scenes), kRefined, 0, [&](std::size_t i) {
    const std::optional<Rigid3d> start = StartFromTriples(terms[i].pixels.View(), terms[i].camera);
    return start ? RefinePose(terms[i].View(), *start, {}).cam_from_lidar : Rigid3d{};
  });
}
BENCHMARK(RefinedP3p)->Name("refine_p3p/sextant")->Arg(8)->Arg(20)->Arg(100)->Arg(1000);

// The complete Solve, including checks, covariance and evaluation.
void SolveRefinedP3p(benchmark::State& state) {
  std::vector<RandomScene> scenes = Scenes(state);
  for (RandomScene& scene : scenes) {
    scene.problem.pairs_3d3d.clear();
    scene.problem.point_sets = {};
  }
  const SolverPtr solver = *BuiltinSolvers().Make("refine(p3p)");
  Time(state, TruthsOf(scenes), kRefined, 0, [&](std::size_t i) {
    const Expected<SolveReport> report = solver->Solve(scenes[i].problem);
    return report ? report->cam_from_lidar : Rigid3d{};
  });
}
BENCHMARK(SolveRefinedP3p)->Name("refine_p3p_solve/sextant")->Arg(8)->Arg(20)->Arg(100)->Arg(1000);

// The obvious implementation with Ceres: reprojection errors with automatic derivatives.
struct Reprojection {
  const CalibrationProblem* problem;

  template <class T>
  bool operator()(const T* pose, T* residuals) const {
    const Camera& camera = *problem->camera;
    for (const Pair2d3d& pair : problem->pairs_2d3d) {
      const T point[3] = {T{pair.point_in_lidar.x()}, T{pair.point_in_lidar.y()},
                          T{pair.point_in_lidar.z()}};
      T p[3];
      ceres::AngleAxisRotatePoint(pose, point, p);
      *residuals++ =
          camera.fx_px * (p[0] + pose[3]) / (p[2] + pose[5]) + camera.cx_px - pair.pixel.x();
      *residuals++ =
          camera.fy_px * (p[1] + pose[4]) / (p[2] + pose[5]) + camera.cy_px - pair.pixel.y();
    }
    return true;
  }
};

void TinySolver(benchmark::State& state) {
  constexpr int kResiduals = 40;  // A fixed size, which is fastest for TinySolver.
  using Function = ceres::TinySolverAutoDiffFunction<Reprojection, kResiduals, 6>;
  const std::vector<RoughScene> scenes = RoughScenes(state);
  Time(state, TruthsOf(scenes), kRefined, 0, [&](std::size_t i) {
    const Reprojection cost{&scenes[i].scene.problem};
    Function function(cost);
    ceres::TinySolver<Function> solver;
    Eigen::Matrix<double, 6, 1> x;
    x << LogSo3(scenes[i].start.rotation), scenes[i].start.translation;
    solver.Solve(function, &x);
    return Rigid3d{ExpSo3(x.head<3>()), x.tail<3>()};
  });
}
BENCHMARK(TinySolver)->Name("refine/ceres_tiny")->Arg(20);

std::vector<RandomScene> Mismatched(int percent) {
  const RandomSceneOptions options{.pairs = 100, .sigma_px = 1.0};
  Random random(3);
  std::vector<RandomScene> scenes = MakeScenes(options);
  for (RandomScene& scene : scenes) {
    MismatchPairs(options, InlierCount(options.pairs, 0.01 * percent), random, scene);
  }
  return scenes;
}

// The complete Solve: refined, with covariance.
void Ransac(benchmark::State& state, int percent) {
  std::vector<RandomScene> scenes = Mismatched(percent);
  for (RandomScene& scene : scenes) {
    scene.problem.pairs_3d3d.clear();
    scene.problem.point_sets = {};
  }
  const SolverPtr solver = *BuiltinSolvers().Make("ransac(p3p, threshold=4)");
  Time(state, TruthsOf(scenes), kSuccess, scenes.size() / 10, [&](std::size_t i) {
    const Expected<SolveReport> report = solver->Solve(scenes[i].problem);
    return report ? report->cam_from_lidar : Rigid3d{};
  });
}
BENCHMARK_CAPTURE(Ransac, none, 0)->Name("ransac_0/sextant/100");
BENCHMARK_CAPTURE(Ransac, half, 50)->Name("ransac_50/sextant/100");
BENCHMARK_CAPTURE(Ransac, most, 80)->Name("ransac_80/sextant/100");

#ifdef SEXTANT_BENCH_OPENCV
struct OpenCvPairs {
  explicit OpenCvPairs(const CalibrationProblem& problem) {
    const Camera& camera = *problem.camera;
    intrinsics << camera.fx_px, 0.0, camera.cx_px, 0.0, camera.fy_px, camera.cy_px, 0.0, 0.0, 1.0;
    for (const Pair2d3d& pair : problem.pairs_2d3d) {
      const Eigen::Vector3d& p = pair.point_in_lidar;
      points.emplace_back(p.x(), p.y(), p.z());
      pixels.emplace_back(pair.pixel.x(), pair.pixel.y());
    }
  }

  cv::Mat_<double> intrinsics = cv::Mat_<double>(3, 3);
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
};

Rigid3d PoseOf(const cv::Mat& r, const cv::Mat& t) {
  const Eigen::Vector3d phi(r.at<double>(0), r.at<double>(1), r.at<double>(2));
  return {ExpSo3(phi), {t.at<double>(0), t.at<double>(1), t.at<double>(2)}};
}

// With our rough start, or from its own DLT start.
void OpenCvIterative(benchmark::State& state, bool use_start) {
  const std::vector<RoughScene> scenes = RoughScenes(state);
  std::vector<OpenCvPairs> pairs;
  for (const RoughScene& rough : scenes) pairs.emplace_back(rough.scene.problem);
  Time(state, TruthsOf(scenes), kRefined, 0, [&](std::size_t i) {
    const Eigen::Vector3d phi = LogSo3(scenes[i].start.rotation);
    const Eigen::Vector3d& from = scenes[i].start.translation;
    cv::Mat r = (cv::Mat_<double>(3, 1) << phi.x(), phi.y(), phi.z());
    cv::Mat t = (cv::Mat_<double>(3, 1) << from.x(), from.y(), from.z());
    cv::solvePnP(pairs[i].points, pairs[i].pixels, pairs[i].intrinsics, cv::noArray(), r, t,
                 use_start, cv::SOLVEPNP_ITERATIVE);
    return PoseOf(r, t);
  });
}
BENCHMARK_CAPTURE(OpenCvIterative, own_start, false)->Name("refine/opencv_iterative")->Arg(20);
BENCHMARK_CAPTURE(OpenCvIterative, our_start, true)
    ->Name("refine/opencv_iterative_from_start")
    ->Arg(20);

void OpenCvRansac(benchmark::State& state, int percent, int method) {
  const std::vector<RandomScene> scenes = Mismatched(percent);
  std::vector<OpenCvPairs> pairs;
  for (const RandomScene& scene : scenes) pairs.emplace_back(scene.problem);
  // A peer must be right in at least half of the scenes.
  Time(state, TruthsOf(scenes), kSuccess, scenes.size() / 2, [&](std::size_t i) {
    cv::Mat r = cv::Mat::zeros(3, 1, CV_64F);
    cv::Mat t = cv::Mat::zeros(3, 1, CV_64F);
    cv::Mat inliers;
    const bool found =
        cv::solvePnPRansac(pairs[i].points, pairs[i].pixels, pairs[i].intrinsics, cv::noArray(), r,
                           t, false, 10000, 4.0F, 0.999, inliers, method);
    return found ? PoseOf(r, t) : Rigid3d{};
  });
}
BENCHMARK_CAPTURE(OpenCvRansac, default_50, 50, cv::USAC_DEFAULT)
    ->Name("ransac_50/opencv_usac_default/100");
BENCHMARK_CAPTURE(OpenCvRansac, accurate_50, 50, cv::USAC_ACCURATE)
    ->Name("ransac_50/opencv_usac_accurate/100");
BENCHMARK_CAPTURE(OpenCvRansac, magsac_50, 50, cv::USAC_MAGSAC)
    ->Name("ransac_50/opencv_usac_magsac/100");
BENCHMARK_CAPTURE(OpenCvRansac, fast_50, 50, cv::USAC_FAST)->Name("ransac_50/opencv_usac_fast/100");
BENCHMARK_CAPTURE(OpenCvRansac, default_80, 80, cv::USAC_DEFAULT)
    ->Name("ransac_80/opencv_usac_default/100");
BENCHMARK_CAPTURE(OpenCvRansac, p3p_80, 80, cv::SOLVEPNP_P3P)
    ->Name("ransac_80/opencv_ransac_p3p/100");
#endif

}  // namespace
}  // namespace sextant::bench

BENCHMARK_MAIN();
