// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "cli/commands.h"

namespace CLI {
class App;
}

namespace sextant::cli {

/// Subcommands that merge what was calibrated and that reproduce the paper.
void AddFuse(CLI::App& app, FuseOptions& options);

}  // namespace sextant::cli
