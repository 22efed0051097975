// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/error.h"

namespace sextant::cli {

/// Whether a window can be opened. Window libraries end the whole process where they cannot, so
/// this asks first. Error: kIo, with what to do.
Expected<void> CheckDisplay();

}  // namespace sextant::cli
