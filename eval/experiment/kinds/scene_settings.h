// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "eval/experiment/definition/parameter_set.h"

namespace sextant {

enum class CameraObservation { kMarked, kTags, kRendered };
enum class LidarObservation { kScanned, kNoise };
enum class StartPose { kAxes, kTruth };

/// Settings of the kinds that use a scene file: sensor poses, placement of the boards, simulation
/// of both sensors, and errors.
struct SceneSettings {
  std::string scene{};          ///< Path relative to the experiment file's folder.
  std::string translation_m{};  ///< "x y z" of cam_from_lidar; empty: the scene's.
  std::string rotation_deg{};   ///< "yaw pitch roll" of R in cam_from_lidar = R axes.
  std::string lidar_model{};    ///< Empty: the scene's.
  std::string camera_model{};   ///< Empty: the scene's.
  double board_scale = 1.0;     ///< Scale of all boards and prints.
  double placement_m = 0.05;   ///< Boards are moved in every trial by up to this along each axis...
  double placement_deg = 5.0;  ///< ...and rotated by up to this about each axis.
  LidarObservation lidar = LidarObservation::kScanned;
  std::string extractor = "lines3d_raw";
  /// Correct edges for sampling and beam width; the original does not.
  bool correct_edges = false;
  double lidar_sigma_m = 0.0068;  ///< Noise per axis with kNoise.
  double lidar_bias_m = 0.0;  ///< LiDAR corners are shifted away from the board's centre by this.
  CameraObservation camera = CameraObservation::kTags;
  double mark_sigma_px = 3.5;  ///< Noise per axis with kMarked.
  double tag_sigma_px = 0.1;   ///< Noise per axis and tag corner with kTags.
  int outliers = 0;            ///< Number of marked corners that are displaced...
  double outlier_px = 20.0;    ///< ...by this distance, in a random direction.
  /// "fx fy cx cy" that the solver assumes; empty: the true ones.
  std::string assumed_intrinsics{};
  double assumed_focal_error = 0.0;    ///< Relative error of both assumed focal lengths.
  bool assumed_distortion = true;      ///< If false, the solver assumes a pinhole camera.
  bool state_noise = false;            ///< Give the pairs their covariances; the original has none.
  StartPose start = StartPose::kAxes;  ///< Start pose of local searches, modified by:
  bool start_centroids = false;        ///< a translation that aligns the centroids,
  double start_deg = 0.0;              ///< a rotation by this about a random axis,
  double start_m = 0.0;                ///< a shift by this in a random direction.
};

template <class Options>
ParameterSet<Options>& AddSceneSettings(ParameterSet<Options>& set) {
  return set
      .Text("scene", &Options::scene, "path", "scene file, relative to the experiment's folder")
      .Text("translation_m", &Options::translation_m, "m",
            "x y z of cam_from_lidar; empty: as in the scene")
      .Text("rotation_deg", &Options::rotation_deg, "deg",
            "yaw pitch roll of R in cam_from_lidar = R axes, where axes is a camera that looks "
            "along the LiDAR's x")
      .Text("lidar_model", &Options::lidar_model, "name", "empty: as in the scene")
      .Text("camera_model", &Options::camera_model, "name", "empty: as in the scene")
      .Real("board_scale", &Options::board_scale, "1", 0.05, 20.0, "scale of boards and prints")
      .Real("placement_m", &Options::placement_m, "m", 0.0, 1.0,
            "boards are moved in every trial by up to this along each axis")
      .Real("placement_deg", &Options::placement_deg, "deg", 0.0, 45.0,
            "boards are rotated in every trial by up to this about each axis")
      .Choice("lidar", &Options::lidar, {"scanned", "noise"},
              "corners extracted from a simulated scan, or true corners with noise")
      .Text("extractor", &Options::extractor, "name",
            "extractor of corners in scans: lines3d_raw (the original's), lines3d, plane_lines, "
            "rectangle")
      .Choice(
          "correct_edges", &Options::correct_edges, {"false", "true"},
          "correct edges in scans for sampling and beam width; the original uses the last returns")
      .Real("lidar_sigma_m", &Options::lidar_sigma_m, "m", 0.0, 1.0,
            "noise per axis with lidar=noise")
      .Real("lidar_bias_m", &Options::lidar_bias_m, "m", -1.0, 1.0,
            "LiDAR corners are shifted away from the board's centre by this")
      .Choice("camera", &Options::camera, {"marked", "tags", "rendered"},
              "board corners marked in the image (2D-3D), tag corners with noise, or a rendered "
              "image with the tag detector")
      .Real("mark_sigma_px", &Options::mark_sigma_px, "px", 0.0, 1e3,
            "noise per axis with camera=marked; the paper states 3 to 4")
      .Real("tag_sigma_px", &Options::tag_sigma_px, "px", 1e-6, 1e3,
            "noise per axis and tag corner with camera=tags")
      .Count("outliers", &Options::outliers, 0, 1000, "number of marked corners that are displaced")
      .Real("outlier_px", &Options::outlier_px, "px", 0.0, 1e4, "displacement of these corners")
      .Text("assumed_intrinsics", &Options::assumed_intrinsics, "px",
            "fx fy cx cy that the solver assumes; empty: the true ones")
      .Real("assumed_focal_error", &Options::assumed_focal_error, "1", -0.9, 10.0,
            "relative error of the assumed focal lengths")
      .Choice("assumed_distortion", &Options::assumed_distortion, {"false", "true"},
              "the solver knows the lens distortion")
      .Choice("state_noise", &Options::state_noise, {"false", "true"},
              "give the pairs their covariances; the original has none")
      .Choice("start", &Options::start, {"axes", "truth"},
              "start of local searches: the axes alone (as configured in the original) or the true "
              "pose")
      .Choice("start_centroids", &Options::start_centroids, {"false", "true"},
              "the start's translation aligns the centroids of both point sets")
      .Real("start_deg", &Options::start_deg, "deg", 0.0, 180.0,
            "rotation of the start about a random axis")
      .Real("start_m", &Options::start_m, "m", 0.0, 100.0,
            "shift of the start in a random direction");
}

}  // namespace sextant
