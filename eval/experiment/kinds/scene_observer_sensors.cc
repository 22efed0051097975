// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <numbers>

#include "eval/experiment/kinds/scene_observer.h"
#include "features/camera/board_pose.h"
#include "features/lidar/corner_extractor.h"
#include "geometry/board_check.h"
#include "geometry/random_vectors.h"
#include "simulator/camera/render.h"
#include "simulator/lidar/scan.h"

// The simulation of the two sensors of SceneObserver.
namespace sextant {
namespace {

std::uint64_t Of(int number) { return static_cast<std::uint64_t>(number); }

}  // namespace

std::optional<Eigen::Vector2d> SceneObserver::PixelOf(const SceneBoard& board, double time_s,
                                                      const Eigen::Vector3d& in_board) const {
  const Rigid3d& world_from_cam =
      scene_.cameras[static_cast<std::size_t>(camera_index_)].world_from_cam;
  const std::optional<Eigen::Vector2d> pixel =
      Project(camera_, world_from_cam.Inverse() * (BoardPoseAt(board, time_s) * in_board));
  const bool is_inside = pixel && pixel->x() > -0.5 && pixel->x() < camera_.width_px - 0.5 &&
                         pixel->y() > -0.5 && pixel->y() < camera_.height_px - 0.5;
  return is_inside ? pixel : std::nullopt;
}

bool SceneObserver::CanFind(const SceneBoard& board) const {
  const bool is_printed = !board.board.tags.empty() ||
                          (board.board.checker && settings_.camera == CameraObservation::kRendered);
  return (is_printed || settings_.camera == CameraObservation::kMarked) &&
         PixelOf(board, 0.0, Eigen::Vector3d::Zero()).has_value();
}

Expected<std::vector<SceneObserver::SeenCorners>> SceneObserver::ObserveWithLidar(
    const Scene& scene, std::uint64_t unit_seed, int view, double time_s) const {
  std::vector<SeenCorners> seen(scene.boards.size());
  Random random(DeriveSeed(unit_seed, "lidar corners", Of(view), 0));
  if (settings_.lidar == LidarObservation::kNoise) {
    const double sigma = settings_.lidar_sigma_m;
    for (std::size_t b = 0; b < seen.size(); ++b) {
      // The image is taken in the middle of a LiDAR revolution.
      const Rigid3d pose = BoardPoseAt(scene.boards[b], time_s + 0.5 * lidar_.turn_period_s);
      for (const Eigen::Vector3d& corner : BoardCorners(scene.boards[b].board)) {
        seen[b].points.push_back(scene.lidar.world_from_lidar.Inverse() * (pose * corner) +
                                 sigma * NormalVector(random));
      }
      const auto size = 3 * std::ssize(seen[b].points);
      seen[b].covariance = sigma * sigma * Eigen::MatrixXd::Identity(size, size);
    }
  } else {
    SEXTANT_ASSIGN_OR_RETURN(
        const SimulatedScan scan,
        SimulateScan(scene, lidar_,
                     {.seed = unit_seed, .scan_index = view, .start_time_s = time_s}));
    SEXTANT_ASSIGN_OR_RETURN(const ScanRings rings, ScanRings::Build(scan.cloud));
    const std::vector<Board> boards = BoardsIn(scene_);
    SEXTANT_ASSIGN_OR_RETURN(const BoardSearch search,
                             FindBoards(rings, boards, {.correct_edges = settings_.correct_edges}));
    for (const BoardPatch& patch : search.found) {
      const auto b = static_cast<std::size_t>(patch.board);
      const Expected<LidarCorners> corners = ExtractCorners(settings_.extractor, patch, boards[b]);
      if (corners) seen[b] = {corners->in_lidar, corners->covariance};
    }
  }
  for (SeenCorners& corners : seen) {
    if (corners.points.empty() || settings_.lidar_bias_m == 0.0) continue;
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < 4; ++i) middle += 0.25 * corners.points[i];
    for (Eigen::Vector3d& point : corners.points) {
      point += settings_.lidar_bias_m * (point - middle).normalized();
    }
  }
  return seen;
}

