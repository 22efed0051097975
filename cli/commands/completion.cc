// SPDX-License-Identifier: Apache-2.0
#include "cli/shell/completion.h"

#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/program.h"
#include "io/output/standard_output.h"

namespace sextant::cli {
namespace {

Command ShellCommand(std::string shell, std::string footer,
                     std::string (*completion)(const Program&)) {
  return {.name = std::move(shell),
          .summary = "The script for this shell",
          .footer = std::move(footer),
          .run = [completion] {
            PrintText(completion(SextantProgram()));
            return kAnswered;
          }};
}

}  // namespace

Command CompletionCommand() {
  return {.name = "completion",
          .summary = "Scripts that complete commands, options and files in bash and zsh",
          .footer = "The Debian package installs both.",
          .subcommands = {ShellCommand("bash",
                                       "Example, for this shell and for all to come:\n"
                                       "  source <(sextant completion bash)\n"
                                       "  sextant completion bash > "
                                       "~/.local/share/bash-completion/completions/sextant",
                                       BashCompletion),
                          ShellCommand("zsh",
                                       "Example, with a folder that is in fpath:\n"
                                       "  sextant completion zsh > ~/.zsh/completions/_sextant",
                                       ZshCompletion)}};
}

}  // namespace sextant::cli
