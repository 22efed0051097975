// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/pnp_view.h"

#include <fmt/core.h>

#include <algorithm>
#include <numeric>

#include "geometry/lens_domain.h"
#include "geometry/so3.h"

namespace sextant {
namespace {

// On the image plane, rays more than 84 deg off the view's axis would outweigh all others.
constexpr double kMinRayZ = 0.1;

}  // namespace

Expected<Eigen::Quaterniond> ProjectRays(std::span<const Eigen::Vector3d> rays,
                                         std::span<Eigen::Vector2d> image_points) {
  Eigen::Quaterniond cam_from_view = Eigen::Quaterniond::Identity();
  const auto is_wide = [&](const Eigen::Vector3d& ray) {
    return !((cam_from_view.conjugate() * ray).z() > kMinRayZ);
  };
  if (std::any_of(rays.begin(), rays.end(), is_wide)) {
    const Eigen::Vector3d sum =
        std::accumulate(rays.begin(), rays.end(), Eigen::Vector3d(Eigen::Vector3d::Zero()));
    cam_from_view = RotationBetween(Eigen::Vector3d::UnitZ(), sum);
  }
  if (std::any_of(rays.begin(), rays.end(), is_wide)) {
    return MakeError(ErrorCode::kInvalidInput,
                     "the pixels span more than 168 deg of view, which this solver cannot put on "
                     "one image plane; use p3p or ransac(p3p)");
  }
  for (std::size_t i = 0; i < rays.size(); ++i) {
    image_points[i] = (cam_from_view.conjugate() * rays[i]).hnormalized();
  }
  return cam_from_view;
}

Expected<PnpView> MakeView(const Camera& camera, std::span<const Pair2d3d> pairs) {
  PnpView view;
  view.image_points.resize(pairs.size());
  view.points.resize(pairs.size());
  std::vector<Eigen::Vector3d> rays(pairs.size());
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const std::optional<Eigen::Vector3d> ray = Unproject(camera, pairs[i].pixel);
    if (!ray) {
      return MakeError(ErrorCode::kInvalidInput,
                       fmt::format("2D-3D pair {} of {}: no ray of the camera model meets pixel "
                                   "({:g}, {:g}): {}; check the pixel and the distortion",
                                   i + 1, pairs.size(), pairs[i].pixel.x(), pairs[i].pixel.y(),
                                   DomainText(camera)));
    }
    rays[i] = *ray;
    view.points[i] = pairs[i].point_in_lidar;
  }
  SEXTANT_ASSIGN_OR_RETURN(const Eigen::Quaterniond cam_from_view,
                           ProjectRays(rays, view.image_points));
  view.cam_from_view = cam_from_view;
  return view;
}

}  // namespace sextant
