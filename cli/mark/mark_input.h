// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "cli/commands.h"
#include "geometry/scan_marks.h"
#include "report/projected_scan.h"

namespace sextant::cli {

/// What `sextant mark` begins with.
struct MarkInput {
  std::vector<ProjectedReturn> returns{};
  cv::Mat photo{};
  ScanMarks marks{};
  std::string note{};    ///< Where the marks come from, if from a file.
  bool is_saved = true;  ///< Whether --out holds these marks.
};

/// Where marks that are not saved are kept.
std::filesystem::path AutosavePath(const MarkOptions& options);

/// Reads the scan, the photo, the camera and the pose, or assumes them: a camera 90 degrees wide
/// over the LiDAR's axes. Goes on with the marks of an autosave file or of --out, where they are.
/// Errors: those of the files; kInvalidInput for a photo of another size than the camera's, and
/// for a projection other than that of the marks to go on with; kDegenerate where no return is in
/// view.
Expected<MarkInput> LoadMarkInput(const MarkOptions& options);

}  // namespace sextant::cli
