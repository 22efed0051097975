// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>

namespace sextant::cli {

/// A bar with the time left on standard error, where that is a terminal; silent elsewhere.
class Progress {
 public:
  Progress(std::string what, long total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// One step is done. Thread-safe.
  void Step() { Set(++done_); }
  /// So many steps are done. Thread-safe.
  void Set(long done);

 private:
  void Draw(long done);

  std::string what_;
  long total_;
  bool visible_;
  std::atomic<long> done_{0};
  std::mutex drawing_;
  std::chrono::steady_clock::time_point start_;
  std::chrono::steady_clock::time_point drawn_;
};

}  // namespace sextant::cli
