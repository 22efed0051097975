// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "eval/experiment/definition/parameter_set.h"

namespace sextant {

enum class CameraObservation { kMarked, kTags, kRendered };
enum class LidarObservation { kScanned, kNoise };
enum class StartPose { kAxes, kTruth };

/// What trials of a scene file have in common: the rig, how boards hang, how both sensors see them
/// and what goes wrong. Each is a parameter of the kinds that look at scenes.
struct SceneSettings {
  std::string scene{};          ///< Path, from the experiment file's folder.
  std::string translation_m{};  ///< Of cam_from_lidar: "x y z"; empty: the scene's own.
  std::string rotation_deg{};   ///< "yaw pitch roll" of R in cam_from_lidar = R axes.
  std::string lidar_model{};    ///< Empty: the scene's.
  std::string camera_model{};   ///< Empty: the scene's.
  double board_scale = 1.0;     ///< All boards and prints of other size.
  double placement_m = 0.05;    ///< Boards hang anew for every trial, within so much an axis...
  double placement_deg = 5.0;   ///< ...and turned by so much about each.
  LidarObservation lidar = LidarObservation::kScanned;
  std::string extractor = "lines3d_raw";
  bool correct_edges = false;     ///< For sampling and the beam's width; the original does not.
  double lidar_sigma_m = 0.0068;  ///< Of kNoise, per axis.
  double lidar_bias_m = 0.0;      ///< LiDAR corners lie farther from the board's middle by this.
  CameraObservation camera = CameraObservation::kTags;
  double mark_sigma_px = 3.5;  ///< Of kMarked, per axis.
  double tag_sigma_px = 0.1;   ///< Of kTags, per axis and corner.
  int outliers = 0;            ///< Marked corners that are off by...
  double outlier_px = 20.0;    ///< ...so much, in any direction.
  /// "fx fy cx cy" that the solver is told; empty: the true ones.
  std::string assumed_intrinsics{};
  double assumed_focal_error = 0.0;    ///< Share by which both focal lengths are told too long.
  bool assumed_distortion = true;      ///< Off: the solver takes the camera for a pinhole.
  bool state_noise = false;            ///< Pairs come with their covariance; the original has none.
  StartPose start = StartPose::kAxes;  ///< Where local searches begin, before...
  bool start_centroids = false;        ///< ...the centroids are brought together and before...
  double start_deg = 0.0;              ///< ...a turn by so much about any axis...
  double start_m = 0.0;                ///< ...and a shift by so much in any direction.
};

template <class Options>
ParameterSet<Options>& AddSceneSettings(ParameterSet<Options>& set) {
  return set.Text("scene", &Options::scene, "path", "scene file, from the experiment's folder")
      .Text("translation_m", &Options::translation_m, "m",
            "x y z of cam_from_lidar; empty: the scene's")
      .Text("rotation_deg", &Options::rotation_deg, "deg",
            "yaw pitch roll of R in cam_from_lidar = R axes, axes being a camera that looks along "
            "the LiDAR's x")
      .Text("lidar_model", &Options::lidar_model, "name", "empty: the scene's")
      .Text("camera_model", &Options::camera_model, "name", "empty: the scene's")
      .Real("board_scale", &Options::board_scale, "1", 0.05, 20.0,
            "boards and prints are larger by this")
      .Real("placement_m", &Options::placement_m, "m", 0.0, 1.0,
            "boards hang anew in every trial, within so much along each axis")
      .Real("placement_deg", &Options::placement_deg, "deg", 0.0, 45.0,
            "and turned by so much about each")
      .Choice("lidar", &Options::lidar, {"scanned", "noise"},
              "corners extracted from a simulated scan, or true ones with noise")
      .Text("extractor", &Options::extractor, "name",
            "of corners in scans: lines3d_raw (the original's), lines3d, plane_lines, rectangle")
      .Choice("correct_edges", &Options::correct_edges, {"false", "true"},
              "edges in scans corrected for sampling and beam; the original takes the last returns")
      .Real("lidar_sigma_m", &Options::lidar_sigma_m, "m", 0.0, 1.0, "of lidar=noise, per axis")
      .Real("lidar_bias_m", &Options::lidar_bias_m, "m", -1.0, 1.0,
            "LiDAR corners lie farther from the board's middle by this")
      .Choice(
          "camera", &Options::camera, {"marked", "tags", "rendered"},
          "board corners clicked in the image (2D-3D), corners of tags with noise, or a rendered "
          "image through the detector")
      .Real("mark_sigma_px", &Options::mark_sigma_px, "px", 0.0, 1e3,
            "of camera=marked, per axis; the paper says 3 to 4")
      .Real("tag_sigma_px", &Options::tag_sigma_px, "px", 1e-6, 1e3,
            "of camera=tags, per axis and corner")
      .Count("outliers", &Options::outliers, 0, 1000, "marked corners that are far off")
      .Real("outlier_px", &Options::outlier_px, "px", 0.0, 1e4, "and by how much")
      .Text("assumed_intrinsics", &Options::assumed_intrinsics, "px",
            "fx fy cx cy that the solver is told; empty: the true ones")
      .Real("assumed_focal_error", &Options::assumed_focal_error, "1", -0.9, 10.0,
            "share by which focal lengths are told too long")
      .Choice("assumed_distortion", &Options::assumed_distortion, {"false", "true"},
              "whether the solver knows the lens's distortion")
      .Choice("state_noise", &Options::state_noise, {"false", "true"},
              "whether pairs come with their covariance; the original has none")
      .Choice("start", &Options::start, {"axes", "truth"},
              "where local searches begin: the axes alone (as configured in the original) or the "
              "true pose")
      .Choice("start_centroids", &Options::start_centroids, {"false", "true"},
              "the translation brings both centroids together, whatever the rotation")
      .Real("start_deg", &Options::start_deg, "deg", 0.0, 180.0, "then turned about a random axis")
      .Real("start_m", &Options::start_m, "m", 0.0, 100.0, "and shifted in a random direction");
}

}  // namespace sextant
