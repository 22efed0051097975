// SPDX-License-Identifier: Apache-2.0
// Experiments on a data set of files instead of a simulation.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "eval/experiment/definition/experiment.h"
#include "geometry/rigid3d.h"
#include "io/problems/pairs_csv.h"
#include "io/problems/problem_yaml.h"
#include "solvers/builtin_solvers.h"
#include "support/run_program.h"
#include "support/scenes.h"

namespace sextant::test {
namespace {

using testing::HasSubstr;

// The checksum of the manifest, bit by bit.
std::uint32_t Crc32(const std::string& bytes) {
  std::uint32_t crc = 0xffffffffU;
  for (const char c : bytes) {
    crc ^= static_cast<unsigned char>(c);
    for (int bit = 0; bit < 8; ++bit) crc = (crc >> 1U) ^ ((crc & 1U) != 0 ? 0xedb88320U : 0U);
  }
  return ~crc;
}

// A folder of data with boards of four pairs each, and a manifest beside the experiment.
class RealKinds : public testing::Test {
 protected:
  RealKinds() {
    Random random(3);
    const auto scene = MakeScene({.pairs = 40, .sigma_m = 0.005}, random);
    truth_ = scene.cam_from_lidar;
    CalibrationProblem problem = scene.problem;
    for (int i = 0; i < 40; ++i) {
      Pair3d3d& pair = problem.pairs_3d3d[static_cast<std::size_t>(i)];
      pair.id = {.view = 0, .board = i / 4, .corner = i % 4};
      pair.sigma_m = 0.0;
    }
    const std::string pairs = FormatPairsCsv(problem.pairs_3d3d);
    std::filesystem::create_directories(TestFolder() / "data");
    WriteText(TestFolder() / "data" / "pairs.csv", pairs);
    WriteText(TestFolder() / "set.yaml", Manifest("pairs.csv", pairs.size(), Crc32(pairs)));
    setenv("SEXTANT_DATA", (TestFolder() / "data").c_str(), 1);
  }
  ~RealKinds() override { unsetenv("SEXTANT_DATA"); }

  std::string Manifest(const std::string& file, std::size_t bytes, std::uint32_t crc) const {
    const Eigen::Quaterniond& q = truth_.rotation;
    const Eigen::Vector3d& t = truth_.translation;
    return fmt::format(
        "sextant_data: 1\nname: set\nabout: a\nsource: s\nlicence: l\npairs: {0}\nreference:\n"
        "  translation_m: [{1}, {2}, {3}]\n  quaternion_wxyz: [{4}, {5}, {6}, {7}]\n  from: truth\n"
        "files:\n  - {{path: {0}, bytes: {8}, crc32: \"{9:08x}\"}}\n",
        file, t.x(), t.y(), t.z(), q.w(), q.x(), q.y(), q.z(), bytes, crc);
  }

  static Expected<Experiment> Parse(const std::string& conditions) {
    return ParseExperiment(
        "kind: real_pairs\ntrials: 2\nsolvers: [kabsch, ransac(kabsch)]\nconditions:\n" +
            conditions,
        TestPath("e.yaml"), BuiltinKinds(), BuiltinSolvers());
  }

  // The metric of the first subject in the first trials of the only condition.
  static std::vector<double> Values(const Experiment& experiment, const std::string& metric) {
    TrialRows rows(experiment.metrics.size(), experiment.wanted);
    for (std::uint64_t trial = 0; trial < 20; ++trial) {
      rows.BeginTrial(trial);
      experiment.conditions[0].trials->Run({trial, trial + 1}, rows);
    }
    std::size_t column = 0;
    while (experiment.metrics[column].name != metric) ++column;
    std::vector<double> values;
    for (std::size_t r = 0; r < rows.keys().size(); r += 2) {
      values.push_back(rows.values()[r * rows.metrics() + column]);
    }
    return values;
  }

