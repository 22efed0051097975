// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "io/results/check_result.h"
#include "report/page/page.h"

namespace sextant {

/// The content of a check's report: the answer, the change with its sigma, and each photo with its
/// scan drawn by the pose that was checked, in which everybody sees whether edges coincide.
/// `folder`: where relative paths of the result may start, too.
ReportPage CollectCheckPage(const CheckResult& check, const std::filesystem::path& folder);

}  // namespace sextant
