// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "io/results/rig_result.h"
#include "report/page/page.h"

namespace sextant {

/// The content of a rig's report: its sensors from above and in numbers, every pair with the
/// comparison of its own answer with that of all sensors, which sensor saw which board, and what
/// was estimated besides. The verdict is NOT USABLE where the result states so or a sensor is not
/// connected, USABLE WITH CARE with warnings or pairs that differ by more than three sigmas, and
/// else no more than that no check found a fault.
ReportPage CollectRigPage(const RigResult& result);

}  // namespace sextant
