// SPDX-License-Identifier: Apache-2.0
#include "simulator/camera/view_surface.h"

#include <cmath>
#include <cstdint>

namespace sextant {
namespace {

// A pseudo-random number in [0, 1) for each cell: the finaliser of splitmix64 (Steele et al. 2014).
double Speckle(int cell) {
  auto bits = static_cast<std::uint64_t>(cell) + 0x9e3779b97f4a7c15U;
  bits = (bits ^ (bits >> 30U)) * 0xbf58476d1ce4e5b9U;
  bits = (bits ^ (bits >> 27U)) * 0x94d049bb133111ebU;
  return static_cast<double>((bits ^ (bits >> 31U)) >> 11U) * 0x1p-53;
}

}  // namespace

std::optional<ViewRectangle> MakeViewRectangle(const Rigid3d& cam_from_rectangle, double width_m,
                                               double height_m) {
  constexpr double kInPlane_m = 1e-12;
  const Eigen::Matrix3d axes = cam_from_rectangle.rotation.toRotationMatrix();
  const Eigen::Vector3d& origin = cam_from_rectangle.translation;
  const double distance = axes.col(2).dot(origin);
  if (std::abs(distance) < kInPlane_m) return std::nullopt;
  ViewRectangle face{.half_width_m = 0.5 * width_m, .half_height_m = 0.5 * height_m};
  const Eigen::RowVector3d inverse = axes.col(2).transpose() / distance;
  face.plane_from_ray.row(0) = axes.col(0).transpose() - axes.col(0).dot(origin) * inverse;
  face.plane_from_ray.row(1) = axes.col(1).transpose() - axes.col(1).dot(origin) * inverse;
  face.plane_from_ray.row(2) = inverse;
  face.center_in_cam = origin;
  face.normal_in_cam = (distance > 0.0 ? -1.0 : 1.0) * axes.col(2);
  return face;
}

std::optional<ViewHit> ViewRectangle::HitAt(const Eigen::Vector3d& scaled) const {
  const double s = scaled.z();
  if (!(s > 0.0) || std::abs(scaled.x()) > half_width_m * s ||
      std::abs(scaled.y()) > half_height_m * s) {
    return std::nullopt;
  }
  const ViewHit hit{s, scaled.x() / s, scaled.y() / s};
  if (hole && std::abs(hit.u_m - hole->center_in_board_m.x()) < 0.5 * hole->width_m &&
      std::abs(hit.v_m - hole->center_in_board_m.y()) < 0.5 * hole->height_m) {
    return std::nullopt;
  }
  const Eigen::Vector2d at(hit.u_m, hit.v_m);
  for (const RoundHole& round : round_holes) {
    if ((at - round.center_in_board_m).squaredNorm() < round.radius_m * round.radius_m) {
      return std::nullopt;
    }
  }
  return hit;
}

ViewPatch ViewRectangle::PatchAt(const ViewHit& hit) const {
  if (print) {
    const PrintCell cell = print->At({hit.u_m, hit.v_m});
    return {cell.layer, cell.cell, cell.is_white ? white : black};
  }
  if (!(tile_m > 0.0)) return {.radiance = white};
  const int column = static_cast<int>((hit.u_m + half_width_m) / tile_m);
  const int row = static_cast<int>((hit.v_m + half_height_m) / tile_m);
  const int cell = row * tile_columns + column;
  if (speckled) return {0, cell, black + (white - black) * Speckle(cell)};
  return {0, cell, (row + column) % 2 == 0 ? white : black};
}

std::optional<ViewHit> ViewCylinder::Meet(const Eigen::Vector3d& ray) const {
  const double along = axis_in_cam.dot(ray);
  const double base = axis_in_cam.dot(base_in_cam);
  const Eigen::Vector3d across = ray - along * axis_in_cam;
  const Eigen::Vector3d center = base_in_cam - base * axis_in_cam;
  const double a = across.squaredNorm();
  const double b = across.dot(center);
  const double c = center.squaredNorm() - radius_m * radius_m;
  const double root = b * b - a * c;
  if (root < 0.0) return std::nullopt;
  // The near root of a t^2 - 2 b t + c; the form t = c / (b + sqrt) avoids cancellation.
  if (c > 0.0 && b > 0.0) {
    const double inverse_range = (b + std::sqrt(root)) / c;
    const double height = along / inverse_range - base;
    if (height >= 0.0 && height <= height_m) return ViewHit{inverse_range, height, 0.0};
  }
  const double end_height = along < 0.0 ? height_m : 0.0;
  const double inverse_range = along / (base + end_height);
  if (!(std::isfinite(inverse_range) && inverse_range > 0.0)) return std::nullopt;
  if ((across / inverse_range - center).squaredNorm() > radius_m * radius_m) return std::nullopt;
  return ViewHit{inverse_range, end_height, 1.0};
}

Eigen::Vector3d ViewCylinder::NormalAt(const ViewHit& hit, const Eigen::Vector3d& ray) const {
  if (hit.v_m == 1.0) return hit.u_m > 0.0 ? axis_in_cam : Eigen::Vector3d(-axis_in_cam);
  const Eigen::Vector3d on_axis = base_in_cam + hit.u_m * axis_in_cam;
  return (ray / hit.inverse_range - on_axis).normalized();
}

ViewPatch ViewCylinder::PatchAt(const ViewHit& hit, const Eigen::Vector3d& ray) const {
  const double light = Irradiance(lighting, world_from_cam * NormalAt(hit, ray));
  return {static_cast<int>(hit.v_m), 0, albedo * light};
}

}  // namespace sextant
