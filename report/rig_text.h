// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "io/results/rig_result.h"

namespace sextant {

/// Pairs that differ from the answer of all sensors by more are named, in sigmas.
inline constexpr double kMaxLoopSigmas = 3.0;
/// What such a pair is a sign of; a phrase.
inline constexpr const char* kLoopCause =
    "an error that their views share, such as wrong intrinsics or another board size";

/// A sentence for each pair whose own answer differs from that of all sensors by more than
/// kMaxLoopSigmas.
std::vector<std::string> LoopFindings(const RigResult& result);

/// A sentence for each sensor without a pose: what would connect it, and, unless the answer is
/// refuted, that the others are usable.
std::vector<std::string> UnconnectedFindings(const RigResult& result);

/// All that `sextant rig` prints: the sensors and their poses in the root's frame, every pair with
/// its uncertainty and the loop test, sensors x views, what was estimated besides, and warnings.
std::string DescribeRig(const RigResult& result);

}  // namespace sextant
