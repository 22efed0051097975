// SPDX-License-Identifier: Apache-2.0
// Every fuzz target on its corpus, and on damaged copies of it, without a fuzzer.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <exception>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "base/random.h"
#include "fuzz/entry_point.h"
#include "fuzz/hostile.h"
#include "support/run_program.h"
#include "support/source_tree.h"

namespace sextant::test {
namespace {

namespace fs = std::filesystem;

fs::path CorpusFolder() { return SourceRoot() / "tests" / "fuzz" / "corpus"; }

std::vector<std::string> TargetNames() {
  std::vector<std::string> names;
  for (const auto& [name, target] : FuzzTargets()) names.push_back(name);
  return names;
}

// The files of the corpus of a target, in the order of their names.
std::vector<fs::path> SeedsOf(const std::string& target) {
  const fs::path folder = CorpusFolder() / target;
  if (!fs::exists(folder)) return {};
  std::vector<fs::path> seeds(fs::directory_iterator(folder), fs::directory_iterator{});
  std::ranges::sort(seeds);
  return seeds;
}

class OfTarget : public testing::TestWithParam<std::string> {
 protected:
  void Run(const std::string& bytes, const std::string& what) {
    try {
      FuzzTargets().at(GetParam())(bytes);
    } catch (const std::exception& fault) {
      ADD_FAILURE() << GetParam() << ", " << what << ": "
                    << std::string(fault.what()).substr(0, 500);
    }
  }
};

class Corpus : public OfTarget {};

TEST_P(Corpus, Holds) {
  const std::vector<fs::path> seeds = SeedsOf(GetParam());
  EXPECT_FALSE(seeds.empty()) << "tests/fuzz/corpus/" << GetParam() << " needs a valid file";
  for (const fs::path& seed : seeds) Run(ReadText(seed), seed.filename().string());
}

TEST_P(Corpus, HoldsWhenDamaged) {
  constexpr int kDamagesPerSeed = 60;
  Random random(3);
  for (const fs::path& seed : SeedsOf(GetParam())) {
    const std::string bytes = ReadText(seed);
    for (int i = 0; i < kDamagesPerSeed && !HasFailure(); ++i) {
      Run(Damaged(bytes, random), seed.filename().string() + ", damage " + std::to_string(i));
    }
  }
}

TEST_P(Corpus, HoldsWhenCut) {
  constexpr std::size_t kCutsPerSeed = 40;
  for (const fs::path& seed : SeedsOf(GetParam())) {
    const std::string bytes = ReadText(seed);
    const std::size_t step = 1 + bytes.size() / kCutsPerSeed;
    for (std::size_t size = 0; size < bytes.size() && !HasFailure(); size += step) {
      Run(bytes.substr(0, size), seed.filename().string() + ", cut to " + std::to_string(size));
    }
  }
}

TEST_P(Corpus, HoldsOnHostileInputs) {
  for (const HostileInput& input : HostileInputs()) Run(input.bytes, input.name);
}

INSTANTIATE_TEST_SUITE_P(Fuzz, Corpus, testing::ValuesIn(TargetNames()),
                         [](const auto& name) { return name.param; });

TEST(CorpusFolders, AreThoseOfTheTargets) {
  std::set<std::string> known;
  for (const std::string& name : TargetNames()) known.insert(name);
#ifndef SEXTANT_WITH_BAG
  for (const char* name : {"bag_message", "mcap", "rosbag1", "rosbag2"}) known.insert(name);
#endif
  for (const fs::directory_entry& folder : fs::directory_iterator(CorpusFolder())) {
    const std::string name = folder.path().filename().string();
    EXPECT_TRUE(known.contains(name)) << "no target uses tests/fuzz/corpus/" << name;
  }
}

}  // namespace
}  // namespace sextant::test
