// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "calibrate/calibrate.h"
#include "io/results/calibration_result.h"
#include "report/collect/frame_source.h"
#include "report/page/page.h"

namespace sextant {

/// What a report is made of.
struct PageSource {
  CalibrationResult result{};
  /// What a result file does not contain: noise, nuisance parameters, solvers, input files. Null:
  /// the page says that it is absent. One without a pose has `result` by ResultWithoutPose.
  const Calibration* calibration = nullptr;
  FrameSource frames{};            ///< Photos and scans of the views.
  std::filesystem::path folder{};  ///< Where relative paths of the result may start, too.
  std::string written{};           ///< The date of the report.
  /// Run a few other solvers where the calibration has one alone, which takes about a second.
  bool compares_solvers = true;
};

/// Collects the content of the report: reads the photos and scans of the views, on all cores, and
/// keeps as much of each as gives a page below kMaxPageBytes with so many views. A view whose files
/// cannot be read says why. With a calibration of a single solver, a few others are run on its
/// data.
///
/// Memory: the page, and a photo and a scan for each core.
ReportPage CollectPage(const PageSource& source);

}  // namespace sextant
