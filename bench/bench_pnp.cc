// SPDX-License-Identifier: Apache-2.0
// Our kernels for pixels and points compared with those of OpenCV and opengv on the same views.
#include <benchmark/benchmark.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "bench/check.h"
#include "solvers/kernels/p3p.h"
#include "solvers/pnp/dlt.h"
#include "solvers/pnp/epnp.h"
#include "solvers/pnp/ippe.h"
#include "solvers/pnp/sqpnp.h"

#ifdef SEXTANT_BENCH_OPENGV
#include <opengv/absolute_pose/CentralAbsoluteAdapter.hpp>
#include <opengv/absolute_pose/methods.hpp>
#endif
#ifdef SEXTANT_BENCH_OPENCV
#include <opencv2/calib3d.hpp>
#endif

namespace sextant::bench {
namespace {

// One view of a scene in the input formats of the kernels.
struct View {
  std::vector<Eigen::Vector3d> rays;          // Unit length.
  std::vector<Eigen::Vector2d> image_points;  // On the plane z = 1.
  std::vector<Eigen::Vector3d> points;
  Rigid3d cam_from_lidar;
};

std::vector<View> MakeViews(const RandomSceneOptions& options) {
  std::vector<View> views;
  for (const RandomScene& scene : MakeScenes(options)) {
    View& view = views.emplace_back();
    view.cam_from_lidar = scene.cam_from_lidar;
    for (const Pair2d3d& pair : scene.problem.pairs_2d3d) {
      view.rays.push_back(*Unproject(*scene.problem.camera, pair.pixel));
      view.image_points.push_back(view.rays.back().hnormalized());
      view.points.push_back(pair.point_in_lidar);
    }
  }
  return views;
}

using Poses = std::vector<Rigid3d>;

// Times prepare(view)() over the views. The pose nearest to the truth among to_poses(answer) must
// be within the tolerance in all but one of 32 views, as some peers fail in a few views even with
// exact data.
template <class Prepare, class ToPoses>
void Time(benchmark::State& state, const std::vector<View>& views, const Tolerance& tolerance,
          const Prepare& prepare, const ToPoses& to_poses) {
  std::vector<decltype(prepare(views.front()))> calls;
  std::size_t lost = 0;
  for (const View& view : views) {
    calls.push_back(prepare(view));
    const Poses poses = to_poses(calls.back()());
    const bool found = std::any_of(poses.begin(), poses.end(), [&](const Rigid3d& pose) {
      const PoseDistance off = DistanceBetween(pose, view.cam_from_lidar);
      return off.rotation_rad < tolerance.rotation_rad &&
             off.translation_m < tolerance.translation_m;
    });
    if (!found) ++lost;
  }
  if (lost > 0) state.SetLabel(std::to_string(lost) + " wrong");
  if (lost > views.size() / 32) return state.SkipWithError("too many wrong results");
  std::size_t next = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(calls[next]());
    next = next + 1 < calls.size() ? next + 1 : 0;
  }
}

// OpenCV's P3P is accurate to half of the digits at best.
constexpr Tolerance kExact = {.rotation_rad = 1e-3, .translation_m = 1e-3};
constexpr Tolerance kNoisy = {.rotation_rad = 0.3, .translation_m = 0.5};

std::vector<View> Triples() { return MakeViews({.pairs = 3}); }

std::vector<View> Planes(const benchmark::State& state) {
  const auto pairs = static_cast<int>(state.range(0));
  return MakeViews({.pairs = pairs, .sigma_px = 0.5, .planar = true});
}

std::vector<View> Cubes(const benchmark::State& state) {
  const auto pairs = static_cast<int>(state.range(0));
  return MakeViews({.pairs = pairs, .sigma_px = 0.5});
}

struct P3pAnswer {
  std::array<Rigid3d, kMaxP3pPoses> poses;
  int count = 0;
};

void P3p(benchmark::State& state) {
  const auto prepare = [](const View& view) {
    return [&view] {
      P3pAnswer answer;
      answer.count = SolveP3p(std::span<const Eigen::Vector3d, 3>(view.rays),
                              std::span<const Eigen::Vector3d, 3>(view.points), answer.poses);
      return answer;
    };
  };
  Time(state, Triples(), kExact, prepare, [](const P3pAnswer& answer) {
    return Poses(answer.poses.begin(), answer.poses.begin() + answer.count);
  });
}
BENCHMARK(P3p)->Name("p3p/sextant/3");

void Ippe(benchmark::State& state) {
  const auto prepare = [](const View& view) {
    return [&view] { return SolveIppe(view.image_points, view.points); };
  };
  Time(state, Planes(state), kNoisy, prepare, [](const Expected<IppeFit>& fit) {
    if (!fit) return Poses();
    return Poses(fit->cam_from_lidar.begin(), fit->cam_from_lidar.begin() + fit->count);
  });
}
BENCHMARK(Ippe)->Name("ippe/sextant")->Arg(5)->Arg(8)->Arg(20)->Arg(100);

void TimeEpnp(benchmark::State& state, const std::vector<View>& views) {
  const auto prepare = [](const View& view) {
    return [&view] { return SolveEpnp(view.image_points, view.points); };
  };
  Time(state, views, kNoisy, prepare,
       [](const Expected<EpnpFit>& fit) { return fit ? Poses{fit->cam_from_lidar} : Poses(); });
}

void Epnp(benchmark::State& state) { TimeEpnp(state, Cubes(state)); }
BENCHMARK(Epnp)->Name("epnp/sextant")->Arg(5)->Arg(8)->Arg(20)->Arg(100)->Arg(1000);

void EpnpOnPlane(benchmark::State& state) { TimeEpnp(state, Planes(state)); }
BENCHMARK(EpnpOnPlane)->Name("epnp_plane/sextant")->Arg(8)->Arg(20)->Arg(100);

void Sqpnp(benchmark::State& state) {
  const auto prepare = [](const View& view) {
    return [&view] { return SolveSqpnp(view.image_points, view.points); };
  };
  Time(state, Cubes(state), kNoisy, prepare, [](const Expected<SqpnpFit>& fit) {
    if (!fit) return Poses();
    return Poses(fit->cam_from_lidar.begin(), fit->cam_from_lidar.begin() + fit->count);
  });
}
BENCHMARK(Sqpnp)->Name("sqpnp/sextant")->Arg(5)->Arg(8)->Arg(20)->Arg(100)->Arg(1000);

void Dlt(benchmark::State& state) {
  const auto prepare = [](const View& view) {
    return [&view] { return SolveDlt(view.image_points, view.points); };
  };
  Time(state, Cubes(state), kNoisy, prepare,
       [](const Expected<Rigid3d>& pose) { return pose ? Poses{*pose} : Poses(); });
}
BENCHMARK(Dlt)->Name("dlt/sextant")->Arg(8)->Arg(20)->Arg(100);

#ifdef SEXTANT_BENCH_OPENGV
// The adapter is created before the call, so that only the solver is timed.
struct OpengvView {
  explicit OpengvView(const View& view)
      : bearings(view.rays.begin(), view.rays.end()),
        points(view.points.begin(), view.points.end()),
        adapter(bearings, points) {}