SceneObserver::SeenCorners SceneObserver::CornersOfTags(const SceneBoard& scene_board,
                                                        double time_s, Random& random) const {
  const Board& board = scene_board.board;
  std::vector<BoardPoints> groups;
  const auto see = [&](const Eigen::Vector2d& in_board, BoardPoints& group) {
    const std::optional<Eigen::Vector2d> pixel =
        PixelOf(scene_board, time_s, {in_board.x(), in_board.y(), 0.0});
    const double du = settings_.tag_sigma_px * random.Normal();
    const double dv = settings_.tag_sigma_px * random.Normal();
    if (!pixel) return;
    group.in_board_m.push_back(in_board);
    group.pixels.push_back(*pixel + Eigen::Vector2d(du, dv));
  };
  for (const BoardTag& tag : board.tags) {
    BoardPoints& group = groups.emplace_back();
    for (const Eigen::Vector2d& corner : TagCorners(tag)) see(corner, group);
  }
  std::erase_if(groups, [](const BoardPoints& group) { return group.pixels.size() < 4; });
  for (BoardPoints& group : groups) {
    const auto size = 2 * std::ssize(group.pixels);
    group.covariance_px2 =
        settings_.tag_sigma_px * settings_.tag_sigma_px * Eigen::MatrixXd::Identity(size, size);
  }
  if (groups.empty()) return {};
  const Expected<BoardPose> pose = EstimateBoardPose(assumed_camera_, groups);
  if (!pose) return {};
  PointsInCam corners = ToCamera(*pose, BoardCorners(board));
  return {std::move(corners.points), std::move(corners.covariance)};
}

Expected<std::vector<SceneObserver::SeenCorners>> SceneObserver::CornersInImage(
    const Scene& scene, std::uint64_t seed, double time_s) const {
  SEXTANT_ASSIGN_OR_RETURN(const cv::Mat image,
                           RenderImage(scene, camera_index_, UsualImageOptions(seed, time_s)));
  SEXTANT_ASSIGN_OR_RETURN(const SeenBoards found, finder_->Find(image));
  std::vector<SeenCorners> seen(scene.boards.size());
  for (const SeenBoard& board : found.boards) {
    if (!board.pose || !*board.pose) continue;
    seen[board.index] = {board.corners.points, board.corners.covariance};
  }
  return seen;
}

Expected<std::vector<SceneObserver::SeenCorners>> SceneObserver::ObserveWithCamera(
    const Scene& scene, std::uint64_t unit_seed, int view, double time_s) const {
  const std::uint64_t seed = DeriveSeed(unit_seed, "camera corners", Of(view), 0);
  const double middle_s = time_s + 0.5 * lidar_.turn_period_s;
  if (settings_.camera == CameraObservation::kRendered)
    return CornersInImage(scene, seed, middle_s);
  Random random(seed);
  std::vector<SeenCorners> seen;
  for (const SceneBoard& board : scene.boards) {
    seen.push_back(CornersOfTags(board, middle_s, random));
  }
  return seen;
}

void SceneObserver::MarkCorners(const Scene& scene, const std::vector<SeenCorners>& in_lidar,
                                std::uint64_t unit_seed, int view, double time_s,
                                CalibrationProblem& problem) const {
  Random random(DeriveSeed(unit_seed, "marked corners", Of(view), 0));
  const double middle_s = time_s + 0.5 * lidar_.turn_period_s;
  for (std::size_t b = 0; b < scene.boards.size(); ++b) {
    const std::vector<Eigen::Vector3d> in_board = BoardCorners(scene.boards[b].board);
    for (std::size_t i = 0; i < in_board.size() && i < in_lidar[b].points.size(); ++i) {
      const double du = settings_.mark_sigma_px * random.Normal();
      const double dv = settings_.mark_sigma_px * random.Normal();
      const std::optional<Eigen::Vector2d> pixel = PixelOf(scene.boards[b], middle_s, in_board[i]);
      if (!pixel) continue;
      problem.pairs_2d3d.push_back(
          {.pixel = *pixel + Eigen::Vector2d(du, dv),
           .point_in_lidar = in_lidar[b].points[i],
           .sigma_px = settings_.state_noise ? settings_.mark_sigma_px : 0.0,
           .id = {view, scene.boards[b].board.id, static_cast<int>(i)}});
    }
  }
  const auto count =
      std::min(problem.pairs_2d3d.size(), static_cast<std::size_t>(settings_.outliers));
  std::vector<int> displaced(count);
  random.Sample(static_cast<int>(problem.pairs_2d3d.size()), displaced);
  for (const int i : displaced) {
    const double angle = random.Uniform(0.0, 2.0 * std::numbers::pi);
    problem.pairs_2d3d[static_cast<std::size_t>(i)].pixel +=
        settings_.outlier_px * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
}

}  // namespace sextant