  Rigid3d truth_;
};

TEST_F(RealKinds, BootstrapOverBoardsMeasuresHeldOutErrorAndReference) {
  const Expected<Experiment> experiment = Parse("  - {name: a, manifest: set.yaml}\n");
  ASSERT_TRUE(experiment) << experiment.error().message;
  for (const double answered : Values(*experiment, "answered")) EXPECT_EQ(answered, 1.0);
  for (const double near : Values(*experiment, "near_reference")) EXPECT_EQ(near, 1.0);
  // The median of the norm of three axes with 5 mm each is 7.7 mm.
  for (const double mm : Values(*experiment, "held_out_mm")) EXPECT_NEAR(mm, 7.7, 5.0);
  EXPECT_EQ(Values(*experiment, "held_out_mm"), Values(*experiment, "held_out_mm"));
}

TEST_F(RealKinds, TheUsedShareIsOfTheSolversKindOfPairs) {
  Random random(5);
  ProblemFile file;
  file.problem = MakeScene({.pairs = 40, .sigma_m = 0.005, .sigma_px = 0.5}, random).problem;
  ASSERT_EQ(file.problem.pairs_3d3d.size(), 40U);
  ASSERT_EQ(file.problem.pairs_2d3d.size(), 40U);
  for (int i = 0; i < 40; ++i) {
    const PairId id{.view = 0, .board = i / 4, .corner = i % 4};
    file.problem.pairs_3d3d[static_cast<std::size_t>(i)].id = id;
    file.problem.pairs_2d3d[static_cast<std::size_t>(i)].id = id;
  }
  const std::string text = FormatProblemYaml(file);
  WriteText(TestFolder() / "data" / "both.yaml", text);
  WriteText(TestFolder() / "both_set.yaml", Manifest("both.yaml", text.size(), Crc32(text)));
  const Expected<Experiment> experiment = Parse("  - {name: a, manifest: both_set.yaml}\n");
  ASSERT_TRUE(experiment) << experiment.error().message;
  // The first solver, kabsch, uses every 3D-3D pair.
  for (const double share : Values(*experiment, "used_share")) EXPECT_EQ(share, 1.0);
}

TEST_F(RealKinds, HalvesAgreeWithinTheirStatedCovariances) {
  const Expected<Experiment> experiment =
      Parse("  - {name: a, manifest: set.yaml, resample: halves}\n");
  ASSERT_TRUE(experiment) << experiment.error().message;
  double within = 0.0;
  for (const double w : Values(*experiment, "halves_within95")) within += w;
  EXPECT_GE(within, 15.0);
  for (const double mm : Values(*experiment, "halves_mm")) EXPECT_GT(mm, 0.0);
}

TEST_F(RealKinds, ASetThatIsAbsentIsLeftOutAndNamed) {
  WriteText(TestFolder() / "other.yaml", Manifest("gone.csv", 3, 0));
  const Expected<Experiment> experiment =
      Parse("  - {name: a, manifest: set.yaml}\n  - {name: b, manifest: other.yaml}\n");
  ASSERT_TRUE(experiment) << experiment.error().message;
  EXPECT_EQ(experiment->conditions.size(), 1U);
  ASSERT_EQ(experiment->absent.size(), 1U);
  EXPECT_THAT(experiment->absent[0], HasSubstr("b: gone.csv is absent"));
  const Expected<Experiment> none = Parse("  - {name: b, manifest: other.yaml}\n");
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kMissingData);
}

TEST_F(RealKinds, AnotherFileThanTheManifestsIsRefused) {
  WriteText(TestFolder() / "data" / "pairs.csv", "changed");
  const Expected<Experiment> experiment = Parse("  - {name: a, manifest: set.yaml}\n");
  ASSERT_FALSE(experiment);
  EXPECT_THAT(experiment.error().message, HasSubstr("it is not the file of the manifest"));
  WriteText(TestFolder() / "set.yaml", Manifest("../pairs.csv", 3, 0));
  EXPECT_THAT(Parse("  - {name: a, manifest: set.yaml}\n").error().message,
              HasSubstr("a path within the folder of the data"));
}

}  // namespace
}  // namespace sextant::test
