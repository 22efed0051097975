// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "base/error.h"
#include "calibrate/calibrate.h"
#include "report/collect/collect_page.h"

namespace sextant::cli {

/// What WroteLine says about a report.
inline constexpr const char* kReportWords = "the report, one file that opens in any browser";

/// CollectPage, dated today, with the progress of reading the views on standard error.
ReportPage CollectWithProgress(PageSource source);

/// Writes a page, dated today where it has no date. Errors: those of WriteFileAtomically.
Expected<void> WritePage(ReportPage page, const std::filesystem::path& path);

/// The report of a calibration with the photos and scans of its session; without a pose, what each
/// sensor saw. `tolerance_s`: CalibrateOptions::tolerance_s. Errors: those of WriteFileAtomically.
Expected<void> WriteCalibrationReport(const Calibration& calibration, double tolerance_s,
                                      const std::filesystem::path& path);

}  // namespace sextant::cli
