// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"

namespace sextant::cli {

Command ListCommand() {
  return {.name = "list",
          .summary = "What there is: solvers, detectors, extractors, LiDARs, kinds of experiments",
          .footer = "Examples:\n  sextant list solvers\n  sextant list extractors --trials 200",
          .subcommands = {ListSolversCommand(), ListDetectorsCommand(), ListExtractorsCommand(),
                          ListLidarsCommand(), ListKindsCommand()}};
}

}  // namespace sextant::cli
