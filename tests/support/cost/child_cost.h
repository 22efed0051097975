// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>

namespace sextant::test {

/// What a piece of work takes, in a process of its own.
struct ChildCost {
  bool ended = false;  ///< False if it was killed, or exited with an error.
  double seconds = 0.0;
  std::size_t peak_bytes = 0;  ///< Largest resident memory, less that at the start.
};

/// Forks, runs the work in the child and measures it. Requires a process of one thread. `work`
/// returns whether the result is as expected. Under a sanitizer, which keeps freed memory and slows
/// everything down, the work is done and `ended` counts, but time and memory are 0.
ChildCost CostOf(const std::function<bool()>& work);

}  // namespace sextant::test
