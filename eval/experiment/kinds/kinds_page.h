// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "eval/experiment/definition/trials.h"

namespace sextant {

/// Every kind with its parameters and metrics, as the part of a page (Markdown).
std::string FormatKindsPage(const std::vector<TrialKind>& kinds);

}  // namespace sextant
