// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "simulator/scene/scene_truth.h"

namespace sextant {

/// The truth of one scan of a session.
struct ScanTruth {
  int index = 0;
  double start_time_s = 0.0;  ///< Start of the scan, after the session's start.
  double image_time_s = 0.0;  ///< Time of the images and of `boards`.
  std::string scan_file{};    ///< Empty, like image_files, if points were not simulated.
  std::vector<std::string> image_files{};  ///< One per camera.
  /// One per camera; seeds of the corner noise if there are no images.
  std::vector<std::uint64_t> image_seeds{};
  std::vector<BoardTruth> boards{};
};

/// truth.yaml of a session (docs/formats.md).
std::string FormatTruth(const Scene& scene, std::uint64_t seed,
                        const std::vector<ScanTruth>& scans);

}  // namespace sextant
