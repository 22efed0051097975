// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"

namespace sextant::cli {

/// Whether a window can be opened. Window libraries end the whole process if they cannot open one,
/// so this is checked first. Error: kIo, with advice.
Expected<void> CheckDisplay();

}  // namespace sextant::cli
