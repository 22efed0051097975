// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>

namespace sextant {

/// Reports how many of `total` views have been observed. The first call, with done = 0, and the
/// last one, with done = total, come from the thread that started the work, while no other call
/// runs; those in between come from any thread, several at once and in any order.
using ProgressCallback = std::function<void(std::size_t done, std::size_t total)>;

/// Counts finished views and reports them; an empty callback is allowed.
class ProgressCounter {
 public:
  ProgressCounter(const ProgressCallback& callback, std::size_t total)
      : callback_(callback), total_(total) {
    if (callback_) callback_(0, total_);
  }

  /// One more view is finished. Thread-safe.
  void Step() {
    const std::size_t done = ++done_;
    if (callback_ && done < total_) callback_(done, total_);
  }

  /// All views are finished, and every call of Step has returned.
  void Finish() const {
    if (callback_) callback_(total_, total_);
  }

 private:
  const ProgressCallback& callback_;
  std::size_t total_;
  std::atomic<std::size_t> done_{0};
};

}  // namespace sextant
