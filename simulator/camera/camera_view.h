// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "base/error.h"
#include "simulator/camera/view_surface.h"

namespace sextant {

/// What a ray of the camera sees first.
struct Seen {
  int surface = -1;  ///< -1: nothing, the background.
  ViewHit hit{};
  ViewPatch patch{};

  /// Whether all that lies between two such points of an image is what they show.
  bool SamePatch(const Seen& other) const {
    return SameLayer(other) && patch.cell == other.patch.cell;
  }
  bool SameLayer(const Seen& other) const {
    return surface == other.surface && patch.layer == other.patch.layer;
  }
};

/// The surfaces of a scene in the frame of one camera at one instant. Boards are thin sheets whose
/// front is printed and whose back is plain, with the front's white; the rest is opaque.
class CameraView {
 public:
  /// Errors: those of BoardPrint::Make; kNonFinite for a pose or side; kInvalidInput for a side
  /// that is not positive, an albedo outside [0, 1], tiles below a millimetre. Messages name the
  /// board, wall, box or cylinder.
  static Expected<CameraView> Make(const Scene& scene, const Rigid3d& world_from_cam, double time_s,
                                   const Lighting& lighting);

  /// Indices of the surfaces that a ray within `half_angle_rad` of the unit vector `axis` may
  /// meet; ascending, and none that it meets is left out.
  void FindCandidates(const Eigen::Vector3d& axis, double half_angle_rad,
                      std::vector<int>& candidates) const;

  /// Whether one of the candidates looks narrower than `width_rad`: a pole, a board from its edge.
  bool HasSliver(std::span<const int> candidates, double width_rad) const;

  /// The nearest of the candidates along a ray (camera frame, any length).
  Seen Cast(const Eigen::Vector3d& ray, std::span<const int> candidates) const;

  /// Unit outward normal in the camera frame; zero for the background.
  Eigen::Vector3d NormalAt(const Seen& seen, const Eigen::Vector3d& ray) const;

 private:
  CameraView() = default;

  std::vector<ViewRectangle> rectangles_;  // Surfaces 0 and on, then the cylinders.
  std::vector<ViewCylinder> cylinders_;
  double background_ = 0.0;
};

}  // namespace sextant
