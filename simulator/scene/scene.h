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

/// Optical properties of a surface for the LiDAR and for a camera, both in [0, 1].
struct Surface {
  double reflectivity = 0.5;  ///< Diffuse reflectivity at 903 nm.
  double albedo = 0.5;        ///< Diffuse reflectivity for the camera; linear grey level.
};

/// Motion of a pendulum: the board rotates about `axis_in_world` (world frame) through its corner
/// 0.
struct Swing {
  Eigen::Vector3d axis_in_world = Eigen::Vector3d::UnitY();
  double amplitude_rad = 0.0;
  double period_s = 1.0;
  double phase_rad = 0.0;
};

/// A board in the scene. The front has the print of `board` (black on white), the back is plain.
struct SceneBoard {
  Board board{};
  Rigid3d world_from_board{};  ///< Pose at rest.
  std::optional<Swing> swing{};
  Surface white{.reflectivity = 0.8, .albedo = 0.85};
  Surface black{.reflectivity = 0.1, .albedo = 0.05};
};

/// A rectangle visible from both sides: wall, floor or ceiling. The wall frame is defined like a
/// board's.
struct SceneWall {
  std::string name{};
  Rigid3d world_from_wall{};
  double width_m = 0.0;   ///< Along x.
  double height_m = 0.0;  ///< Along y.
  Surface surface{};
  double tile_m = 0.0;    ///< Side of square tiles, every second one slightly darker; 0: plain.
  bool speckled = false;  ///< Tiles have random grey levels down to a fifth: texture for stereo.
};

struct SceneBox {
  std::string name{};
  Rigid3d world_from_box{};  ///< Box frame: origin at the centre, axes along the edges.
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
  Surface surface{};
};

/// An upright cylinder with its axis along the world's z. A person is modelled with a radius of
/// 0.25 m and a height of 1.75 m.
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
  /// A name of simulator/scene/camera_model.h; empty: use `intrinsics`.
  std::string model{};
  Camera intrinsics{};  ///< Intrinsics of the rendered images.
  /// Wrong intrinsics that the pipeline assumes instead, if given.
  std::optional<Camera> assumed_intrinsics{};
  Rigid3d world_from_cam{};
};

/// Description of a scene. World frame: z up, metres. The pose of a moving board follows from the
/// time.
struct Scene {
  std::string name{};
  SceneLidar lidar;
  std::vector<SceneCamera> cameras{};
  std::vector<SceneBoard> boards{};
  std::vector<SceneWall> walls{};
  std::vector<SceneBox> boxes{};
  std::vector<SceneCylinder> cylinders{};
  double background_albedo = 0.6;  ///< Albedo where the camera sees no object.
};

/// world_from_board at `time_s` after the session's start.
Rigid3d BoardPoseAt(const SceneBoard& board, double time_s);

/// The boards of a scene, in the order of the scene.
std::vector<Board> BoardsIn(const Scene& scene);

/// Corner 0 to 3 of a board at rest, in the world frame [m].
Eigen::Vector3d TrueCorner(const SceneBoard& board, int corner);

}  // namespace sextant
