// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "calibrate/match/assemble.h"
#include "calibrate/observe/observe.h"
#include "calibrate/session/file_pairs.h"

namespace sextant {

/// Reads and examines every pair, on all cores, in their order; `step` is called after each, from
/// any thread. A pair that cannot be read is a view with that error.
std::vector<SessionView> ObserveFiles(const Observer& observer, std::span<const FilePair> pairs,
                                      const std::function<void()>& step);

}  // namespace sextant
