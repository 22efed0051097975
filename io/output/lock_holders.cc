// SPDX-License-Identifier: Apache-2.0
#include "io/output/lock_holders.h"

#include <fmt/format.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <sstream>
#include <thread>
#include <vector>

namespace sextant {
namespace {

std::vector<pid_t> NumbersIn(int file) {
  std::array<char, 4096> bytes{};
  const ssize_t got = pread(file, bytes.data(), bytes.size(), 0);
  std::istringstream text(std::string(bytes.data(), static_cast<std::size_t>(got > 0 ? got : 0)));
  std::vector<pid_t> numbers;
  for (pid_t number = 0; text >> number;) numbers.push_back(number);
  return numbers;
}

}  // namespace

std::string DescribeHolders(int lock_file) {
  std::vector<pid_t> all = NumbersIn(lock_file);
  // The holder writes its number right after it has taken the lock.
  for (int i = 0; all.empty() && i < 50; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    all = NumbersIn(lock_file);
  }
  std::vector<pid_t> running;
  for (const pid_t number : all) {
    if (kill(number, 0) == 0 || errno != ESRCH) running.push_back(number);
  }
  // On another machine, or in another container, its number says nothing here.
  if (running.empty()) running = all;
  if (running.empty()) return "another process";
  return fmt::format("{} {}", running.size() == 1 ? "process" : "the processes",
                     fmt::join(running, ", "));
}

}  // namespace sextant
