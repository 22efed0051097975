// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "base/error.h"
#include "cli/mark/mark_canvas.h"
#include "cli/mark/mark_controller.h"

namespace sextant::cli {

/// What the window asks of the command that opened it.
struct MarkWindowCalls {
  std::function<void()> save;     ///< The user asks to save.
  std::function<void()> changed;  ///< The marks may have changed.
};

/// Shows the window until the user closes it. Error: kIo where it cannot be opened.
Expected<void> RunMarkWindow(MarkController& controller, MarkCanvas& canvas,
                             const MarkWindowCalls& calls);

}  // namespace sextant::cli
