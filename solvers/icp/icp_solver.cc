// SPDX-License-Identifier: Apache-2.0
#include <numbers>

#include "solvers/core/registry.h"
#include "solvers/icp/icp.h"
#include "solvers/icp/projective_icp.h"

namespace sextant {
namespace {

enum class IcpStart { kIdentity, kCentroid, kPose };
enum class IcpMatching { kNearest, kProjective };

struct IcpOptions : IcpSettings {
  IcpStart init = IcpStart::kCentroid;
  IcpMatching match = IcpMatching::kNearest;
  double cell_deg = 2.0;
};

const OptionSet<IcpOptions>& IcpOptionSet() {
  static const OptionSet<IcpOptions> options =
      OptionSet<IcpOptions>()
          .Choice("init", &IcpOptions::init, {"identity", "centroid", "pose"},
                  "the start: identity, aligned centroids without rotation, or the problem's "
                  "initial pose")
          .Choice("match", &IcpOptions::match, {"nearest", "projective"},
                  "nearest points, or whole scans by the surface that the other sensor sees in the "
                  "same direction")
          .Real("cell_deg", &IcpOptions::cell_deg, "deg", 0.2, 10.0,
                "height and width of the cells that scans are cut into (match=projective)")
          .Choice<IcpMetric>(
              "metric", &IcpOptions::metric, {"point", "plane"},
              "distance to the matched point, or to the plane through its neighbours")
          .Real("max_distance_m", &IcpOptions::max_distance_m, "m", 0.0, 1e9,
                "matches at or beyond this are dropped; 0 keeps all (of projective matches: 0.5 at "
                "the start)")
          .Real("trim", &IcpOptions::trim, "1", 0.0, 0.95,
                "fraction of worst matches dropped in each iteration (match=nearest)")
          .Count<int>("neighbours", &IcpOptions::neighbours, 3, 1000,
                      "camera points that a normal is fitted to (metric=plane)")
          .Count<int>("max_iterations", &IcpOptions::max_iterations, 1, 1000000,
                      "maximum number of iterations")
          .Real("rotation_tolerance_rad", &IcpOptions::rotation_tolerance_rad, "rad", 0.0, 1.0,
                "converged when a step rotates by at most this and ...")
          .Real("translation_tolerance_m", &IcpOptions::translation_tolerance_m, "m", 0.0, 1e3,
                "... moves by at most this");
  return options;
}

class IcpSolver final : public Solver {
 public:
  IcpSolver(const std::string& name, const IcpOptions& options)
      : Solver({.name = name,
                .needs = {.points_per_set = 3, .initial_pose = options.init == IcpStart::kPose},
                .is_global = false}),
        options_(options) {}

 private:
  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override {
    const PointSets& sets = problem.point_sets;
    const Rigid3d start = StartFor(problem);
    const auto as_estimate = [](const auto& fit) {
      Estimate estimate;
      estimate.cam_from_lidar = fit.target_from_source;
      estimate.termination = fit.converged ? Termination::kConverged : Termination::kMaxIterations;
      estimate.iterations = fit.iterations;
      estimate.covariance = fit.covariance;
      return estimate;
    };
    if (options_.match == IcpMatching::kProjective) {
      return FitProjectiveIcp(sets.in_cam, sets.in_lidar, start, Projective()).map(as_estimate);
    }
    return FitIcp(sets.in_cam, sets.in_lidar, start, options_).map(as_estimate);
  }

  ProjectiveIcpSettings Projective() const {
    ProjectiveIcpSettings settings;
    settings.cell_rad = options_.cell_deg * std::numbers::pi / 180.0;
    if (options_.max_distance_m > 0.0) settings.max_distance_m = options_.max_distance_m;
    settings.max_iterations = options_.max_iterations;
    settings.rotation_tolerance_rad = options_.rotation_tolerance_rad;
    settings.translation_tolerance_m = options_.translation_tolerance_m;
    return settings;
  }

  Rigid3d StartFor(const CalibrationProblem& problem) const {
    switch (options_.init) {
      case IcpStart::kIdentity:
        return {};
      case IcpStart::kCentroid:
        return AlignCentroids(problem.point_sets.in_cam, problem.point_sets.in_lidar);
      case IcpStart::kPose:
        return *problem.initial_cam_from_lidar;
    }
    return {};
  }

  IcpOptions options_;
};

}  // namespace

SolverEntry IcpEntry() {
  return {
      .name = "icp",
      .summary = "iterative closest point on sets whose pairing is not known; local",
      .needs = "3 or more points in each frame, not on a line; near the start",
      .reference =
          "Besl and McKay 1992; Chen and Medioni 1992; Blais and Levine 1995; "
          "Chetverikov et al. 2002",
      .example = "icp(init=centroid)",
      .options = IcpOptionSet().Describe(),
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        return IcpOptionSet()
            .Parse(arguments.options)
            .map([&](const IcpOptions& options) -> SolverPtr {
              return std::make_shared<IcpSolver>(arguments.name, options);
            });
      },
  };
}

}  // namespace sextant
