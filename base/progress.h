// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace sextant {

/// Reports how many of the `total` steps of a stage of long work are done. The stages follow each
/// other. The first call of a stage, with done = 0, and the last one, with done = total, come from
/// the thread that started the work, while no other call runs; those in between come from any
/// thread, several at once and in any order.
using ProgressCallback =
    std::function<void(std::string_view stage, std::size_t done, std::size_t total)>;

/// Counts the finished steps of one stage and reports them; an empty callback is allowed.
class ProgressCounter {
 public:
  ProgressCounter(ProgressCallback callback, std::string stage, std::size_t total)
      : callback_(std::move(callback)), stage_(std::move(stage)), total_(total) {
    if (callback_) callback_(stage_, 0, total_);
  }

  /// One more step is finished. Thread-safe.
  void Step() {
    const std::size_t done = ++done_;
    if (callback_ && done < total_) callback_(stage_, done, total_);
  }

  /// All steps are finished, and every call of Step has returned.
  void Finish() const {
    if (callback_) callback_(stage_, total_, total_);
  }

 private:
  ProgressCallback callback_;
  std::string stage_;
  std::size_t total_;
  std::atomic<std::size_t> done_{0};
};

}  // namespace sextant
