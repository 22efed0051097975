// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"
#include "cli/output.h"
#include "eval/experiment/kinds/kinds_page.h"
#include "io/output/standard_output.h"

namespace sextant::cli {

Command ListKindsCommand() {
  return {.name = "kinds",
          .summary = "The kinds of experiments, their parameters and metrics (Markdown)",
          .footer = "Example:\n  sextant list kinds",
          .run = [] {
            Print("{}", FormatKindsPage(BuiltinKinds()));
            return kAnswered;
          }};
}

}  // namespace sextant::cli
