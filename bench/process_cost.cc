// SPDX-License-Identifier: Apache-2.0
#include "bench/process_cost.h"

#include <fcntl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>

namespace sextant::bench {
namespace {

using Clock = std::chrono::steady_clock;

double SecondsSince(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

// The field "VmHWM" or "VmRSS" of this process.
double StatusMb(const std::string& field) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with(field + ":")) return std::atof(line.c_str() + field.size() + 1) / 1024.0;
  }
  return 0.0;
}

Cost CostOf(const std::function<void()>& call) {
  std::ofstream("/proc/self/clear_refs") << "5";  // Resets the peak.
  const double before_mb = StatusMb("VmRSS");
  const Clock::time_point start = Clock::now();
  call();
  const double first = SecondsSince(start);
  Cost cost{.seconds = first, .peak_mb = std::max(0.0, StatusMb("VmHWM") - before_mb)};
  // The minimum of five rounds of 20 ms, as other programs only add time.
  constexpr int kRounds = 5;
  const int calls = std::clamp(static_cast<int>(0.02 / first), 1, 100'000);
  const int rounds = first > 0.3 ? 0 : kRounds;
  for (int round = 0; round < rounds; ++round) {
    const Clock::time_point begin = Clock::now();
    for (int i = 0; i < calls; ++i) call();
    cost.seconds = std::min(cost.seconds, SecondsSince(begin) / calls);
  }
  return cost;
}

}  // namespace

std::optional<Cost> CostOfCall(const std::function<bool(const Measure& measure)>& body) {
  int ends[2];
  if (pipe(ends) != 0) return std::nullopt;
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    const bool right = body([&ends](const std::function<void()>& call) {
      const Cost cost = CostOf(call);
      if (write(ends[1], &cost, sizeof cost) != static_cast<ssize_t>(sizeof cost)) _exit(1);
    });
    _exit(right ? 0 : 1);
  }
  close(ends[1]);
  Cost cost;
  const bool whole =
      child > 0 && read(ends[0], &cost, sizeof cost) == static_cast<ssize_t>(sizeof cost);
  close(ends[0]);
  int status = 0;
  if (child > 0) waitpid(child, &status, 0);
  return whole && status == 0 ? std::optional(cost) : std::nullopt;
}

std::optional<Cost> CostOfProgram(const std::vector<std::string>& command) {
  const Clock::time_point start = Clock::now();
  const pid_t child = fork();
  if (child == 0) {
    const int nowhere = open("/dev/null", O_RDWR);
    for (const int fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) dup2(nowhere, fd);
    std::vector<char*> arguments;
    for (const std::string& argument : command)
      arguments.push_back(const_cast<char*>(argument.c_str()));
    arguments.push_back(nullptr);
    execvp(arguments[0], arguments.data());
    _exit(127);
  }
  int status = 0;
  rusage usage{};
  if (child < 0 || wait4(child, &status, 0, &usage) != child || status != 0) return std::nullopt;
  return Cost{.seconds = SecondsSince(start),
              .peak_mb = static_cast<double>(usage.ru_maxrss) / 1024.0};
}

}  // namespace sextant::bench
