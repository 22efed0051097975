// SPDX-License-Identifier: Apache-2.0
#include "support/cost/child_cost.h"

#include <malloc.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>

namespace sextant::test {
namespace {

// A child begins with the peak of its parent; see proc(5), clear_refs.
void ResetPeak() { std::ofstream("/proc/self/clear_refs") << 5; }

std::size_t PeakBytes() {
  struct rusage usage {};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::size_t>(usage.ru_maxrss) * 1024;
}

}  // namespace

ChildCost CostOf(const std::function<bool()>& work) {
  int ends[2] = {};
  if (pipe(ends) != 0) return {};
  const pid_t child = fork();
  if (child == 0) {
    malloc_trim(0);
    ResetPeak();
    const std::size_t before = PeakBytes();
    const auto start = std::chrono::steady_clock::now();
    ChildCost cost{.ended = work()};
    cost.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    cost.peak_bytes = PeakBytes() - before;
    _exit(write(ends[1], &cost, sizeof cost) == sizeof cost ? 0 : 1);
  }
  close(ends[1]);
  ChildCost cost;
  if (read(ends[0], &cost, sizeof cost) != sizeof cost) cost = {};
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
#ifdef SEXTANT_SANITIZED
  cost.seconds = 0.0;
  cost.peak_bytes = 0;
#endif
  return cost;
}

}  // namespace sextant::test
