// SPDX-License-Identifier: Apache-2.0
#include "io/output/lock_holders.h"

#include <fmt/format.h>
#include <sys/stat.h>
#include <sys/sysmacros.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <fstream>
#include <sstream>
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

std::string Describe(const std::vector<pid_t>& processes) {
  if (processes.empty()) return "another process";
  return fmt::format("{} {}", processes.size() == 1 ? "process" : "the processes",
                     fmt::join(processes, ", "));
}

}  // namespace

std::string DescribeHolders(int lock_file) {
  const std::vector<pid_t> all = NumbersIn(lock_file);
  std::vector<pid_t> running;
  for (const pid_t number : all) {
    if (kill(number, 0) == 0 || errno != ESRCH) running.push_back(number);
  }
  // On another machine, or in another container, its number means nothing here.
  if (running.empty()) running = all;
  return Describe(running);
}

// A line of the list: "7: FLOCK  ADVISORY  WRITE 4711 fe:01:1835021 0 EOF", the device in
// hexadecimal numbers.
std::string DescribeLockers(int file) {
  struct stat status {};
  if (fstat(file, &status) != 0) return Describe({});
  const std::string wanted =
      fmt::format("{:02x}:{:02x}:{}", major(status.st_dev), minor(status.st_dev), status.st_ino);
  std::vector<pid_t> holders;
  std::ifstream locks("/proc/locks");
  for (std::string line; std::getline(locks, line);) {
    std::istringstream words(line);
    std::string number;
    std::string kind;
    std::string advisory;
    std::string access;
    std::string place;
    pid_t process = 0;
    words >> number >> kind >> advisory >> access >> process >> place;
    if (kind == "FLOCK" && place == wanted && process > 0) holders.push_back(process);
  }
  return Describe(holders);
}

}  // namespace sextant
