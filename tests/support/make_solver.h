// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"

namespace sextant::test {

inline SolverPtr MakeSolver(const std::string& spec) {
  const Expected<SolverPtr> solver = BuiltinSolvers().Make(spec);
  EXPECT_TRUE(solver) << solver.error().message;
  return *solver;
}

}  // namespace sextant::test
