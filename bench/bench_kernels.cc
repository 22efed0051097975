// SPDX-License-Identifier: Apache-2.0
// The kernels compared with those of Eigen, on the same points.
#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>

#include "base/random.h"
#include "base/simd.h"
#include "bench/check.h"
#include "geometry/random_vectors.h"
#include "geometry/so3.h"
#include "solvers/kernels/kabsch.h"

namespace sextant::bench {
namespace {

struct PointPairs {
  std::vector<Eigen::Vector3d> in_cam;
  std::vector<Eigen::Vector3d> in_lidar;
  Rigid3d cam_from_lidar;
};

constexpr double kSigma = 0.01;

// Ten sigmas of a single point: only a wrong answer has larger errors.
constexpr Tolerance kTolerance = {.rotation_rad = 0.1, .translation_m = 0.1};

std::vector<PointPairs> MakePointPairs(const benchmark::State& state) {
  const auto count = static_cast<std::size_t>(state.range(0));
  Random random(1);
  std::vector<PointPairs> all(SceneCount(state.range(0)));
  for (PointPairs& points : all) {
    points.cam_from_lidar.rotation = ExpSo3(NormalVector(random));
    points.cam_from_lidar.translation = NormalVector(random);
    for (std::size_t i = 0; i < count; ++i) {
      points.in_lidar.push_back(NormalVector(random));
      points.in_cam.push_back(points.cam_from_lidar * points.in_lidar.back() +
                              kSigma * NormalVector(random));
    }
  }
  return all;
}

void Kabsch(benchmark::State& state) {
  const std::vector<PointPairs> problems = MakePointPairs(state);
  for (const PointPairs& points : problems) {
    const Expected<KabschFit> fit = FitKabsch(points.in_cam, points.in_lidar);
    if (!fit) return state.SkipWithError(fit.error().message.c_str());
    if (!CheckPose(state, fit->b_from_a, points.cam_from_lidar, kTolerance)) return;
  }
  std::size_t next = 0;
  for (auto _ : state) {
    const PointPairs& points = problems[next];
    benchmark::DoNotOptimize(FitKabsch(points.in_cam, points.in_lidar));
    next = next + 1 < problems.size() ? next + 1 : 0;
  }
}

// Matrix: the type that stores the points; with a fixed size Eigen keeps them on the stack.
template <class Matrix>
Matrix Columns(const std::vector<Eigen::Vector3d>& points) {
  return Eigen::Map<const Eigen::Matrix3Xd>(points[0].data(), 3,
                                            static_cast<Eigen::Index>(points.size()));
}

template <class Matrix>
void Umeyama(benchmark::State& state) {
  std::vector<Matrix> in_cam;
  std::vector<Matrix> in_lidar;
  for (const PointPairs& points : MakePointPairs(state)) {
    in_cam.push_back(Columns<Matrix>(points.in_cam));
    in_lidar.push_back(Columns<Matrix>(points.in_lidar));
    const Eigen::Matrix4d matrix = Eigen::umeyama(in_lidar.back(), in_cam.back(), false);
    const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
    const Rigid3d answer{Eigen::Quaterniond(rotation), matrix.topRightCorner<3, 1>()};
    if (!CheckPose(state, answer, points.cam_from_lidar, kTolerance)) return;
  }
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(Eigen::umeyama(in_lidar[next], in_cam[next], false));
    next = next + 1 < in_lidar.size() ? next + 1 : 0;
  }
}

template <int kCount>
void UmeyamaFixed(benchmark::State& state) {
  Umeyama<Eigen::Matrix<double, 3, kCount>>(state);
}

// Elongation of 10:1 and more, where the two largest eigenvalues of Horn's matrix are close.
void KabschElongated(benchmark::State& state) {
  std::vector<PointPairs> problems(64);
  Random random(2);
  const double narrow = 1.0 / static_cast<double>(state.range(0));
  for (PointPairs& points : problems) {
    points.cam_from_lidar.rotation = ExpSo3(NormalVector(random));
    for (int i = 0; i < 8; ++i) {
      points.in_lidar.push_back(
          NormalVector(random).cwiseProduct(Eigen::Vector3d(1.0, narrow, narrow)));
      points.in_cam.push_back(points.cam_from_lidar * points.in_lidar.back() +
                              0.01 * narrow * NormalVector(random));
    }
    const Expected<KabschFit> fit = FitKabsch(points.in_cam, points.in_lidar);
    if (!fit) return state.SkipWithError(fit.error().message.c_str());
    if (!CheckPose(state, fit->b_from_a, points.cam_from_lidar, kTolerance)) return;
  }
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(FitKabsch(problems[next].in_cam, problems[next].in_lidar));
    next = next + 1 < problems.size() ? next + 1 : 0;
  }
}

SEXTANT_MULTIVERSION double ReadAll(const double* numbers, std::size_t count) {
  Vec8d sums[4] = {};
  for (std::size_t i = 0; i + 4 * kSimdWidth <= count; i += 4 * kSimdWidth) {
    for (std::size_t k = 0; k < 4; ++k) sums[k] += LoadVec(numbers + i + k * kSimdWidth);
  }
  return HorizontalSum((sums[0] + sums[1]) + (sums[2] + sums[3]));
}

// The limit set by memory: reads the same arrays once.
void Reading(benchmark::State& state) {
  const std::vector<PointPairs> problems = MakePointPairs(state);
  const std::size_t count = 3 * problems[0].in_cam.size();
  for (auto _ : state) {
    benchmark::DoNotOptimize(ReadAll(problems[0].in_cam[0].data(), count) +
                             ReadAll(problems[0].in_lidar[0].data(), count));
  }
}

void AllCounts(benchmark::internal::Benchmark* benchmark) {
  for (const int count : {3, 4, 8, 20, 100, 1000, 1000000}) benchmark->Arg(count);
}

// Names are task/implementation/N: the report compares those that differ in the second part only.
BENCHMARK(Kabsch)->Name("kabsch/sextant")->Apply(AllCounts);
BENCHMARK(Umeyama<Eigen::Matrix3Xd>)->Name("kabsch/umeyama_3xN")->Apply(AllCounts);
BENCHMARK(Umeyama<Eigen::MatrixXd>)->Name("kabsch/umeyama_dynamic")->Apply(AllCounts);
BENCHMARK(UmeyamaFixed<3>)->Name("kabsch/umeyama_fixed")->Arg(3);
BENCHMARK(UmeyamaFixed<4>)->Name("kabsch/umeyama_fixed")->Arg(4);
BENCHMARK(UmeyamaFixed<8>)->Name("kabsch/umeyama_fixed")->Arg(8);
BENCHMARK(UmeyamaFixed<20>)->Name("kabsch/umeyama_fixed")->Arg(20);
BENCHMARK(UmeyamaFixed<100>)->Name("kabsch/umeyama_fixed")->Arg(100);
BENCHMARK(KabschElongated)->Name("kabsch_elongated/sextant")->Arg(10)->Arg(30)->Arg(100);
BENCHMARK(Reading)->Name("read_points/sextant")->Arg(1000000);

}  // namespace
}  // namespace sextant::bench

BENCHMARK_MAIN();
