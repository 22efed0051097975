// SPDX-License-Identifier: Apache-2.0
#include "bench/machine.h"

#include <fmt/core.h>

#include <cstdlib>
#include <fstream>
#include <thread>

namespace sextant::bench {

std::string ProcessorName() {
  std::ifstream file("/proc/cpuinfo");
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with("model name")) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

std::string DescribeMachine() {
  double load = 0.0;
  getloadavg(&load, 1);
  return fmt::format("{}, {} cores; load {:.1f}", ProcessorName(),
                     std::thread::hardware_concurrency(), load);
}

}  // namespace sextant::bench
