// SPDX-License-Identifier: Apache-2.0
#include "cli/scene_input.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <optional>

#include "calibrate/observe/photo_file.h"
#include "features/camera/grey_image.h"
#include "io/cameras/camera_file.h"
#include "io/clouds/cloud_file.h"

namespace sextant::cli {
namespace {

Expected<ScenePair> ReadScenePair(const FilePair& files, const CalibrationResult& given) {
  SEXTANT_ASSIGN_OR_RETURN(const cv::Mat image, ReadImage(files.image));
  SEXTANT_ASSIGN_OR_RETURN(const cv::Mat grey, ToGrey(image));
  const Camera& camera = *given.camera;
  const bool has_size = camera.width_px > 0 && camera.height_px > 0;
  if (has_size && (camera.width_px != grey.cols || camera.height_px != grey.rows)) {
    return MakeError(
        ErrorCode::kInvalidInput,
        fmt::format("{} is {} x {} pixels, the camera {} x {}: expected the same",
                    files.image.string(), grey.cols, grey.rows, camera.width_px, camera.height_px));
  }
  SEXTANT_ASSIGN_OR_RETURN(const PointCloud cloud, ReadCloud(files.cloud));
  Expected<ScenePair> pair = MakeScenePair(grey, cloud, camera, given.cam_from_lidar);
  if (pair) return pair;
  return MakeError(pair.error().code,
                   fmt::format("{}: {}", files.cloud.string(), pair.error().message));
}

}  // namespace

void DeclareSceneInput(SceneInputOptions& options, Arguments& arguments) {
  arguments.Add("POSE", options.pose_path, kPoseHelp, {.required = true});
  DeclarePoseIs(options.pose_is, arguments);
  arguments.Add("--image", options.images,
                "Photos of everyday scenes: one, several, or a quoted pattern such as\n"
                "'photos/*.png'",
                {.required = true});
  arguments.Add("--cloud", options.clouds,
                "Their scans; paired by the distinguishing part of the file name",
                {.required = true});
  arguments.Add("--camera", options.camera_path, "Intrinsics; default: those of the result");
}

Expected<SceneInput> ReadSceneInput(const SceneInputOptions& options) {
  SceneInput input;
  SEXTANT_ASSIGN_OR_RETURN(GivenPose pose, GivenPoseOfFile(options.pose_path, options.pose_is));
  input.given = std::move(pose.result);
  input.direction = pose.direction;
  input.direction_basis = std::move(pose.basis);
  if (!options.camera_path.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(input.given.camera, ReadCamera(options.camera_path));
  }
  if (!input.given.camera) {
    return MakeError(ErrorCode::kMissingData,
                     fmt::format("{} has no camera; expected --camera", options.pose_path));
  }
  SEXTANT_ASSIGN_OR_RETURN(input.session, SessionOfFiles(options.images, options.clouds));
  if (input.session.files.pairs.empty()) {
    return MakeError(ErrorCode::kMissingData,
                     "no image has a scan of the same name: expected names such as cam_7.png and "
                     "scan_007.pcd");
  }
  return input;
}

Expected<std::vector<ScenePair>> ReadScenePairs(const SceneInput& input,
                                                const ProgressCallback& progress) {
  const std::vector<FilePair>& files = input.session.files.pairs;
  std::vector<std::optional<Expected<ScenePair>>> read(files.size());
  ProgressCounter counter(progress, "scenes", files.size());
  tbb::parallel_for(std::size_t{0}, files.size(), [&](std::size_t i) {
    read[i] = ReadScenePair(files[i], input.given);
    counter.Step();
  });
  counter.Finish();
  std::vector<ScenePair> pairs;
  for (std::optional<Expected<ScenePair>>& pair : read) {
    if (!*pair) return tl::unexpected<Error>(pair->error());
    pairs.push_back(std::move(**pair));
  }
  return pairs;
}

}  // namespace sextant::cli
