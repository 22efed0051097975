// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "geometry/scan_marks.h"
#include "report/projected_scan.h"

namespace sextant::cli {

struct MarkOptions {
  std::string cloud_path{};
  std::string image_path{};   ///< Empty: none.
  std::string camera_path{};  ///< Empty: an assumed camera.
  std::string pose_is{};
  std::vector<std::string> cam_from_lidar{};  ///< A file, or x y z qw qx qy qz; empty: the axes.
  double yaw_deg = 0.0;                       ///< Turns the assumed camera to the left.
  std::vector<int> ids{};                     ///< Ids of the boards, from left to right.
  std::string out_path = "polygons.yaml";
  std::string render_path{};  ///< A picture of the window to write instead of opening it.
  int width_px = 1280;        ///< Width of the window.
  int height_px = 800;        ///< Height of the window.
};

/// What `sextant mark` starts with.
struct MarkInput {
  std::vector<ProjectedReturn> returns{};
  cv::Mat photo{};
  ScanMarks marks{};
  std::string note{};    ///< The file that the marks come from, if any.
  bool is_saved = true;  ///< Whether --out holds these marks.
};

/// The file that keeps unsaved marks.
std::filesystem::path AutosavePath(const MarkOptions& options);

/// Reads the scan, the photo, the camera and the pose. By default assumes a camera with a view of
/// 90 degrees along the LiDAR's axes. Continues with the marks of an autosave file or of --out, if
/// there are any. Errors: those of the files; kInvalidInput for a photo whose size is not the
/// camera's, and for existing marks in another projection; kDegenerate if no return is in view.
Expected<MarkInput> LoadMarkInput(const MarkOptions& options);

}  // namespace sextant::cli
