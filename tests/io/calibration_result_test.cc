// SPDX-License-Identifier: Apache-2.0
#include "io/results/calibration_result.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "base/text/printable.h"
#include "io/output/output_file.h"
#include "support/bad_text.h"
#include "support/calibration_result.h"
#include "support/scratch_folder.h"

namespace sextant {
namespace {

using test::BadText;
using testing::HasSubstr;

void ExpectSame(const CalibrationResult& read, const CalibrationResult& written) {
  EXPECT_EQ(read.solver, written.solver);
  EXPECT_EQ(read.seed, written.seed);
  EXPECT_EQ(read.configuration, written.configuration);
  EXPECT_EQ(read.lidar_frame, written.lidar_frame);
  EXPECT_EQ(read.cam_from_lidar.rotation.coeffs(), written.cam_from_lidar.rotation.coeffs());
  EXPECT_EQ(read.cam_from_lidar.translation, written.cam_from_lidar.translation);
  EXPECT_EQ(read.covariance, written.covariance);
  ASSERT_TRUE(read.verdict);
  EXPECT_EQ(read.verdict->usability, written.verdict->usability);
  EXPECT_EQ(read.verdict->reason, written.verdict->reason);
  EXPECT_EQ(read.verdict->next, written.verdict->next);
  EXPECT_EQ(read.closing, written.closing);
  EXPECT_EQ(read.warnings, written.warnings);
  ASSERT_TRUE(read.camera && read.lidar && read.trust && read.trust->bootstrap);
  EXPECT_EQ(read.camera->distortion, written.camera->distortion);
  EXPECT_EQ(read.lidar->elevations_rad, written.lidar->elevations_rad);
  EXPECT_EQ(read.trust->bootstrap->high, written.trust->bootstrap->high);
  EXPECT_EQ(read.trust->outlier_views, written.trust->outlier_views);
  EXPECT_EQ(read.trust->fit_rmse_px, std::nullopt);
  ASSERT_EQ(read.boards.size(), 2U);
  EXPECT_EQ(read.boards[0].tags[0].rotation_rad, written.boards[0].tags[0].rotation_rad);
  ASSERT_EQ(read.views.size(), 2U);
  EXPECT_EQ(read.views[0].image_time_s, written.views[0].image_time_s);
  EXPECT_EQ(read.views[0].information, written.views[0].information);
  EXPECT_EQ(read.views[0].sigma_so_far, written.views[0].sigma_so_far);
  EXPECT_EQ(read.views[0].boards[0].residuals_px, written.views[0].boards[0].residuals_px);
  EXPECT_EQ(read.views[0].boards[0].cam_from_board->translation,
            written.views[0].boards[0].cam_from_board->translation);
  EXPECT_FALSE(read.views[1].kept);
  EXPECT_EQ(read.views[1].reason, PrintableLine(written.views[1].reason));
}

TEST(CalibrationResult, BothFormsReadBackToTheBit) {
  const CalibrationResult result = test::FullCalibrationResult();
  for (const std::string& text :
       {FormatCalibrationResult(result), FormatCalibrationResultJson(result)}) {
    const Expected<CalibrationResult> read = ParseCalibrationResult(text, "result");
    ASSERT_TRUE(read) << read.error().message << text;
    ExpectSame(*read, result);
    // Values that are not compared above were not lost either.
    EXPECT_EQ(FormatCalibrationResult(*read), FormatCalibrationResult(result));
    EXPECT_EQ(FormatCalibrationResultJson(*read), FormatCalibrationResultJson(result));
  }
}

TEST(CalibrationResult, AMinimalResultReadsBack) {
  CalibrationResult result;
  result.version = "0.1.0";
  result.solver = "kabsch";
  const Expected<CalibrationResult> read =
      ParseCalibrationResult(FormatCalibrationResult(result), "r");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_FALSE(read->covariance || read->camera || read->lidar || read->trust);
  EXPECT_EQ(read->camera_frame, "camera");
}

TEST(CalibrationResult, JsonHasEveryKeyAndIsJson) {
  CalibrationResult least;
  least.views.emplace_back();
  const auto full =
      nlohmann::json::parse(FormatCalibrationResultJson(test::FullCalibrationResult()));
  const auto json = nlohmann::json::parse(FormatCalibrationResultJson(least));
  for (const auto& entry : full.items()) EXPECT_TRUE(json.contains(entry.key())) << entry.key();
  for (const auto& entry : full["views"][0].items()) {
    EXPECT_TRUE(json["views"][0].contains(entry.key())) << entry.key();
  }
  EXPECT_TRUE(json["covariance"].is_null());
  EXPECT_TRUE(full["views"][0]["boards"][0]["residuals_px"][3].is_null());
}

TEST(CalibrationResult, TheHashDistinguishesConfigurations) {
  EXPECT_EQ(ConfigurationHash({}), "cbf29ce484222325");
  EXPECT_NE(ConfigurationHash({"a", "b"}), ConfigurationHash({"ab"}));
  EXPECT_NE(ConfigurationHash({"a", "b"}), ConfigurationHash({"b", "a"}));
  EXPECT_EQ(ConfigurationHash({"solver: joint"}).size(), 16U);
}

class BadResultTest : public testing::TestWithParam<BadText> {};

TEST_P(BadResultTest, EndsInOneLineThatSaysWhereAndWhat) {
  ExpectRefused(ParseCalibrationResult(GetParam().text, "r.yaml"), GetParam());
}

std::string Result(const std::string& rest) {
  return "sextant_result: 1\nsextant: 0.1.0\nsolver: joint\nseed: 1\n"
         "cam_from_lidar: {translation_m: [1, 2, 3], quaternion_wxyz: [1, 0, 0, 0]}\n" +
         rest;
}

using ErrorCode::kParse;

INSTANTIATE_TEST_SUITE_P(
    Inputs, BadResultTest,
    testing::Values(
        BadText{"Empty", "", kParse, "r.yaml:1: the file is empty"},
        BadText{"AnotherKind", "sextant_problem: 1", kParse, "this is a problem file"},
        BadText{"Board", "boards: []", kParse,
                "r.yaml:1: expected result.yaml of sextant calibrate, or its JSON, with the key "
                "sextant_result; this is a board file"},
        BadText{"SomethingElse", "x: 1", kParse, "this is a file that begins with the key 'x'"},
        BadText{"UnknownKey", Result("covarience: []"), kParse,
                "r.yaml:6: sextant_result: unknown key 'covarience'; did you mean 'covariance'?"},
        BadText{"UnknownKeyOfAView", Result("views:\n  - view: 0\n    keept: true"), kParse,
                "r.yaml:8: views: unknown key 'keept'; did you mean 'kept'?"},
        BadText{"NoPose", "sextant_result: 1\nsextant: 0.1.0\nsolver: joint\nseed: 1", kParse,
                "cam_from_lidar: expected this key"},
        BadText{"FiveRows", Result("covariance: [[1,0,0,0,0,0]]"), kParse,
                "r.yaml:6: covariance: expected 6 rows, got 1"},
        BadText{"NotSymmetric",
                Result("covariance: [[1,2,0,0,0,0],[0,1,0,0,0,0],[0,0,1,0,0,0],[0,0,0,1,0,0],"
                       "[0,0,0,0,1,0],[0,0,0,0,0,1]]"),
                kParse, "covariance: expected a symmetric matrix"},
        BadText{"NeitherKeptNorNot", Result("views: [{view: 0, kept: maybe}]"), kParse,
                "kept: expected true or false, got 'maybe'"},
        BadText{"NegativeSeed",
                "sextant_result: 1\nsextant: 0\nsolver: joint\nseed: -1\ncam_from_lidar: {}",
                kParse, "r.yaml:4: seed: expected an integer from 0"},
        BadText{"InconsistentMatrix",
                "sextant_result: 1\nsextant: 0\nsolver: joint\nseed: 1\ncam_from_lidar:\n"
                "  matrix: [[1, 0, 0, 1], [0, 1, 0, 2], [0, 0, 1, 3.1], [0, 0, 0, 1]]\n"
                "  translation_m: [1, 2, 3]\n  quaternion_wxyz: [1, 0, 0, 0]",
                kParse, "r.yaml:6: matrix: expected the pose of translation_m and quaternion_wxyz"},
        BadText{"UnknownVerdict", Result("verdict: {word: FINE}"), kParse,
                "r.yaml:6: word: expected GOOD, USABLE WITH CARE or NOT USABLE, got 'FINE'"},
        BadText{"NotANumber", Result("views: [{view: 0, kept: true, rmse_m: .nan}]"),
                ErrorCode::kNonFinite, "rmse_m: expected a finite number"},
        BadText{"NegativeResidual", Result("views: [{view: 0, kept: true, rmse_m: -1}]"), kParse,
                "rmse_m: expected zero or more"}),
    [](const auto& bad) { return bad.param.name; });

TEST(CalibrationResult, FilesOfTheFirstVersionAreRead) {
  const Expected<CalibrationResult> read = ParseCalibrationResult(
      Result("trust: {folds: 2, covariance_sigma: [1, 2, 3, 4, 5, 6], bootstrap_over_covariance: 2,"
             " jackknife_over_covariance: 3, verdict: They agree.}"),
      "r.yaml");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_FALSE(read->verdict);
  EXPECT_EQ((*read->trust->solver_sigma)[5], 6.0);
  EXPECT_EQ(read->trust->bootstrap_over_solver, 2.0);
  EXPECT_EQ(read->trust->jackknife_over_solver, 3.0);
  EXPECT_EQ(read->trust->comparison, "They agree.");
}

TEST(CalibrationResult, AMatrixAloneIsAPose) {
  const Expected<CalibrationResult> read = ParseCalibrationResult(
      "sextant_result: 1\nsextant: 0\nsolver: joint\nseed: 1\n"
      "cam_from_lidar: {matrix: [[0, -1, 0, 1], [0, 0, -1, 2], [1, 0, 0, 3], [0, 0, 0, 1]]}",
      "r");
  ASSERT_TRUE(read) << read.error().message;
  const Eigen::Vector3d ahead = read->cam_from_lidar * Eigen::Vector3d(2, 0, 0);
  EXPECT_LT((ahead - Eigen::Vector3d(1, 2, 5)).norm(), 1e-14);
}

TEST(CalibrationResult, ReadsFromAFileAndNamesIt) {
  const test::ScratchFolder folder;
  const auto path = folder.path() / "result.yaml";
  ASSERT_TRUE(WriteFileAtomically(path, FormatCalibrationResult(test::FullCalibrationResult())));
  EXPECT_TRUE(ReadCalibrationResult(path));
  const Expected<CalibrationResult> absent = ReadCalibrationResult(folder.path() / "absent.yaml");
  ASSERT_FALSE(absent);
  EXPECT_THAT(absent.error().message, HasSubstr("absent.yaml"));
}

}  // namespace
}  // namespace sextant
