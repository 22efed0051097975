// SPDX-License-Identifier: Apache-2.0
// Data from the field that one change of all numbers explains: the diagnostics name it, and say
// nothing of data that is as it should be.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "eval/diagnostics/outlying_pairs.h"
#include "eval/diagnostics/pair_diagnostics.h"
#include "eval/diagnostics/repeated_pairs.h"
#include "io/cameras/camera_file.h"
#include "io/problems/read_problem.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "support/real_data.h"

namespace sextant {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

CalibrationProblem Read(const std::filesystem::path& file, const char* camera = nullptr) {
  CalibrationProblem problem = ReadProblem(file).value().problem;
  if (camera != nullptr) problem.camera = ReadCamera(file.parent_path() / camera).value();
  return problem;
}

std::vector<std::string> CausesIn(const std::filesystem::path& file, const char* camera = nullptr) {
  return DiagnosePairs(Read(file, camera)).causes;
}

TEST(JudgedData, UnitsAndRolesOfPoints) {
  SEXTANT_REAL_DATA(good, "../cases/units_and_roles/v_good.csv");
  const auto causes = [&](const char* name) { return CausesIn(good.parent_path() / name); };
  EXPECT_THAT(causes("v_good.csv"), IsEmpty());
  EXPECT_THAT(causes("v_duplicates_unique.csv"), IsEmpty());
  EXPECT_THAT(causes("v_lidar_mm.csv"),
              ElementsAre(AllOf(HasSubstr("millimetres"), HasSubstr("LiDAR's points by 0.001"))));
  EXPECT_THAT(causes("v_cam_cm.csv"),
              ElementsAre(AllOf(HasSubstr("centimetres"), HasSubstr("camera's points by 0.01"))));
  EXPECT_THAT(causes("v_feet.csv"),
              ElementsAre(AllOf(HasSubstr("feet"), HasSubstr("LiDAR's points by 0.3048"))));
  EXPECT_THAT(causes("v_scale_1p05.csv"),
              ElementsAre(HasSubstr("camera's lengths are 1.05 times")));
  EXPECT_THAT(causes("v_both_mm.csv"), ElementsAre(HasSubstr("multiply all of them by 0.001")));
  EXPECT_THAT(causes("v_swapped_roles.csv"), ElementsAre(HasSubstr("seem to be exchanged")));
  EXPECT_THAT(causes("v_mirror_y.csv"), ElementsAre(StartsWith("mirrored")));
  EXPECT_THAT(causes("v_both_utm.csv"), ElementsAre(StartsWith("frame")));
}

TEST(JudgedData, UnitsAndRolesOfPointsTxt) {
  SEXTANT_REAL_DATA(good, "../cases/points_txt_variants/good.txt");
  const auto causes = [&](const char* name) { return CausesIn(good.parent_path() / name); };
  for (const char* name : {"good.txt", "one_board.txt", "one_bad_corner.txt", "utm_lidar.txt"}) {
    EXPECT_THAT(causes(name), IsEmpty()) << name;
  }
  EXPECT_THAT(causes("lidar_mm.txt"), ElementsAre(HasSubstr("millimetres")));
  EXPECT_THAT(causes("both_mm.txt"), ElementsAre(HasSubstr("millimetres")));
  EXPECT_THAT(causes("lidar_ft.txt"), ElementsAre(HasSubstr("feet")));
  EXPECT_THAT(causes("scale_1p03.txt"), ElementsAre(HasSubstr("camera's lengths are 1.029 times")));
  EXPECT_THAT(causes("camera_first.txt"), ElementsAre(HasSubstr("seem to be exchanged")));
  // A far origin of the LiDAR is no sensor that faces the camera.
  EXPECT_FALSE(DiagnosePairs(Read(good.parent_path() / "utm_lidar.txt")).order.faces_as_given);
}

TEST(JudgedData, FaultsOfPixels) {
  SEXTANT_REAL_DATA(plain, "../cases/wrong_data/plain.csv");
  const auto causes = [&](const char* name) {
    return CausesIn(plain.parent_path() / name, "plain.yaml");
  };
  for (const char* name : {"plain.csv", "v_utm.csv", "v_dups_unique.csv", "v_shuffled.csv"}) {
    EXPECT_THAT(causes(name), IsEmpty()) << name;
  }
  EXPECT_THAT(causes("v_normalised.csv"), ElementsAre(HasSubstr("already normalised")));
  EXPECT_THAT(causes("v_half_res.csv"), ElementsAre(HasSubstr("(640 x 360 px)")));
  EXPECT_THAT(causes("v_swapped_uv.csv"),
              testing::Contains(HasSubstr("seems that u and v are exchanged")));
  EXPECT_THAT(causes("v_u_from_right.csv"), ElementsAre(HasSubstr("u is counted from the right")));
  EXPECT_THAT(causes("v_v_from_bottom.csv"), ElementsAre(HasSubstr("v is counted from below")));
  EXPECT_THAT(causes("v_lidar_ydown_mirror.csv"), ElementsAre(HasSubstr("points are mirrored")));
  EXPECT_THAT(causes("v_mm.csv"), ElementsAre(HasSubstr("0.0489 -0.1195 -0.0798 m")));
}

TEST(JudgedData, ImplausibleCameras) {
  SEXTANT_REAL_DATA(wide, "../cases/wrong_focal_length/pairs_m.csv");
  EXPECT_THAT(CausesIn(wide, "camera.yaml"),
              ElementsAre(HasSubstr("field of view of 168 deg"),
                          HasSubstr("focal length is about 946.8 px instead of 119.4 px")));
  SEXTANT_REAL_DATA(tiny, "../cases/tiny_focal_length/pairs.csv");
  EXPECT_THAT(CausesIn(tiny, "camera.yaml"),
              ElementsAre(HasSubstr("a focal length of 8.5 is not one in pixels")));
}

TEST(JudgedData, OrdinaryCasesHaveNoCause) {
  SEXTANT_REAL_DATA(boards, "../cases/boards_12_pairs/pairs.csv");
  const auto cases = boards.parent_path().parent_path();
  for (const auto& [file, camera] : std::vector<std::pair<const char*, const char*>>{
           {"boards_12_pairs/pairs.csv", "camera.yaml"},
           {"bad_line_92_pairs/pairs.csv", "camera.yaml"},
           {"three_outliers_104_pairs/pairs.csv", "camera_ros.yaml"},
           {"two_markers_two_poses/pairs.csv", "camera.yaml"},
           {"flat_marker_two_poses/frame_a_m.csv", "camera.yaml"},
           {"long_lens_three_points/pairs6_noise03.csv", "camera.yaml"},
           {"rational_pole/pairs_border.csv", "camera.yaml"},
           {"utm_control_points/pairs_minus_offset.csv", "camera.yaml"},
           {"far_origin/offset_1e+07.csv", "camera.yaml"},
           {"no_information/pairs.csv", "camera_f600.yaml"}}) {
    EXPECT_THAT(CausesIn(cases / file, camera), IsEmpty()) << file;
  }
}

std::vector<std::string> OutliersOf(CalibrationProblem problem) {
  const std::vector<RepeatedPairs> repeated = MergeRepeatedPairs(problem);
  const auto report = BuiltinSolvers().Make("refine(sqpnp)").value()->Solve(problem);
  return DescribeOutliers(report.value(), repeated);
}

TEST(JudgedData, OutliersAreNamedByRow) {
  SEXTANT_REAL_DATA(lines, "../cases/bad_line_92_pairs/pairs.csv");
  EXPECT_THAT(OutliersOf(Read(lines, "camera.yaml")),
              ElementsAre(AllOf(HasSubstr("1 of 91 pairs"), HasSubstr("pair 82 (184 px)"))));
  const auto cases = lines.parent_path().parent_path();
  EXPECT_THAT(OutliersOf(Read(cases / "three_outliers_104_pairs/pairs.csv", "camera_ros.yaml")),
              ElementsAre(AllOf(HasSubstr("3 of 104 pairs"), HasSubstr("pair 20 "),
                                HasSubstr("pair 87 "), HasSubstr("pair 96 "))));
  EXPECT_THAT(OutliersOf(Read(cases / "boards_12_pairs/pairs.csv", "camera.yaml")), IsEmpty());
  EXPECT_THAT(OutliersOf(Read(cases / "rational_pole/pairs_border.csv", "camera.yaml")), IsEmpty());
}

}  // namespace
}  // namespace sextant
