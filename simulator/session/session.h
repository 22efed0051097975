// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "io/clouds/pcd_header.h"
#include "io/output/output_folder.h"
#include "simulator/scene/corner_noise.h"
#include "simulator/scene/scene.h"
#include "simulator/scene/truth_yaml.h"

namespace sextant {

/// Level of detail of the simulation of each scan.
enum class SessionLevel {
  kFull,     ///< Points and images, like a real recording.
  kCorners,  ///< Corners in both sensors as found by extractors, with covariances.
  kPairs,    ///< Corners in the LiDAR, and marked by a person in the image.
};

/// Finds "full", "corners" or "pairs". Error: kUnknownName, with the nearest known name.
Expected<SessionLevel> FindSessionLevel(std::string_view name);

struct SessionOptions {
  std::filesystem::path folder{};
  SessionLevel level = SessionLevel::kFull;
  std::uint64_t seed = 1;
  std::optional<std::uint64_t>
      unit{};  ///< Seed of the unit of the LiDAR (ScanOptions); none: seed.
  int scans = 1;
  double interval_s = 1.0;  ///< Time between the starts of successive scans.
  bool ideal = false;       ///< Level kFull without noise, blur, quantisation and beam width.
  PcdEncoding encoding = PcdEncoding::kBinary;
  CornerNoise noise{};  ///< Noise of the levels kCorners and kPairs.
  /// Encodes an image file (PNG); injected to keep the codec's dependencies out of this library.
  std::function<Expected<std::string>(const cv::Mat&)> encode_image{};
  std::function<void()> step{};  ///< Called after each file of a scan; may be empty.
};

struct SessionReport {
  int written = 0;
  int kept = 0;     ///< Complete files kept from an earlier run with the same configuration.
  int removed = 0;  ///< Files of an earlier run of more scans.
  std::vector<ScanTruth> scans{};              ///< Contents of truth.yaml for each scan.
  std::shared_ptr<const OutputFolder> lock{};  ///< Keeps other processes out of the folder.
};

/// The recording in the folder of a session, which the program may write from its files.
inline constexpr const char* kSessionBag = "session.bag";

/// Number of scan files that SimulateSession will write or keep.
long CountSessionFiles(const Scene& scene, const SessionOptions& options);

/// Simulates a session into a folder, which is created:
/// - scene.yaml (`scene_text` unchanged) and simulation.yaml (the options);
/// - boards.yaml, and <camera>_info.yaml with the assumed intrinsics of each camera;
/// - kFull: scan_000.pcd and so on, and <camera>_000.png taken in the middle of the scan;
///   kCorners, kPairs: <level>_<camera>.yaml, a problem file with one view per scan;
/// - truth.yaml: cam_from_lidar, every corner in every frame, all seeds.
///
/// Every file is written completely or not at all. If the folder holds a run of the same scene and
/// options, its files are kept: an interrupted run is continued, and the number of scans may be
/// increased. If it is decreased, the files of later scans are removed, and so is a session.bag of
/// another number of scans. The same scene, seed and options give the same bytes on any number of
/// threads.
///
/// Errors: those of ValidateScene, before anything is written; kInvalidOption; kInvalidInput for a
/// folder with other contents; kIo; those of OutputFolder, OutputFile and RemoveFile.
Expected<SessionReport> SimulateSession(const Scene& scene, std::string_view scene_text,
                                        const SessionOptions& options);

}  // namespace sextant
