// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <numbers>

#include "eval/experiment/kinds/problem_trials.h"
#include "eval/synthetic/mismatched_pairs.h"
#include "eval/synthetic/random_scene.h"

namespace sextant {
namespace {

enum class Data { kPoints, kPixels, kBoth };

struct RandomSceneTrialSettings : PoseLimits {
  Data data = Data::kBoth;
  int pairs = 8;
  double sigma_m = 0.01;
  double sigma_px = 1.0;
  bool planar = false;
  double depth_m = 3.0;
  double extent_m = 1.0;
  double max_rotation_deg = 180.0;
  double outliers = 0.0;
  bool known_inliers = false;
  double focal_error = 0.0;
  double scale_error = 0.0;
  bool on_boards = false;
  double shared_error = 0.0;
  bool states_noise = true;
};

const OptionSet<RandomSceneTrialSettings>& RandomSceneTrialParameters() {
  static const OptionSet<RandomSceneTrialSettings> set = AddPoseLimits(
      OptionSet<RandomSceneTrialSettings>()
          .Choice("data", &RandomSceneTrialSettings::data, {"points", "pixels", "both"},
                  "3D-3D pairs and point sets, 2D-3D pairs, or both of the same points")
          .Count("pairs", &RandomSceneTrialSettings::pairs, 3, 1'000'000,
                 "number of points in the scene")
          .Real("sigma_m", &RandomSceneTrialSettings::sigma_m, "m", 1e-9, 10.0,
                "noise of 3D-3D pairs, per axis")
          .Real("sigma_px", &RandomSceneTrialSettings::sigma_px, "px", 1e-9, 1e3,
                "noise of pixels, per axis")
          .Choice("planar", &RandomSceneTrialSettings::planar, {"false", "true"},
                  "all points lie on one plane of random tilt")
          .Real("depth_m", &RandomSceneTrialSettings::depth_m, "m", 0.01, 1e4,
                "distance of the points' centre from the camera")
          .Real("extent_m", &RandomSceneTrialSettings::extent_m, "m", 1e-3, 1e4,
                "half the side of the cube that holds the points")
          .Real("max_rotation_deg", &RandomSceneTrialSettings::max_rotation_deg, "deg", 0.0, 180.0,
                "maximum angle of the true rotation")
          .Real("outliers", &RandomSceneTrialSettings::outliers, "1", 0.0, 0.99,
                "fraction of the pairs that join different points")
          .Choice("known_inliers", &RandomSceneTrialSettings::known_inliers, {"false", "true"},
                  "give the solvers only the true pairs: the accuracy that noise alone allows")
          .Real("focal_error", &RandomSceneTrialSettings::focal_error, "1", -0.5, 0.5,
                "relative error of the focal lengths given to the solver")
          .Real("scale_error", &RandomSceneTrialSettings::scale_error, "1", -0.5, 0.5,
                "relative error of the distances in the camera frame, as of a wrong board size")
          .Choice("on_boards", &RandomSceneTrialSettings::on_boards, {"false", "true"},
                  "the pairs are the corners of square boards, four of each")
          .Real("shared_error", &RandomSceneTrialSettings::shared_error, "sigma", 0.0, 100.0,
                "error common to the pairs of a board, in units of the noise of a pair")
          .Choice("states_noise", &RandomSceneTrialSettings::states_noise, {"false", "true"},
                  "whether the solvers get the noise; not that common to a board"));
  return set;
}

// Applies systematic errors that the solver does not know.
void Distort(const RandomSceneTrialSettings& settings, CalibrationProblem& problem) {
  problem.camera->fx_px *= 1.0 + settings.focal_error;
  problem.camera->fy_px *= 1.0 + settings.focal_error;
  for (Pair3d3d& pair : problem.pairs_3d3d) pair.point_in_cam *= 1.0 + settings.scale_error;
  for (Eigen::Vector3d& point : problem.point_sets.in_cam) point *= 1.0 + settings.scale_error;
}

void Restrict(Data data, CalibrationProblem& problem) {
  if (data == Data::kPoints) problem.pairs_2d3d.clear();
  if (data == Data::kPixels) {
    problem.pairs_3d3d.clear();
    problem.point_sets = {};
  }
}

// Exact pairs of further points in the same cube.
CalibrationProblem HeldOut(const RandomSceneOptions& scene, const Rigid3d& cam_from_lidar,
                           const Camera& camera, Random& random) {
  constexpr int kPairs = 20;
  CalibrationProblem held_out;
  held_out.camera = camera;
  const Rigid3d lidar_from_cam = cam_from_lidar.Inverse();
  for (int i = 0; i < kPairs; ++i) {
    Eigen::Vector3d in_cam(0.0, 0.0, scene.depth_m);
    for (int axis = 0; axis < 3; ++axis) {
      in_cam[axis] += random.Uniform(-scene.extent_m, scene.extent_m);
    }
    held_out.pairs_3d3d.push_back({.point_in_cam = in_cam,
                                   .point_in_lidar = lidar_from_cam * in_cam,
                                   .covariance_in_cam = {},
                                   .id = {}});
    const std::optional<Eigen::Vector2d> pixel = Project(camera, in_cam);
    if (!pixel) continue;
    held_out.pairs_2d3d.push_back(
        {.pixel = *pixel, .point_in_lidar = lidar_from_cam * in_cam, .id = {}});
  }
  return held_out;
}

KnownProblem MakeRandomSceneTrialProblem(const RandomSceneTrialSettings& settings,
                                         const TrialId& id) {
  Random random(id.seed);
  const RandomSceneOptions options{
      .pairs = settings.pairs,
      .sigma_m = settings.sigma_m,
      .sigma_px = settings.sigma_px,
      .planar = settings.planar,
      .depth_m = settings.depth_m,
      .extent_m = settings.extent_m,
      .max_rotation_rad = settings.max_rotation_deg * std::numbers::pi / 180.0,
      .on_boards = settings.on_boards,
      .shared_error = settings.shared_error,
      .states_noise = settings.states_noise};
  RandomScene scene = MakeRandomScene(options, random);
  const int inliers = InlierCount(settings.pairs, settings.outliers);
  KnownProblem known;
  known.cam_from_lidar = scene.cam_from_lidar;
  known.inliers = scene.problem;
  known.inliers.pairs_3d3d.resize(static_cast<std::size_t>(inliers));
  known.inliers.pairs_2d3d.resize(static_cast<std::size_t>(inliers));
  if (inliers < settings.pairs) MismatchPairs(options, inliers, random, scene);
  known.held_out = HeldOut(options, known.cam_from_lidar, *scene.problem.camera, random);
  known.problem = settings.known_inliers ? known.inliers : std::move(scene.problem);
  Distort(settings, known.problem);
  Restrict(settings.data, known.problem);
  return known;
}

Expected<TrialsPtr> MakeRandomSceneTrialTrials(const KindArguments& arguments) {
  SEXTANT_ASSIGN_OR_RETURN(RandomSceneTrialSettings settings,
                           RandomSceneTrialParameters().Parse(arguments.parameters));
  if (settings.depth_m < 1.8 * settings.extent_m) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("extent_m = {} puts points behind the camera at depth_m = {}; "
                                 "expected depth_m of at least 1.8 extent_m",
                                 settings.extent_m, settings.depth_m));
  }
  return MakeProblemTrials({[s = settings](const TrialId& id) -> Expected<KnownProblem> {
                              return MakeRandomSceneTrialProblem(s, id);
                            },
                            settings},
                           arguments.solvers, arguments.condition);
}

}  // namespace

TrialKind RandomSceneKind() {
  return {
      .name = "random_scene",
      .summary = "random pose and points in front of a camera of 1280 x 720 pixels and f = 700 px",
      .parameters = RandomSceneTrialParameters().Describe(),
      .metrics = PoseMetrics(),
      .make = MakeRandomSceneTrialTrials};
}

}  // namespace sextant
