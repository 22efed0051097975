// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/error.h"
#include "simulator/camera/view_surface.h"

namespace sextant {

/// The first surface that a ray of the camera hits.
struct Seen {
  int surface = -1;  ///< -1: nothing, the background.
  ViewHit hit{};
  ViewPatch patch{};

  /// Whether everything between the two image points is the same patch.
  bool SamePatch(const Seen& other) const {
    return SameLayer(other) && patch.cell == other.patch.cell;
  }
  bool SameLayer(const Seen& other) const {
    return surface == other.surface && patch.layer == other.patch.layer;
  }
};

/// The surfaces of a scene in the frame of one camera at one time. Boards are thin sheets with a
/// printed front and a plain back of the front's white; all objects are opaque.
class CameraView {
 public:
  /// Errors: those of BoardPrint::Make; kNonFinite for a pose or side; kInvalidInput for a side
  /// that is not positive, an albedo outside of [0, 1], tiles below a millimetre or more than
  /// 30,000 along a side. Messages name the board, wall, box or cylinder.
  static Expected<CameraView> Make(const Scene& scene, const Rigid3d& world_from_cam, double time_s,
                                   const Lighting& lighting);

  /// Indices, ascending, of all surfaces that a ray within `half_angle_rad` of the unit vector
  /// `axis` may hit (possibly more).
  void FindCandidates(const Eigen::Vector3d& axis, double half_angle_rad,
                      std::vector<int>& candidates) const;

  /// Whether one of the candidates looks narrower than `width_rad`, such as a pole or a board seen
  /// edge-on.
  bool HasSliver(std::span<const int> candidates, double width_rad) const;

  /// The nearest hit of a ray (camera frame, any length) among the candidates.
  Seen Cast(const Eigen::Vector3d& ray, std::span<const int> candidates) const;

  /// The surface if it is a rectangle, else null.
  const ViewRectangle* RectangleOf(int surface) const {
    const auto index = static_cast<std::size_t>(surface);
    return index < rectangles_.size() ? &rectangles_[index] : nullptr;
  }
  double background() const { return background_; }  ///< Radiance where nothing is hit.

  /// Unit outward normal in the camera frame; zero for the background.
  Eigen::Vector3d NormalAt(const Seen& seen, const Eigen::Vector3d& ray) const;

 private:
  CameraView() = default;

  // Surface indices start with these, followed by the cylinders.
  std::vector<ViewRectangle> rectangles_;
  std::vector<ViewCylinder> cylinders_;
  double background_ = 0.0;
};

}  // namespace sextant
