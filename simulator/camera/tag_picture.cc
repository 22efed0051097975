// SPDX-License-Identifier: Apache-2.0
#include "simulator/camera/tag_picture.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "base/random.h"
#include "features/camera/tags/tag_pattern.h"
#include "geometry/board_check.h"
#include "geometry/so3.h"
#include "simulator/scene/camera_model.h"

namespace sextant {
namespace {

constexpr int kMargin_px = 8;

Expected<void> CheckRanges(const TagPictureOptions& options) {
  const bool is_good = options.side_px >= 1.0 && options.side_px <= 1e5 && options.edge_m > 0.0 &&
                       std::isfinite(options.edge_m) && options.tilt_rad >= 0.0 &&
                       options.tilt_rad < 0.5 * std::numbers::pi && options.field >= 0.0 &&
                       options.field <= 1.0;
  if (is_good) return {};
  return MakeError(
      ErrorCode::kInvalidInput,
      fmt::format("a tag of {} m and {} px, tilted by {} rad, over {} of the image; expected a "
                  "positive side, 1 to 1e5 px, a tilt from 0 to below pi / 2 and a share in [0, 1]",
                  options.edge_m, options.side_px, options.tilt_rad, options.field));
}

// A board with the tag and two white cells around its print.
Expected<Board> BoardAround(const TagPictureOptions& options) {
  SEXTANT_ASSIGN_OR_RETURN(const TagPattern pattern, MakeTagPattern(options.family, options.id));
  const double side_m = options.edge_m * (pattern.cells + 4) / pattern.edge_cells;
  return Board{.top_right_m = side_m,
               .right_bottom_m = side_m,
               .tags = {{.family = options.family, .id = options.id, .edge_m = options.edge_m}}};
}

// A random pose: facing the camera along the line of sight, rotated in its plane, then tilted.
Expected<Rigid3d> DrawPose(const TagPictureOptions& options, const Camera& camera) {
  Random random(DeriveSeed(options.seed, "tag picture", 0, 0));
  const double u = random.Uniform(-0.5, 0.5);
  const double v = random.Uniform(-0.5, 0.5);
  const double roll = random.Uniform(0.0, 2.0 * std::numbers::pi);
  const double direction = random.Uniform(0.0, 2.0 * std::numbers::pi);
  const Eigen::Vector2d center(0.5 * (camera.width_px - 1) + u * options.field * camera.width_px,
                               0.5 * (camera.height_px - 1) + v * options.field * camera.height_px);
  const std::optional<Eigen::Vector3d> sight = Unproject(camera, center);
  if (!sight) {
    return MakeError(
        ErrorCode::kInvalidInput,
        fmt::format("camera {} has no image at pixel ({:.1f}, {:.1f}); use a smaller field",
                    options.camera_model, center.x(), center.y()));
  }
  const double depth_m = camera.fx_px * options.edge_m / options.side_px;
  const Eigen::Quaterniond facing = RotationBetween(Eigen::Vector3d::UnitZ(), *sight);
  const Eigen::Vector3d axis(std::cos(direction), std::sin(direction), 0.0);
  const Eigen::Quaterniond tilt(Eigen::AngleAxisd(options.tilt_rad, axis));
  const Eigen::Quaterniond turn(Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()));
  return Rigid3d{(facing * tilt * turn).normalized(), *sight * (depth_m / sight->z())};
}

// The camera of the image window that contains the board; none if the board is not completely in
// the image.
std::optional<Camera> WindowAround(const Camera& camera, const Board& board,
                                   const Rigid3d& cam_from_board) {
  Eigen::Array2d low(camera.width_px, camera.height_px);
  Eigen::Array2d high(-1.0, -1.0);
  for (const double x : {-0.5, 0.0, 0.5}) {
    for (const double y : {-0.5, 0.0, 0.5}) {
      const std::optional<Eigen::Vector2d> pixel = Project(
          camera,
          cam_from_board * Eigen::Vector3d(x * board.top_right_m, y * board.right_bottom_m, 0.0));
      if (!pixel) return std::nullopt;
      low = low.min(pixel->array());
      high = high.max(pixel->array());
    }
  }
  if (low.minCoeff() < 0.0 || high.x() > camera.width_px - 1 || high.y() > camera.height_px - 1) {
    return std::nullopt;
  }
  const int left = std::max(0, static_cast<int>(low.x()) - kMargin_px);
  const int top = std::max(0, static_cast<int>(low.y()) - kMargin_px);
  Camera window = camera;
  window.cx_px -= left;
  window.cy_px -= top;
  window.width_px = std::min(camera.width_px, static_cast<int>(high.x()) + kMargin_px + 1) - left;
  window.height_px = std::min(camera.height_px, static_cast<int>(high.y()) + kMargin_px + 1) - top;
  return window;
}

}  // namespace

Expected<TagPicture> RenderTagPicture(const TagPictureOptions& options) {
  SEXTANT_RETURN_IF_ERROR(CheckRanges(options));
  SEXTANT_ASSIGN_OR_RETURN(const Camera whole, FindCameraModel(options.camera_model));
  SEXTANT_ASSIGN_OR_RETURN(Board board, BoardAround(options));
  SEXTANT_ASSIGN_OR_RETURN(const Rigid3d cam_from_board, DrawPose(options, whole));
  const std::optional<Camera> camera = WindowAround(whole, board, cam_from_board);
  if (!camera) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("a board with a tag of {} px reaches beyond the image of {}; use "
                                 "a field smaller than {} or a smaller tag",
                                 options.side_px, options.camera_model, options.field));
  }
  Scene scene;
  scene.cameras = {{.intrinsics = *camera}};
  scene.boards = {{.board = board, .world_from_board = cam_from_board}};
  scene.background_albedo = 0.3;
  SEXTANT_ASSIGN_OR_RETURN(cv::Mat image, RenderImage(scene, 0, options.image));
  TagPicture picture{.image = std::move(image),
                     .camera = *camera,
                     .board = std::move(board),
                     .cam_from_board = cam_from_board,
                     .corners_px = {}};
  const std::array<Eigen::Vector2d, 4> corners = TagCorners(picture.board.tags.front());
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d in_board(corners[i].x(), corners[i].y(), 0.0);
    picture.corners_px[i] = *Project(*camera, cam_from_board * in_board);
  }
  return picture;
}

}  // namespace sextant
