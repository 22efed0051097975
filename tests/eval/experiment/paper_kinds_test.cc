// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <string>

#include "eval/experiment/definition/experiment.h"
#include "solvers/builtin_solvers.h"
#include "support/source_tree.h"

namespace sextant::test {
namespace {

// Values by metric and subject.
using MeasuredValues = std::map<std::string, std::map<std::string, std::vector<double>>>;

// The first trials of the first condition.
MeasuredValues Try(const std::string& text, int trials) {
  const std::string file = (SourceRoot() / "experiments" / "try.yaml").string();
  const Expected<Experiment> experiment =
      ParseExperiment(text, file, BuiltinKinds(), BuiltinSolvers());
  EXPECT_TRUE(experiment) << experiment.error().message;
  if (!experiment) return {};
  const Condition& condition = experiment->conditions[0];
  TrialRows rows(experiment->metrics.size(), experiment->wanted);
  for (int i = 0; i < trials; ++i) {
    const auto trial = static_cast<std::uint64_t>(i);
    rows.BeginTrial(trial);
    condition.trials->Run({trial, SeedOf(*experiment, condition, trial)}, rows);
  }
  MeasuredValues values;
  for (std::size_t r = 0; r < rows.keys().size(); ++r) {
    const std::string& subject = condition.trials->subjects()[rows.keys()[r].subject];
    for (std::size_t column = 0; column < rows.metrics(); ++column) {
      values[experiment->metrics[column].name][subject].push_back(
          rows.values()[r * rows.metrics() + column]);
    }
  }
  return values;
}

// Those of one metric and subject, of which every trial has one.
std::vector<double> TryOne(const std::string& text, const std::string& metric, int trials,
                           const std::string& subject) {
  std::vector<double> values = Try(text, trials)[metric][subject];
  EXPECT_GE(values.size(), static_cast<std::size_t>(trials)) << subject;
  return values;
}

TEST(PaperKinds, SceneWithoutNoiseGivesTheTruth) {
  const std::string points =
      "kind: scene\ntrials: 1\nsolvers: [kabsch]\nparameters: {scene: "
      "scenes/paper_two_boards.yaml, lidar: noise, lidar_sigma_m: 0, tag_sigma_px: 1e-6}\n";
  for (const double off : TryOne(points, "translation_mm", 3, "kabsch")) EXPECT_LT(off, 1e-3);
  const std::string pixels =
      "kind: scene\ntrials: 1\nsolvers: [epnp]\nparameters: {scene: scenes/paper_rot_data.yaml, "
      "lidar: noise, lidar_sigma_m: 0, camera: marked, mark_sigma_px: 0, translation_m: [0.785, "
      "-0.52, -0.69], rotation_deg: [2.6, -15, 0]}\n";
  MeasuredValues marked = Try(pixels, 3);
  EXPECT_EQ(marked["inliers"]["epnp"].size(), 3U);
  for (const double x : marked["estimated_x_m"]["epnp"]) EXPECT_NEAR(x, 0.785, 1e-6);
  for (const double kept : marked["inliers"]["epnp"]) EXPECT_EQ(kept, 20.0);
}

// All boards are about 2 m in front of the camera: with an assumed focal length 13 % too long they
// seem farther away.
TEST(PaperKinds, WrongFocalLengthsShiftTheCameraAlongItsAxis) {
  const std::string text =
      "kind: scene\ntrials: 1\nsolvers: [epnp]\nparameters: {scene: scenes/paper_rot_data.yaml, "
      "lidar: noise, lidar_sigma_m: 0, camera: marked, mark_sigma_px: 0, assumed_focal_error: "
      "0.13}\n";
  for (const double z : TryOne(text, "z_mm", 3, "epnp")) {
    EXPECT_GT(z, 150.0);
    EXPECT_LT(z, 400.0);
  }
}

TEST(PaperKinds, AveragedScansAreMoreAccurateThanOne) {
  const std::string text =
      "kind: scene_average\ntrials: 1\nparameters: {scene: scenes/paper_two_boards.yaml, lidar: "
      "noise, scans: 50}\n";
  const std::vector<double> mean = TryOne(text, "translation_mm", 6, "true mean");
  constexpr std::size_t kReported = 10;  // Rows after 1, 2, 3, 5, 7, 10, 15, 20, 30 and 50 scans.
  ASSERT_EQ(mean.size(), 6 * kReported);
  double first = 0.0;
  double last = 0.0;
  for (std::size_t i = 0; i < mean.size(); i += kReported) {
    first += mean[i] * mean[i];
    last += mean[i + kReported - 1] * mean[i + kReported - 1];
  }
  EXPECT_LT(std::sqrt(last), 0.5 * std::sqrt(first));  // 1/sqrt(50) is 0.14.
}

TEST(PaperKinds, BoardsInScansAndImagesAreFound) {
  const std::string scan = "kind: board_scan\ntrials: 1\n";
  MeasuredValues in_scan = Try(scan, 4);
  for (const char* extractor : {"lines3d_raw", "plane_lines", "rectangle"}) {
    const std::vector<double>& corners = in_scan["corner_mm"][extractor];
    EXPECT_EQ(corners.size(), 4U) << extractor;
    for (const double off : corners) EXPECT_LT(off, 150.0) << extractor;
  }
  for (const double gap : in_scan["gap_mm"]["rectangle"]) EXPECT_EQ(gap, 0.0);
  const std::string image =
      "kind: board_image\ntrials: 1\nparameters: {camera_model: pinhole, distance_m: 1.5}\n";
  const auto prints = Try(image, 1)["corner_mm"];
  EXPECT_EQ(prints.size(), 3U);
  for (const auto& [print, errors] : prints) {
    for (const double off : errors) EXPECT_LT(off, 10.0) << print;
  }
}

TEST(PaperKinds, RejectsInvalidParameters) {
  const auto message = [](const std::string& parameters) {
    const std::string file = (SourceRoot() / "experiments" / "try.yaml").string();
    const Expected<Experiment> experiment =
        ParseExperiment("kind: scene\ntrials: 1\nsolvers: [kabsch]\nparameters: " + parameters,
                        file, BuiltinKinds(), BuiltinSolvers());
    return experiment ? std::string("nothing refused") : experiment.error().message;
  };
  EXPECT_THAT(message("{scene: scenes/nowhere.yaml}"), testing::HasSubstr("nowhere.yaml"));
  const std::string scene = "{scene: scenes/paper_two_boards.yaml, ";
  EXPECT_THAT(message(scene + "translation_m: [1, 2]}"), testing::HasSubstr("expected 3 numbers"));
  EXPECT_THAT(message(scene + "extractor: lines}"), testing::HasSubstr("lines3d"));
  EXPECT_THAT(message(scene + "lidar_model: vlp17}"), testing::HasSubstr("vlp16"));
  EXPECT_THAT(message(scene + "camera: tag}"), testing::HasSubstr("tags"));
  EXPECT_THAT(message("{scene: scenes/paper_hollow.yaml, translation_m: [0, 0, -9]}"),
              testing::Not(testing::HasSubstr("nothing refused")));
}

TEST(RigKind, EveryPairIsMeasuredAgainstItsBoundItsCovarianceAndItsChain) {
  const std::string text =
      "kind: rig\ntrials: 1\nparameters: {cameras: 2, lidars: 1, moments: 8, takes_part: 0.8}\n";
  constexpr int kTrials = 6;
  MeasuredValues measured = Try(text, kTrials);
  std::map<std::string, std::vector<double>> squares;
  for (const char* metric : {"nees", "over_bound", "translation_mm", "chained_mm"}) {
    for (const auto& [pair, values] : measured[metric]) {
      for (const double value : values) {
        const bool squared = std::string(metric) == "nees";
        squares[metric].push_back(squared ? value : value * value);
      }
    }
    ASSERT_EQ(squares[metric].size(), 3U * kTrials) << metric;
  }
  const auto mean = [&](const char* metric) {
    double sum = 0.0;
    for (const double value : squares[metric]) sum += value;
    return sum / static_cast<double>(squares[metric].size());
  };
  // chi^2 of 6 trials with 12 independent axes each, over its mean: 0.6 to 1.5 with 0.3 % each.
  EXPECT_GT(mean("nees"), 0.6);
  EXPECT_LT(mean("nees"), 1.5);
  EXPECT_LT(std::sqrt(mean("over_bound")), 1.3);
  EXPECT_LT(mean("translation_mm"), mean("chained_mm"));
}

TEST(RigKind, ClocksNeedBoardsThatMove) {
  const std::string file = (SourceRoot() / "experiments" / "try.yaml").string();
  const Expected<Experiment> experiment =
      ParseExperiment("kind: rig\ntrials: 1\nparameters: {clock_sigma_s: 0.01}\n", file,
                      BuiltinKinds(), BuiltinSolvers());
  ASSERT_FALSE(experiment);
  EXPECT_THAT(experiment.error().message, testing::HasSubstr("give speed_m_s"));
}

}  // namespace
}  // namespace sextant::test
