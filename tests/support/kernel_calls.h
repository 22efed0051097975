// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace sextant::test {

/// A kernel with everything it needs at hand.
struct KernelCall {
  std::string name;  ///< "kabsch/8": with the number of points.
  int problems = 0;  ///< That one call solves, all different.
  std::function<void()> call;
};

/// The kernels that others are built from. What they need is made here and kept; the same in every
/// run.
std::vector<KernelCall> KernelCalls();

/// Whole solvers, by spec and number of pairs, which may allocate: "ransac(p3p)/100".
std::vector<KernelCall> SolverCalls();

}  // namespace sextant::test
