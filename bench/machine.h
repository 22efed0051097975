// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace sextant::bench {

/// "AMD EPYC, 2 cores; load at the start 0.4".
std::string DescribeMachine();

}  // namespace sextant::bench
