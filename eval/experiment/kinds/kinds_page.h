// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "eval/experiment/definition/trials.h"

namespace sextant {

/// Documentation of every kind with its parameters and metrics, in Markdown.
std::string FormatKindsPage(const std::vector<TrialKind>& kinds);

}  // namespace sextant
