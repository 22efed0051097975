// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace sextant::bench {

struct Cost {
  double seconds = 0.0;
  double peak_mb = 0.0;  ///< Peak memory.
};

/// Runs the body in a separate process, so that earlier memory does not count. The body prepares
/// its inputs, calls `measure` once with the call to measure, and returns whether the result was
/// right. The cost is the minimum time of several calls, and the memory growth during the first.
/// None if the result was wrong.
using Measure = std::function<void(const std::function<void()>& call)>;
std::optional<Cost> CostOfCall(const std::function<bool(const Measure& measure)>& body);

/// Cost of running a program: wall time, and the memory of the largest of its processes. Its output
/// is discarded. None if it fails.
std::optional<Cost> CostOfProgram(const std::vector<std::string>& command);

}  // namespace sextant::bench
