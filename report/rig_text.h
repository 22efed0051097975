// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "io/results/rig_result.h"

namespace sextant {

/// All that `sextant rig` prints: the sensors and their poses in the root's frame, every pair with
/// its uncertainty and the loop test, sensors x views, what was estimated besides, and warnings.
std::string DescribeRig(const RigResult& result);

}  // namespace sextant
