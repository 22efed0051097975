// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "cli/command.h"

namespace sextant::cli {

/// Scripts that complete the program's commands, options, choices and files in a shell.
std::string BashCompletion(const Program& program);
std::string ZshCompletion(const Program& program);

}  // namespace sextant::cli
