// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "calibrate/match/assemble.h"
#include "calibrate/observe/observe.h"
#include "calibrate/session/file_pairs.h"

namespace sextant {

/// Reads and observes every pair, on all cores; the views are in the order of the pairs. `step` is
/// called after each, from any thread, and may be empty. A pair that cannot be read gives a view
/// with that error.
std::vector<SessionView> ObserveFiles(const Observer& observer, std::span<const FilePair> pairs,
                                      const std::function<void()>& step);

}  // namespace sextant
