// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace sextant::bench {

/// "AMD EPYC"; "unknown" where the system does not say.
std::string ProcessorName();

/// "AMD EPYC, 2 cores; load 0.4".
std::string DescribeMachine();

}  // namespace sextant::bench
