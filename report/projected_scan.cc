// SPDX-License-Identifier: Apache-2.0
#include "report/projected_scan.h"

#include <tbb/parallel_sort.h>

#include <optional>
#include <set>

namespace sextant {

std::vector<ProjectedReturn> ProjectScan(const PointCloud& scan, const Camera& camera,
                                         const Rigid3d& cam_from_lidar) {
  const Eigen::Vector2d size(camera.width_px, camera.height_px);
  std::vector<ProjectedReturn> returns;
  for (std::size_t i = 0; i < scan.points.size(); ++i) {
    const Eigen::Vector3d& point = scan.points[i];
    if (!point.allFinite() || point.norm() < 0.01) continue;
    const Eigen::Vector3d in_cam = cam_from_lidar * point;
    const std::optional<Eigen::Vector2d> pixel = Project(camera, in_cam);
    if (!pixel || (pixel->array() < -size.array()).any() ||
        (pixel->array() > 2.0 * size.array()).any()) {
      continue;
    }
    const int ring = scan.ring.empty() ? -1 : static_cast<int>(scan.ring[i]);
    returns.push_back({.pixel = *pixel,
                       .range_m = point.norm(),
                       .distance_m = in_cam.norm(),
                       .ring = ring,
                       .index = static_cast<int>(i)});
  }
  // By range, then index; not a stable sort, which would need memory for as many again.
  tbb::parallel_sort(returns, [](const ProjectedReturn& a, const ProjectedReturn& b) {
    return a.range_m > b.range_m || (a.range_m == b.range_m && a.index < b.index);
  });
  return returns;
}

ReturnCount CountReturns(const std::vector<ProjectedReturn>& returns,
                         const Quadrilateral& quadrilateral) {
  ReturnCount count;
  std::set<int> rings;
  for (const ProjectedReturn& r : returns) {
    if (!Contains(quadrilateral, r.pixel)) continue;
    ++count.returns;
    if (r.ring >= 0) rings.insert(r.ring);
  }
  count.rings = static_cast<int>(rings.size());
  return count;
}

}  // namespace sextant
