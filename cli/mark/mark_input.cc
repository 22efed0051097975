// SPDX-License-Identifier: Apache-2.0
#include "cli/mark/mark_input.h"

#include <fmt/core.h>

#include <cmath>

#include "base/units.h"
#include "calibrate/observe/photo_file.h"
#include "cli/pose_argument.h"
#include "io/boards/polygon_file.h"
#include "io/cameras/camera_file.h"
#include "io/clouds/cloud_file.h"

namespace sextant::cli {
namespace {

constexpr int kAssumedWidth_px = 1280;
constexpr int kAssumedHeight_px = 720;

Expected<Camera> ChooseCamera(const MarkOptions& options, const cv::Mat& photo) {
  if (options.camera_path.empty()) {
    return photo.empty() ? AssumedCamera(kAssumedWidth_px, kAssumedHeight_px)
                         : AssumedCamera(photo.cols, photo.rows);
  }
  Expected<Camera> camera = ReadCamera(options.camera_path);
  if (!camera) return camera;
  const bool size_known = camera->width_px > 0 && camera->height_px > 0;
  if (!size_known) {
    camera->width_px = photo.empty() ? static_cast<int>(2.0 * camera->cx_px) + 1 : photo.cols;
    camera->height_px = photo.empty() ? static_cast<int>(2.0 * camera->cy_px) + 1 : photo.rows;
  } else if (!photo.empty() &&
             (photo.cols != camera->width_px || photo.rows != camera->height_px)) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("{}: the image has {} x {} pixels, expected the {} x {} of {}",
                                 options.image_path, photo.cols, photo.rows, camera->width_px,
                                 camera->height_px, options.camera_path));
  }
  return camera;
}

Expected<Rigid3d> ChoosePose(const MarkOptions& options) {
  if (options.cam_from_lidar.empty()) {
    const Eigen::AngleAxisd turn(-kRadPerDeg * options.yaw_deg, Eigen::Vector3d::UnitZ());
    return AxesCamFromLidar() * Rigid3d{Eigen::Quaterniond(turn), Eigen::Vector3d::Zero()};
  }
  // The name of the option states the direction of a file that does not.
  const std::string& direction = options.pose_is.empty() ? "cam_from_lidar" : options.pose_is;
  return PoseFromArgument("--cam-from-lidar", options.cam_from_lidar, direction);
}

bool SameProjection(const ScanMarks& a, const ScanMarks& b) {
  const auto text = [](const ScanMarks& marks) {
    return FormatPolygons({.camera = marks.camera, .cam_from_lidar = marks.cam_from_lidar});
  };
  return text(a) == text(b);
}

// Replaces the empty marks by those of `path`, unless the options require another projection.
Expected<void> ContinueWith(const std::filesystem::path& path, const MarkOptions& options,
                            MarkInput& input) {
  SEXTANT_ASSIGN_OR_RETURN(const ScanMarks kept, ReadPolygons(path));
  const bool projection_given =
      !options.camera_path.empty() || !options.cam_from_lidar.empty() || options.yaw_deg != 0.0;
  const bool fits_photo = input.photo.empty() || (kept.camera.width_px == input.photo.cols &&
                                                  kept.camera.height_px == input.photo.rows);
  if ((projection_given && !SameProjection(kept, input.marks)) || !fits_photo) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("{}: was drawn in another projection of a scan; continue with its "
                                 "own --camera, --cam-from-lidar and --image, write to another "
                                 "--out, or remove it",
                                 path.string()));
  }
  input.marks = kept;
  input.note = "continues with " + path.filename().string();
  return {};
}

}  // namespace

std::filesystem::path AutosavePath(const MarkOptions& options) {
  return options.out_path + ".autosave";
}

Expected<MarkInput> LoadMarkInput(const MarkOptions& options) {
  SEXTANT_ASSIGN_OR_RETURN(const PointCloud scan, ReadCloud(options.cloud_path));
  MarkInput input;
  if (!options.image_path.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(const cv::Mat photo, ReadColourImage(options.image_path));
    input.photo = photo;
  }
  SEXTANT_ASSIGN_OR_RETURN(const Camera camera, ChooseCamera(options, input.photo));
  SEXTANT_ASSIGN_OR_RETURN(const Rigid3d pose, ChoosePose(options));
  input.marks = {.camera = camera, .cam_from_lidar = pose};
  std::error_code ignored;
  input.is_saved = !std::filesystem::exists(AutosavePath(options), ignored);
  if (!input.is_saved || std::filesystem::exists(options.out_path, ignored)) {
    const std::filesystem::path from =
        input.is_saved ? std::filesystem::path(options.out_path) : AutosavePath(options);
    SEXTANT_RETURN_IF_ERROR(ContinueWith(from, options, input));
  }
  input.returns = ProjectScan(scan, input.marks.camera, input.marks.cam_from_lidar);
  if (input.returns.empty()) {
    return MakeError(ErrorCode::kDegenerate,
                     fmt::format("{}: none of its {} points is in view; turn the camera with --yaw "
                                 "or give --cam-from-lidar",
                                 options.cloud_path, scan.points.size()));
  }
  return input;
}

}  // namespace sextant::cli
