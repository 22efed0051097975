// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "base/random.h"
#include "calibrate/scene/scene_score.h"

// Real pairs of known calibration, for the measured figures of docs/check.md. Every function ends
// the program with a message where a file cannot be read.
namespace sextant {

struct RawPair {
  cv::Mat grey;  ///< 8 bits.
  PointCloud scan;
};

struct RawRecording {
  std::string name;
  Camera camera;
  Rigid3d cam_from_lidar;
  std::vector<RawPair> pairs;
};

/// `images` and `clouds`: patterns, paired as by `sextant check`.
RawRecording ReadRecording(const std::string& name, const std::string& pose,
                           const std::string& camera, const std::string& images,
                           const std::string& clouds);

std::vector<ScenePair> ScenePairsOf(const RawRecording& recording);

/// So many of the pairs, at random.
std::vector<ScenePair> SomeOf(const std::vector<ScenePair>& pairs, std::size_t count,
                              Random& random);

/// The pose off by exactly so much about and along random axes.
struct PoseOffset {
  double rotation_deg = 0.0;
  double translation_m = 0.0;
};
Rigid3d OffBy(const Rigid3d& pose, const PoseOffset& offset, Random& random);

}  // namespace sextant