  opengv::bearingVectors_t bearings;
  opengv::points_t points;
  opengv::absolute_pose::CentralAbsoluteAdapter adapter;
};

template <class Solve>
void Opengv(benchmark::State& state, const std::vector<View>& views, const Tolerance& tolerance,
            const Solve& solve) {
  const auto prepare = [&](const View& view) {
    return [made = std::make_shared<OpengvView>(view), &solve] { return solve(made->adapter); };
  };
  // opengv's transformation is lidar_from_cam.
  Time(state, views, tolerance, prepare, [](const opengv::transformations_t& answers) {
    Poses poses;
    for (const opengv::transformation_t& answer : answers) {
      const Eigen::Matrix3d rotation = answer.leftCols<3>();
      poses.push_back(Rigid3d{Eigen::Quaterniond(rotation), answer.col(3)}.Inverse());
    }
    return poses;
  });
}

void OpengvKneip(benchmark::State& state) {
  Opengv(state, Triples(), kExact,
         [](const auto& adapter) { return opengv::absolute_pose::p3p_kneip(adapter, 0, 1, 2); });
}
BENCHMARK(OpengvKneip)->Name("p3p/opengv_kneip/3");

void OpengvGao(benchmark::State& state) {
  Opengv(state, Triples(), kExact,
         [](const auto& adapter) { return opengv::absolute_pose::p3p_gao(adapter, 0, 1, 2); });
}
BENCHMARK(OpengvGao)->Name("p3p/opengv_gao/3");

void OpengvEpnp(benchmark::State& state) {
  Opengv(state, Cubes(state), kNoisy, [](const auto& adapter) {
    return opengv::transformations_t{opengv::absolute_pose::epnp(adapter)};
  });
}
BENCHMARK(OpengvEpnp)->Name("epnp/opengv")->Arg(5)->Arg(8)->Arg(20)->Arg(100)->Arg(1000);
#endif

#ifdef SEXTANT_BENCH_OPENCV
struct OpenCvView {
  explicit OpenCvView(const View& view) {
    for (const Eigen::Vector3d& p : view.points) points.emplace_back(p.x(), p.y(), p.z());
    for (const Eigen::Vector2d& p : view.image_points) pixels.emplace_back(p.x(), p.y());
  }

  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
};

struct OpenCvAnswer {
  std::vector<cv::Mat> rotations;
  std::vector<cv::Mat> translations;
};

// The image points are already on the plane z = 1, so nothing is undistorted.
void OpenCv(benchmark::State& state, const std::vector<View>& views, const Tolerance& tolerance,
            int method) {
  const auto prepare = [method](const View& view) {
    return [made = std::make_shared<OpenCvView>(view), method] {
      OpenCvAnswer answer;
      const cv::Matx33d unit = cv::Matx33d::eye();
      if (method == cv::SOLVEPNP_P3P || method == cv::SOLVEPNP_AP3P) {
        cv::solveP3P(made->points, made->pixels, unit, cv::noArray(), answer.rotations,
                     answer.translations, method);
      } else {
        cv::solvePnPGeneric(made->points, made->pixels, unit, cv::noArray(), answer.rotations,
                            answer.translations, false, static_cast<cv::SolvePnPMethod>(method));
      }
      return answer;
    };
  };
  Time(state, views, tolerance, prepare, [](const OpenCvAnswer& answer) {
    Poses poses;
    for (std::size_t i = 0; i < answer.rotations.size(); ++i) {
      const cv::Vec3d r = answer.rotations[i];
      const cv::Vec3d t = answer.translations[i];
      poses.push_back({ExpSo3({r[0], r[1], r[2]}), {t[0], t[1], t[2]}});
    }
    return poses;
  });
}

void OpenCvP3p(benchmark::State& state) { OpenCv(state, Triples(), kExact, cv::SOLVEPNP_P3P); }
BENCHMARK(OpenCvP3p)->Name("p3p/opencv_p3p/3");

void OpenCvAp3p(benchmark::State& state) { OpenCv(state, Triples(), kExact, cv::SOLVEPNP_AP3P); }
BENCHMARK(OpenCvAp3p)->Name("p3p/opencv_ap3p/3");

void OpenCvIppe(benchmark::State& state) {
  OpenCv(state, Planes(state), kNoisy, cv::SOLVEPNP_IPPE);
}
BENCHMARK(OpenCvIppe)->Name("ippe/opencv_ippe")->Arg(5)->Arg(8)->Arg(20)->Arg(100);

void OpenCvEpnp(benchmark::State& state) { OpenCv(state, Cubes(state), kNoisy, cv::SOLVEPNP_EPNP); }
BENCHMARK(OpenCvEpnp)->Name("epnp/opencv")->Arg(5)->Arg(8)->Arg(20)->Arg(100)->Arg(1000);

void OpenCvSqpnp(benchmark::State& state) {
  OpenCv(state, Cubes(state), kNoisy, cv::SOLVEPNP_SQPNP);
}
BENCHMARK(OpenCvSqpnp)->Name("sqpnp/opencv")->Arg(5)->Arg(8)->Arg(20)->Arg(100)->Arg(1000);
#endif

}  // namespace
}  // namespace sextant::bench

BENCHMARK_MAIN();
