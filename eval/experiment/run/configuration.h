// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>

#include "eval/experiment/definition/experiment.h"

namespace sextant {

/// Everything that the rows depend on, as the JSON in the header of the row file.
std::string ConfigurationOf(const Experiment& experiment);

/// Number of metrics in a configuration; 0 if the text is not one.
std::size_t CountMetrics(const std::string& configuration);

/// Number of blocks of the experiment with this configuration; 0 if the text is not one.
std::uint64_t CountBlocks(const std::string& configuration);

}  // namespace sextant
