// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace sextant::test {

/// A call of a kernel with its inputs.
struct KernelCall {
  std::string name;  ///< "kabsch/8": the kernel and the number of points.
  int problems = 0;  ///< Number of different problems that one call solves.
  std::function<void()> call;
};

/// Calls of the basic kernels. Inputs are made here, kept, and the same in every run.
std::vector<KernelCall> KernelCalls();

/// Calls of whole solvers by spec and number of pairs, "ransac(p3p)/100". They may allocate.
std::vector<KernelCall> SolverCalls();

}  // namespace sextant::test
