// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace sextant::test {

/// A kernel with all its inputs prepared.
struct KernelCall {
  std::string name;  ///< Includes the number of points: "kabsch/8".
  int problems = 0;  ///< Number of different problems that one call solves.
  std::function<void()> call;
};

/// The basic kernels. Their inputs are prepared here and kept, and are the same in every run.
std::vector<KernelCall> KernelCalls();

/// Complete solvers by spec and number of pairs, such as "ransac(p3p)/100"; they may allocate
/// memory.
std::vector<KernelCall> SolverCalls();

}  // namespace sextant::test
