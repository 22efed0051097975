// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/command.h"

namespace sextant::cli {

/// The page of section 1 for man, with every command and option of the program.
std::string ManualPage(const Program& program);

}  // namespace sextant::cli
