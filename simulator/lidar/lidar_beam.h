// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "base/error.h"
#include "simulator/lidar/lidar_target.h"

namespace sextant {

/// The illuminated rectangle of a beam: its size at the aperture and its divergence.
struct LidarSpot {
  double aperture_h_m = 0.0;
  double aperture_v_m = 0.0;
  double divergence_h_rad = 0.0;
  double divergence_v_rad = 0.0;

  /// Distance from the centre to a corner [m].
  double RadiusAt(double range_m) const;
  bool IsPoint() const { return RadiusAt(1.0) == 0.0; }
};

/// The echo of a beam, without receiver noise.
struct LidarEcho {
  double range_m = 0.0;
  /// Reflectivity times cosine of incidence, averaged over the spot; parts that miss count as 0.
  double reflectivity = 0.0;
  double power = 0.0;  ///< The same average with each part divided by its squared range [1/m^2].
  double lit_share = 1.0;    ///< Fraction of the spot that contributes to the echo.
  double black_share = 0.0;  ///< Fraction of the contributing part that is on black print.
  PointTruth truth{};
};

/// Casts beams into a scene. Immutable; each thread needs its own Scratch.
class LidarBeams {
 public:
  struct Placed {
    const LidarTarget* target = nullptr;
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  // Rotation of target_from_lidar...
    // ...and translation, at the time of the beam.
    Eigen::Vector3d translation = Eigen::Vector3d::Zero();
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

  /// If the spot is a point, each beam is a single ray. Errors: those of MakeLidarTargets.
  static Expected<LidarBeams> Make(const Scene& scene, const LidarSpot& spot,
                                   double pulse_length_m);

  /// The strongest echo of a beam (LiDAR frame) emitted at `time_s`; none if nothing is hit.
  std::optional<LidarEcho> Cast(const LidarRay& ray, double time_s, Scratch& scratch) const;

 private:
  // A target and a cone from the LiDAR's origin that contains it with a margin of half a spot.
  struct Coned {
    LidarTarget target;
    // Rotation of target_from_lidar at rest.
    Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
    Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
    double cos_half_angle = -1.0;
    double spot_radius_m = 0.0;  // The largest spot radius on the target.
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

/// The strongest echo of the hits of `sub_rays` sub-rays. Sorts the hits by range; successive hits
/// closer than `pulse_length_m` form one echo. Requires at least one hit.
LidarEcho StrongestEcho(std::vector<LidarBeams::SubHit>& hits, int sub_rays, double pulse_length_m);

}  // namespace sextant
