// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "geometry/board.h"
#include "geometry/camera.h"
#include "geometry/rigid3d.h"

namespace sextant {

/// How a surface looks: to the LiDAR at its wavelength and to a camera. Both in [0, 1].
struct Surface {
  double reflectivity = 0.5;  ///< Diffuse, at 903 nm.
  double albedo = 0.5;        ///< Grey level, linear.
};

/// A pendulum: the board turns about the world's axis `axis_in_world` through its own corner 0.
struct Swing {
  Eigen::Vector3d axis_in_world = Eigen::Vector3d::UnitY();
  double amplitude_rad = 0.0;
  double period_s = 1.0;
  double phase_rad = 0.0;
};

/// Front printed as `board` says (black on white), back plain.
struct SceneBoard {
  Board board{};
  Rigid3d world_from_board{};  ///< At rest.
  std::optional<Swing> swing{};
  Surface white{.reflectivity = 0.8, .albedo = 0.85};
  Surface black{.reflectivity = 0.1, .albedo = 0.05};
};

/// A rectangle, seen from both sides: walls, floors, ceilings. Wall frame: as a board's.
struct SceneWall {
  std::string name{};
  Rigid3d world_from_wall{};
  double width_m = 0.0;   ///< Along x.
  double height_m = 0.0;  ///< Along y.
  Surface surface{};
  double tile_m = 0.0;    ///< Side of square tiles, every other a little darker; 0: plain.
  bool speckled = false;  ///< Tiles of any grey down to a fifth instead: texture for stereo.
};

struct SceneBox {
  std::string name{};
  Rigid3d world_from_box{};  ///< Box frame: origin at its centre, axes along its edges.
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
  Surface surface{};
};

/// Upright: axis along the world's z. A person is one of 0.25 m radius and 1.75 m height.
struct SceneCylinder {
  std::string name{};
  Eigen::Vector3d base_in_world = Eigen::Vector3d::Zero();  ///< Centre of the lower end.
  double radius_m = 0.0;
  double height_m = 0.0;
  Surface surface{};
};

struct SceneLidar {
  std::string model = "vlp16";  ///< A name of simulator/lidar/lidar_model.h.
  Rigid3d world_from_lidar{};
};

struct SceneCamera {
  std::string name = "cam";
  /// A name of simulator/scene/camera_model.h, or empty: `intrinsics` as given.
  std::string model{};
  Camera intrinsics{};  ///< What renders.
  /// What the pipeline is told, where it is told wrongly.
  std::optional<Camera> assumed_intrinsics{};
  Rigid3d world_from_cam{};
};

/// World frame: z up, metres. Immutable description; a board's place at a time follows from it.
struct Scene {
  std::string name{};
  SceneLidar lidar;
  std::vector<SceneCamera> cameras{};
  std::vector<SceneBoard> boards{};
  std::vector<SceneWall> walls{};
  std::vector<SceneBox> boxes{};
  std::vector<SceneCylinder> cylinders{};
  double background_albedo = 0.6;  ///< What a camera sees where it sees nothing else.
};

/// Where a board is `time_s` after the session's start.
Rigid3d BoardPoseAt(const SceneBoard& board, double time_s);

}  // namespace sextant
