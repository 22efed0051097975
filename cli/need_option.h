// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "cli/command.h"

namespace sextant::cli {

/// --need: the accuracy for the verdict, in mm and degrees.
void DeclareNeed(std::vector<double>& need, Arguments& arguments);

}  // namespace sextant::cli
