// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "simulator/scene/scene_truth.h"

namespace sextant {

/// What is true of one scan of a session.
struct ScanTruth {
  int index = 0;
  double start_time_s = 0.0;  ///< Of the scan, after the session's start.
  double image_time_s = 0.0;  ///< Of the images, and of `boards`.
  std::string scan_file{};    ///< Empty where points were not simulated; so are image_files.
  std::vector<std::string> image_files{};    ///< One a camera.
  std::vector<std::uint64_t> image_seeds{};  ///< One a camera; of the corners' noise otherwise.
  std::vector<BoardTruth> boards{};
};

/// truth.yaml of a session (docs/formats.md).
std::string FormatTruth(const Scene& scene, std::uint64_t seed,
                        const std::vector<ScanTruth>& scans);

}  // namespace sextant
