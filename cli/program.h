// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/command.h"

namespace sextant::cli {

/// `sextant`: its commands in groups, and its help.
Program SextantProgram();

}  // namespace sextant::cli
