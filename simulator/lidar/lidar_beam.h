// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "base/error.h"
#include "simulator/lidar/lidar_target.h"

namespace sextant {

/// The lit rectangle of a beam, as it leaves and by how much it grows.
struct LidarSpot {
  double aperture_h_m = 0.0;
  double aperture_v_m = 0.0;
  double divergence_h_rad = 0.0;
  double divergence_v_rad = 0.0;

  /// From the centre to a corner.
  double RadiusAt(double range_m) const;
  bool IsPoint() const { return RadiusAt(1.0) == 0.0; }
};

/// What comes back of a beam, before the receiver adds noise.
struct LidarEcho {
  double range_m = 0.0;
  /// Reflectivity by cosine of incidence, averaged over the spot; 0 where the spot misses.
  double reflectivity = 0.0;
  double power = 0.0;        ///< The same with each part divided by its range squared [1/m^2].
  double lit_share = 1.0;    ///< Of the spot, what the echo comes from.
  double black_share = 0.0;  ///< Of what is lit on the object, the share that is black print.
  PointTruth truth{};
};

/// Casts beams into a scene. Immutable; a Scratch belongs to one thread.
class LidarBeams {
 public:
  struct Placed {
    const LidarTarget* target = nullptr;
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  // Of target_from_lidar...
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();   // ...at the time of the beam.
    double may_enter_m = 0.0;
  };
  struct SubHit {
    double range_m = 0.0;
    double reflectivity = 0.0;
    const LidarTarget* target = nullptr;
    int face = 0;
    bool black = false;
  };
  struct Scratch {
    std::vector<Placed> placed;
    std::vector<SubHit> hits;
  };

  /// A spot that is a point casts each beam as one ray. Errors: those of MakeLidarTargets.
  static Expected<LidarBeams> Make(const Scene& scene, const LidarSpot& spot,
                                   double pulse_length_m);

  /// The strongest echo of a beam (LiDAR frame) that leaves at `time_s`; none where nothing is hit.
  std::optional<LidarEcho> Cast(const LidarRay& ray, double time_s, Scratch& scratch) const;

 private:
  // A target and the cone about the LiDAR's origin that holds it and half a spot around it.
  struct Coned {
    LidarTarget target;
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  // Of target_from_lidar at rest.
    Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
    double cos_half_angle = -1.0;
    double spot_radius_m = 0.0;  // The largest that can matter on it.
  };
  struct Nearest {
    const Placed* placed = nullptr;
    LidarEntry entry{};
  };

  LidarBeams() = default;
  Nearest Place(const LidarRay& ray, double time_s, std::vector<Placed>& placed) const;
  bool WholeSpotOn(const Nearest& nearest, const LidarRay& ray,
                   const std::vector<Placed>& placed) const;
  LidarEcho WholeEcho(const Nearest& nearest, const LidarRay& ray) const;
  bool CastSubRays(const LidarRay& ray, Scratch& scratch) const;

  Rigid3d world_from_lidar_;
  std::vector<Coned> targets_;
  LidarSpot spot_;
  double pulse_length_m_ = 0.0;
};

/// The strongest of the echoes in `hits`, of which `sub_rays` were cast. Sorts them by range;
/// neighbours nearer than `pulse_length_m` make one echo. Requires at least one hit.
LidarEcho StrongestEcho(std::vector<LidarBeams::SubHit>& hits, int sub_rays, double pulse_length_m);

}  // namespace sextant
