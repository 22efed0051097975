// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace sextant::bench {

/// The CPU model, such as "AMD EPYC"; "unknown" if the system does not provide it.
std::string ProcessorName();

/// CPU, cores and load: "AMD EPYC, 2 cores; load 0.4".
std::string DescribeMachine();

}  // namespace sextant::bench
