// SPDX-License-Identifier: Apache-2.0
#include "simulator/camera/camera_view.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>
#include <utility>

namespace sextant {
namespace {

Expected<void> CheckPlace(const std::string& what, const Rigid3d& pose,
                          std::initializer_list<double> sides_m) {
  for (const double side_m : sides_m) {
    if (!pose.IsFinite() || !std::isfinite(side_m)) {
      return MakeError(ErrorCode::kNonFinite, what + " has a NaN or infinite pose or side");
    }
    if (!(side_m > 0.0)) {
      return MakeError(ErrorCode::kInvalidInput,
                       fmt::format("{} has a side of {} m, expected more than 0", what, side_m));
    }
  }
  return {};
}

Expected<void> CheckAlbedo(const std::string& what, double albedo) {
  if (albedo >= 0.0 && albedo <= 1.0) return {};
  return MakeError(ErrorCode::kInvalidInput,
                   fmt::format("{} has an albedo of {}, expected 0 to 1", what, albedo));
}

// Tiles are numbered by an int.
Expected<void> CheckTiles(const SceneWall& wall) {
  constexpr double kMin_m = 1e-3;
  constexpr double kMaxAlong = 30'000.0;
  const double longest_m = std::max(wall.width_m, wall.height_m);
  const bool is_fine = wall.tile_m >= kMin_m && longest_m <= kMaxAlong * wall.tile_m;
  if (wall.tile_m == 0.0 || (is_fine && std::isfinite(wall.tile_m))) return {};
  return MakeError(
      ErrorCode::kInvalidInput,
      fmt::format("wall {} has tiles of {} m, expected 0 for none, or {} and more, and "
                  "at most {} along a side",
                  wall.name, wall.tile_m, kMin_m, kMaxAlong));
}

// The first error of several checks.
Expected<void> FirstOf(std::initializer_list<Expected<void>> checks) {
  for (const Expected<void>& check : checks) {
    if (!check) return check;
  }
  return {};
}

struct ViewFrame {
  Rigid3d cam_from_world;
  Lighting lighting;
};

// An illuminated face with two colours; none if the camera is in its plane.
std::optional<ViewRectangle> LitFace(const ViewFrame& frame, const Rigid3d& world_from_face,
                                     double width_m, double height_m, double white_albedo,
                                     double black_albedo) {
  std::optional<ViewRectangle> face =
      MakeViewRectangle(frame.cam_from_world * world_from_face, width_m, height_m);
  if (!face) return std::nullopt;
  const double light =
      Irradiance(frame.lighting, frame.cam_from_world.rotation.conjugate() * face->normal_in_cam);
  face->white = white_albedo * light;
  face->black = black_albedo * light;
  return face;
}

std::optional<ViewRectangle> WallFace(const ViewFrame& frame, const SceneWall& wall) {
  // Tiles differ by a twelfth of their brightness, like worn flooring.
  constexpr double kDarkerTile = 11.0 / 12.0;
  constexpr double kDarkestSpeckle = 0.2;
  const double albedo = wall.surface.albedo;
  const double darkest = wall.speckled ? kDarkestSpeckle : kDarkerTile;
  std::optional<ViewRectangle> face =
      LitFace(frame, wall.world_from_wall, wall.width_m, wall.height_m, albedo, darkest * albedo);
  if (!face) return std::nullopt;
  face->tile_m = wall.tile_m;
  if (wall.tile_m > 0.0) {
    face->tile_columns = static_cast<int>(2.0 * face->half_width_m / wall.tile_m) + 1;
  }
  face->speckled = wall.speckled;
  return face;
}

std::optional<ViewRectangle> BoardFace(const ViewFrame& frame, const SceneBoard& board,
                                       const Rigid3d& world_from_board, BoardPrint print) {
  std::optional<ViewRectangle> face =
      LitFace(frame, world_from_board, board.board.top_right_m, board.board.right_bottom_m,
              board.white.albedo, board.black.albedo);
  if (!face) return std::nullopt;
  face->hole = board.board.hole;
  face->round_holes = board.board.round_holes;
  const Eigen::Vector3d into_board =
      frame.cam_from_world.rotation * (world_from_board.rotation * Eigen::Vector3d::UnitZ());
  if (face->normal_in_cam.dot(into_board) < 0.0) face->print = std::move(print);
  return face;
}

// The faces of a box that are visible from the camera, at most three.
void AddBoxFaces(const ViewFrame& frame, const SceneBox& box, std::vector<ViewRectangle>& faces) {
  for (int normal = 0; normal < 3; ++normal) {
    const int x = (normal + 1) % 3;
    const int y = (normal + 2) % 3;
    Eigen::Matrix3d axes = Eigen::Matrix3d::Zero();
    axes(x, 0) = axes(y, 1) = axes(normal, 2) = 1.0;
    for (const double side : {-0.5, 0.5}) {
      const Eigen::Vector3d center = side * box.size_m[normal] * Eigen::Vector3d::Unit(normal);
      const Rigid3d box_from_face{Eigen::Quaterniond(axes), center};
      const std::optional<ViewRectangle> face =
          LitFace(frame, box.world_from_box * box_from_face, box.size_m[x], box.size_m[y],
                  box.surface.albedo, 0.0);
      if (!face) continue;
      const Eigen::Vector3d outward =
          frame.cam_from_world.rotation * (box.world_from_box.rotation * center);
      if (face->normal_in_cam.dot(outward) > 0.0) faces.push_back(*face);
    }
  }
}

ViewCylinder CylinderOf(const ViewFrame& frame, const SceneCylinder& cylinder) {
  return {.base_in_cam = frame.cam_from_world * cylinder.base_in_world,
          .axis_in_cam = frame.cam_from_world.rotation * Eigen::Vector3d::UnitZ(),
          .radius_m = cylinder.radius_m,
          .height_m = cylinder.height_m,
          .albedo = cylinder.surface.albedo,
          .lighting = frame.lighting,
          .world_from_cam = frame.cam_from_world.rotation.conjugate().toRotationMatrix()};
}

// Whether the cone about `axis` may touch the sphere. Rounding errors are far below the slack.
bool MayTouch(const Eigen::Vector3d& axis, double half_angle_rad, const Eigen::Vector3d& center,
              double radius) {
  constexpr double kSlack_rad = 1e-6;
  const double distance = center.norm();
  if (distance <= radius) return true;
  const double angle = std::atan2(axis.cross(center).norm(), axis.dot(center));
  return angle <= half_angle_rad + std::asin(radius / distance) + kSlack_rad;
}

}  // namespace

Expected<CameraView> CameraView::Make(const Scene& scene, const Rigid3d& world_from_cam,
                                      double time_s, const Lighting& lighting) {
  const ViewFrame frame{world_from_cam.Inverse(), lighting};
  CameraView view;
  view.background_ = scene.background_albedo;
  const auto add = [&view](std::optional<ViewRectangle> face) {
    if (face) view.rectangles_.push_back(*std::move(face));
  };
  Expected<void> ok = FirstOf({CheckPlace("the camera", world_from_cam, {1.0}),
                               CheckAlbedo("the background", scene.background_albedo)});
  for (const SceneBoard& board : scene.boards) {
    if (!ok) break;
    const Rigid3d world_from_board = BoardPoseAt(board, time_s);
    const std::string name = fmt::format("board {}", board.board.id);
    ok = FirstOf({CheckPlace(name, world_from_board, {1.0}), CheckAlbedo(name, board.white.albedo),
                  CheckAlbedo(name, board.black.albedo)});
    Expected<BoardPrint> print = BoardPrint::Make(board.board);
    if (ok && !print) return tl::unexpected(print.error());
    if (ok) add(BoardFace(frame, board, world_from_board, *std::move(print)));
  }
  for (const SceneWall& wall : scene.walls) {
    if (!ok) break;
    ok = FirstOf(
        {CheckPlace("wall " + wall.name, wall.world_from_wall, {wall.width_m, wall.height_m}),
         CheckAlbedo("wall " + wall.name, wall.surface.albedo), CheckTiles(wall)});
    if (ok) add(WallFace(frame, wall));
  }
  for (const SceneBox& box : scene.boxes) {
    if (!ok) break;
    ok = FirstOf({CheckPlace("box " + box.name, box.world_from_box,
                             {box.size_m.x(), box.size_m.y(), box.size_m.z()}),
                  CheckAlbedo("box " + box.name, box.surface.albedo)});
    if (ok) AddBoxFaces(frame, box, view.rectangles_);
  }
  for (const SceneCylinder& cylinder : scene.cylinders) {
    if (!ok) break;
    const std::string name = "cylinder " + cylinder.name;
    ok = FirstOf({CheckPlace(name, {.translation = cylinder.base_in_world},
                             {cylinder.radius_m, cylinder.height_m}),
                  CheckAlbedo(name, cylinder.surface.albedo)});
    if (ok) view.cylinders_.push_back(CylinderOf(frame, cylinder));
  }
  if (!ok) return tl::unexpected(ok.error());
  return view;
}

void CameraView::FindCandidates(const Eigen::Vector3d& axis, double half_angle_rad,
                                std::vector<int>& candidates) const {
  candidates.clear();
  int index = 0;
  for (const ViewRectangle& face : rectangles_) {
    const double radius = std::hypot(face.half_width_m, face.half_height_m);
    if (MayTouch(axis, half_angle_rad, face.center_in_cam, radius)) candidates.push_back(index);
    ++index;
  }
  for (const ViewCylinder& cylinder : cylinders_) {
    const double radius = std::hypot(cylinder.radius_m, 0.5 * cylinder.height_m);
    const Eigen::Vector3d center =
        cylinder.base_in_cam + 0.5 * cylinder.height_m * cylinder.axis_in_cam;
    if (MayTouch(axis, half_angle_rad, center, radius)) candidates.push_back(index);
    ++index;
  }
}

bool CameraView::HasSliver(std::span<const int> candidates, double width_rad) const {
  const int rectangles = static_cast<int>(rectangles_.size());
  return std::ranges::any_of(candidates, [&](int index) {
    if (index >= rectangles) {
      const ViewCylinder& pole = cylinders_[static_cast<std::size_t>(index - rectangles)];
      const Eigen::Vector3d middle = pole.base_in_cam + 0.5 * pole.height_m * pole.axis_in_cam;
      return 2.0 * pole.radius_m < width_rad * middle.norm();
    }
    const ViewRectangle& face = rectangles_[static_cast<std::size_t>(index)];
    const double distance = face.center_in_cam.norm();
    const double foreshortening = std::abs(face.normal_in_cam.dot(face.center_in_cam)) / distance;
    const double side_m = 2.0 * std::min(face.half_width_m, face.half_height_m);
    return side_m * foreshortening < width_rad * distance;
  });
}

Seen CameraView::Cast(const Eigen::Vector3d& ray, std::span<const int> candidates) const {
  const int rectangles = static_cast<int>(rectangles_.size());
  Seen seen;
  for (const int index : candidates) {
    const std::optional<ViewHit> hit =
        index < rectangles ? rectangles_[static_cast<std::size_t>(index)].Meet(ray)
                           : cylinders_[static_cast<std::size_t>(index - rectangles)].Meet(ray);
    if (!hit || hit->inverse_range <= seen.hit.inverse_range) continue;
    seen.surface = index;
    seen.hit = *hit;
  }
  if (seen.surface < 0) {
    seen.patch.radiance = background_;
  } else if (seen.surface < rectangles) {
    seen.patch = rectangles_[static_cast<std::size_t>(seen.surface)].PatchAt(seen.hit);
  } else {
    seen.patch =
        cylinders_[static_cast<std::size_t>(seen.surface - rectangles)].PatchAt(seen.hit, ray);
  }
  return seen;
}

Eigen::Vector3d CameraView::NormalAt(const Seen& seen, const Eigen::Vector3d& ray) const {
  const int rectangles = static_cast<int>(rectangles_.size());
  if (seen.surface < 0) return Eigen::Vector3d::Zero();
  if (seen.surface < rectangles) {
    return rectangles_[static_cast<std::size_t>(seen.surface)].normal_in_cam;
  }
  return cylinders_[static_cast<std::size_t>(seen.surface - rectangles)].NormalAt(seen.hit, ray);
}

}  // namespace sextant
