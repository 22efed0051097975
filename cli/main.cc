// SPDX-License-Identifier: Apache-2.0
#include "cli/program.h"
#include "cli/run_program.h"

int main(int argc, char** argv) {
  sextant::cli::PrepareProcess();
  return sextant::cli::RunProgram(sextant::cli::SextantProgram(), argc, argv);
}
