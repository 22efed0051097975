// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <chrono>
#include <mutex>
#include <string>

namespace sextant::cli {

/// A progress bar with the time left, on standard error if that is a terminal; else silent.
class Progress {
 public:
  Progress(std::string what, long total);
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  /// Counts one more step as done. Thread-safe.
  void Step() { Set(++done_); }
  /// Sets the number of steps done. Thread-safe.
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
