// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace sextant::bench {

struct Cost {
  double seconds = 0.0;
  double peak_mb = 0.0;  ///< Of memory, at most.
};

/// Runs the body in a process of its own, so that what was there before does not count. The body
/// prepares, calls `measure` once with the call to measure, and returns whether its answer was
/// right. The cost: how long one call takes, the least of several, and by how much memory grows in
/// the first. None where the answer was wrong.
using Measure = std::function<void(const std::function<void()>& call)>;
std::optional<Cost> CostOfCall(const std::function<bool(const Measure& measure)>& body);

/// A program from its start to its end: wall time, and the memory of the largest of its processes.
/// Its output is thrown away. None where it fails.
std::optional<Cost> CostOfProgram(const std::vector<std::string>& command);

}  // namespace sextant::bench
