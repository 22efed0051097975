// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <mutex>
#include <string>

#include "base/progress.h"

namespace sextant::cli {

/// The progress of a command's stages, one after the other, as a bar with the time left, on
/// standard error if that is a terminal; else silent. A bar appears once its stage has taken half a
/// second. Thread-safe.
class Progress {
 public:
  Progress();
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Report(std::string_view stage, std::size_t done, std::size_t total);

  /// Report as a callback, valid as long as this object.
  ProgressCallback Callback() {
    return [this](std::string_view stage, std::size_t done, std::size_t total) {
      Report(stage, done, total);
    };
  }

 private:
  using Clock = std::chrono::steady_clock;

  void Draw(std::size_t done, std::size_t total);
  void Clear();

  bool visible_;
  std::mutex mutex_;
  std::string stage_;
  Clock::time_point start_;  ///< The stage's.
  Clock::time_point drawn_;
  bool is_drawn_ = false;
};

}  // namespace sextant::cli
