// SPDX-License-Identifier: Apache-2.0
// count_instructions: calls every kernel, and under valgrind --tool=callgrind dumps the
// instructions of each. Prints the compiler and the instruction set, which the counts depend on.
#include <valgrind/callgrind.h>

#include <cstdio>

#include "support/kernel_calls.h"

int main() {
  using sextant::test::KernelCall;
  std::vector<KernelCall> calls = sextant::test::KernelCalls();
  for (KernelCall& call : sextant::test::SolverCalls()) calls.push_back(std::move(call));
#if defined(__clang__)
  std::printf("clang %d.%d", __clang_major__, __clang_minor__);
#else
  std::printf("gcc %d.%d", __GNUC__, __GNUC_MINOR__);
#endif
  std::printf(", %s\n", __builtin_cpu_supports("avx2") ? "avx2" : "sse2");
  for (const KernelCall& kernel : calls) {
    kernel.call();  // Allocates buffers and initialises statics.
    CALLGRIND_START_INSTRUMENTATION;
    CALLGRIND_ZERO_STATS;
    kernel.call();
    CALLGRIND_DUMP_STATS_AT(kernel.name.c_str());
    CALLGRIND_STOP_INSTRUMENTATION;
    std::printf("%s %d\n", kernel.name.c_str(), kernel.problems);
  }
  return 0;
}
