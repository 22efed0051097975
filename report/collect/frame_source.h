// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <vector>

#include "base/error.h"
#include "calibrate/observe_session.h"
#include "io/results/calibration_result.h"

namespace sextant {

/// Passes the photo and the scan of each view on, from several threads; a view that it does not
/// visit has none. Error: why there is no frame at all.
using FrameSource =
    std::function<Expected<void>(const std::vector<ResultView>& views, const FrameVisitor& visit)>;

/// The path as it is or, where no such file exists, beside the result's folder.
std::filesystem::path FoundFrom(const std::filesystem::path& folder, const std::string& path);

/// Reads the files that the result names, on all cores. Relative paths start from the working
/// folder or from `folder`. Errors of a view: kMissingData if the result names no files of it, as
/// for a recording; those of the readers.
FrameSource FramesOfFiles(const std::filesystem::path& folder);

}  // namespace sextant
