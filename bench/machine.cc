// SPDX-License-Identifier: Apache-2.0
#include "bench/machine.h"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <thread>

namespace sextant::bench {
namespace {

std::string FirstLineWith(const std::string& path, const std::string& mark) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.starts_with(mark)) return line.substr(line.find(':') + 2);
  }
  return "unknown";
}

}  // namespace

std::string DescribeMachine() {
  double load = 0.0;
  getloadavg(&load, 1);
  return fmt::format("{}, {} cores; load {:.1f}", FirstLineWith("/proc/cpuinfo", "model name"),
                     std::thread::hardware_concurrency(), load);
}

}  // namespace sextant::bench
