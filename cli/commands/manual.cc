// SPDX-License-Identifier: Apache-2.0
#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/program.h"
#include "cli/shell/manual_page.h"
#include "io/output/standard_output.h"

namespace sextant::cli {

Command ManualCommand() {
  return {.name = "manual",
          .summary = "All commands and options as a page for man",
          .footer = "Example:\n  sextant manual > sextant.1 && man ./sextant.1",
          .run = [] {
            PrintText(ManualPage(SextantProgram()));
            return kAnswered;
          }};
}

}  // namespace sextant::cli
