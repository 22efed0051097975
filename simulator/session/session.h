// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "io/clouds/pcd_header.h"
#include "simulator/scene/corner_noise.h"
#include "simulator/scene/scene.h"
#include "simulator/scene/truth_yaml.h"

namespace sextant {

/// What is simulated of each scan, from the whole way to the shortest.
enum class SessionLevel {
  kFull,     ///< Points and images, as a user would have them.
  kCorners,  ///< Corners in both sensors, as extractors find them, with their covariance.
  kPairs,    ///< Corners in the LiDAR and marked by a person in the image.
};

/// "full", "corners" or "pairs". Error: kUnknownName, with the nearest known.
Expected<SessionLevel> FindSessionLevel(std::string_view name);

struct SessionOptions {
  std::filesystem::path folder{};
  SessionLevel level = SessionLevel::kFull;
  std::uint64_t seed = 1;
  int scans = 1;
  double interval_s = 1.0;  ///< From the start of one scan to that of the next.
  bool ideal = false;       ///< Full level without noise, blur, quantisation and spot of the beam.
  PcdEncoding encoding = PcdEncoding::kBinary;
  CornerNoise noise{};  ///< Of the levels kCorners and kPairs.
  /// The bytes of an image file (PNG); kept out of this library with its dependencies.
  std::function<Expected<std::string>(const cv::Mat&)> encode_image{};
  std::function<void()> step{};  ///< Called after each file of a scan; may be empty.
};

struct SessionReport {
  int written = 0;
  int kept = 0;  ///< Complete files of an earlier run with the same configuration.
  std::vector<ScanTruth> scans{};  ///< Their times and files; all of truth.yaml.
};

/// Files of scans that SimulateSession will write or keep.
long CountSessionFiles(const Scene& scene, const SessionOptions& options);

/// Simulates a session into a folder, which is made:
/// - scene.yaml (`scene_text` as it stands) and simulation.yaml (the options);
/// - boards.yaml, and <camera>_info.yaml with what the pipeline is told of each camera;
/// - kFull: scan_000.pcd, and <camera>_000.png taken in the middle of the scan;
///   kCorners, kPairs: <level>_<camera>.yaml, a problem file with one view a scan;
/// - truth.yaml: cam_from_lidar, every corner in every frame, every seed.
/// Every file is written whole or not at all. Where the folder holds a run of the same scene and
/// options, its files are kept: a run that was stopped goes on, and more scans may be asked for.
/// The same scene, seed and options give the same bytes, whatever the number of threads.
///
/// Errors: those of ValidateScene, before anything is written; kInvalidOption; kInvalidInput for a
/// folder that holds something else; kIo.
Expected<SessionReport> SimulateSession(const Scene& scene, std::string_view scene_text,
                                        const SessionOptions& options);

}  // namespace sextant
