// SPDX-License-Identifier: Apache-2.0
#include "base/nearest_name.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace sextant {
namespace {

const std::vector<std::string> kSolverNames = {"kabsch", "pnp", "p3p", "icp", "joint", "dlt"};

TEST(NearestName, IsTheOneWithTheFewestEdits) {
  EXPECT_EQ(NearestName("kabsh", kSolverNames), "kabsch");
  EXPECT_EQ(NearestName("kasbch", kSolverNames), "kabsch") << "a swap is one edit";
  EXPECT_EQ(NearestName("ipc", kSolverNames), "icp");
  EXPECT_EQ(NearestName("jiont", kSolverNames), "joint");
}

TEST(NearestName, IsEmptyWhereNothingIsClose) {
  EXPECT_EQ(NearestName("nope", kSolverNames), "") << "pnp is two edits away";
  EXPECT_EQ(NearestName("", kSolverNames), "");
  EXPECT_EQ(NearestName("x", {}), "");
  EXPECT_EQ(NearestName("ransac", kSolverNames), "");
}

TEST(NearestName, ABeginningIsClose) {
  const std::vector<std::string> keys = {"id", "name", "tags", "checker"};
  EXPECT_EQ(NearestName("checkerboard", keys), "checker");
  EXPECT_EQ(NearestName("check", keys), "checker");
  EXPECT_EQ(NearestName("idle", keys), "") << "two letters are no beginning";
}

TEST(NearestName, ALongTextTakesNoTime) {
  EXPECT_EQ(NearestName(std::string(10'000'000, 'k'), kSolverNames), "");
}

TEST(SuggestName, NamesOneOrAll) {
  EXPECT_EQ(SuggestName("kabsh", kSolverNames), "did you mean 'kabsch'?");
  EXPECT_EQ(SuggestName("nope", kSolverNames), "known are kabsch, pnp, p3p, icp, joint, dlt");
}

}  // namespace
}  // namespace sextant
