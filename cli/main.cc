// SPDX-License-Identifier: Apache-2.0
#include "cli/parse.h"
#include "cli/program.h"

int main(int argc, char** argv) {
  return sextant::cli::RunProgram(sextant::cli::SextantProgram(), argc, argv);
}
