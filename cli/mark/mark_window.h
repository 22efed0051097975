// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "base/error.h"
#include "cli/mark/mark_canvas.h"
#include "cli/mark/mark_controller.h"

namespace sextant::cli {

/// The functions by which the window reports to the command that opened it.
struct MarkWindowCalls {
  std::function<void()> save;     ///< On a request to save.
  std::function<void()> changed;  ///< After each change of the marks, and perhaps without one.
};

/// Shows the window until the user closes it. Error: kIo if it cannot be opened.
Expected<void> RunMarkWindow(MarkController& controller, MarkCanvas& canvas,
                             const MarkWindowCalls& calls);

}  // namespace sextant::cli
