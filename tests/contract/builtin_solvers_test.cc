// SPDX-License-Identifier: Apache-2.0
// The contract tests for our own solvers, and tests of their registry. A new entry in the table of
// solvers is tested without a change here.
#include "solvers/builtin_solvers.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "support/under_contract.h"

namespace sextant {

SolverRegistry RegistryUnderContract() { return BuiltinSolvers(); }

// The example of each entry, and each wrapping solver around a closed form for each kind of pairs.
std::vector<std::string> SpecsUnderContract() {
  const SolverRegistry registry = BuiltinSolvers();
  std::vector<std::string> specs;
  const auto add = [&](const std::string& spec) {
    const Expected<SolverPtr> solver = registry.Make(spec);
    if (!solver) return;
    const std::string& name = (*solver)->spec().name;
    if (std::find(specs.begin(), specs.end(), name) == specs.end()) specs.push_back(name);
  };
  for (const SolverEntry& entry : registry.entries()) {
    add(entry.example);
    if (!entry.wraps_solver) continue;
    for (const char* inner : {"kabsch", "epnp"}) add(entry.name + "(" + inner + ")");
  }
  return specs;
}

std::string ExcuseFrom(const std::string&, const std::string&) { return {}; }

namespace {

TEST(Registry, EveryExampleWorks) {
  const SolverRegistry registry = BuiltinSolvers();
  for (const SolverEntry& entry : registry.entries()) {
    const Expected<SolverPtr> solver = registry.Make(entry.example);
    EXPECT_TRUE(solver) << entry.name << ": " << solver.error().message;
    EXPECT_FALSE(entry.summary.empty() || entry.needs.empty() || entry.reference.empty())
        << entry.name;
  }
}

TEST(Registry, NamesTheNearestKnownName) {
  const SolverRegistry registry = BuiltinSolvers();
  const Expected<SolverPtr> solver = registry.Make("kabsh");
  ASSERT_FALSE(solver);
  EXPECT_EQ(solver.error().code, ErrorCode::kUnknownName);
  EXPECT_NE(solver.error().message.find("'kabsch'"), std::string::npos);
}

TEST(Registry, RefusesOptionsItDoesNotKnow) {
  const SolverRegistry registry = BuiltinSolvers();
  EXPECT_EQ(registry.Make("kabsch(weight=1)").error().code, ErrorCode::kUnknownName);
  EXPECT_EQ(registry.Make("kabsch(kabsch)").error().code, ErrorCode::kInvalidOption);
}

}  // namespace
}  // namespace sextant
