// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "base/error.h"
#include "report/collect/collect_page.h"

namespace sextant::cli {

/// What WroteLine says about a report.
inline constexpr const char* kReportWords = "the report, one file that opens in any browser";

/// Collects the report, dates it today and writes it. Errors: those of WriteFileAtomically.
Expected<void> WriteReport(PageSource source, const std::filesystem::path& path);

}  // namespace sextant::cli
