// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "base/progress.h"
#include "calibrate/scene/scene_score.h"
#include "calibrate/session/session.h"
#include "cli/command.h"
#include "cli/pose_argument.h"
#include "io/results/calibration_result.h"

// The input that `check` and `refine-scene` share: a pose, and pairs of everyday scenes.
namespace sextant::cli {

struct SceneInputOptions {
  std::string pose_path{};
  std::string pose_is{};
  std::vector<std::string> images{};
  std::vector<std::string> clouds{};
  std::string camera_path{};  ///< Empty: the result's.
};

void DeclareSceneInput(SceneInputOptions& options, Arguments& arguments);

/// The pose with its camera, and the pairs of files.
struct SceneInput {
  CalibrationResult given;
  PoseDirection direction = PoseDirection::kCamFromLidar;  ///< In which the pose was read.
  std::string direction_basis;                             ///< What it follows from.
  Session session;
};

/// Errors: those of GivenPoseOfFile, ReadCamera and SessionOfFiles; kMissingData without a camera
/// or a pair.
Expected<SceneInput> ReadSceneInput(const SceneInputOptions& options);

/// The edges of every pair, on all cores. Errors: those of the readers and of MakeScenePair, with
/// the file's name; kInvalidInput for an image that does not have the camera's size.
Expected<std::vector<ScenePair>> ReadScenePairs(const SceneInput& input,
                                                const ProgressCallback& progress);

}  // namespace sextant::cli
