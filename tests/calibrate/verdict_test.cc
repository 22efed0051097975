// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/verdict.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <limits>
#include <string>

#include "base/units.h"

namespace sextant {
namespace {

using testing::HasSubstr;

// Ten views without any fault.
VerdictFigures Healthy() {
  VerdictFigures figures;
  figures.views_with_board = 10;
  figures.views_used = 10;
  figures.independent_views = 10;
  figures.is_checked = true;
  figures.worst_translation_m = 0.004;
  figures.worst_rotation_rad = 0.05 * kRadPerDeg;
  figures.spread_over_solver = 1.1;
  figures.held_out_over_fit = 1.2;
  figures.corner_rms_m = 0.01;
  figures.range_excess = 0.002;
  figures.range_excess_sigma = 0.002;
  figures.normals_off_rad = 0.8 * kRadPerDeg;
  figures.print_rms_px = 0.3;
  figures.print_over_noise = 1.2;
  return figures;
}

struct VerdictCase {
  std::string name;
  std::function<void(VerdictFigures&)> change;
  Usability expected;
  std::string reason;
};

class VerdictTable : public testing::TestWithParam<VerdictCase> {};

TEST_P(VerdictTable, IsAsDocumented) {
  VerdictFigures figures = Healthy();
  GetParam().change(figures);
  const ResultVerdict verdict = JudgeResult(figures);
  EXPECT_EQ(verdict.usability, GetParam().expected) << verdict.reason;
  EXPECT_THAT(verdict.reason, HasSubstr(GetParam().reason));
  EXPECT_NE(verdict.next, "");
}

constexpr Usability kGood = Usability::kGood;
constexpr Usability kCare = Usability::kUsableWithCare;
constexpr Usability kNo = Usability::kNotUsable;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
using F = VerdictFigures;

INSTANTIATE_TEST_SUITE_P(
    Rules, VerdictTable,
    testing::Values(
        VerdictCase{"Healthy", [](F&) {}, kGood, "10 of 10 views agree"},
        VerdictCase{"Rivals", [](F& f) { f.rival_poses = 1; }, kNo, "1 other pose explains"},
        VerdictCase{"RivalsThatAreUpsideDown",
                    [](F& f) {
                      f.rival_poses = 1;
                      f.rival_margin_rad = 3.0;
                    },
                    kCare, "upright camera"},
        VerdictCase{"RivalsWithARoughPose",
                    [](F& f) {
                      f.rival_poses = 3;
                      f.has_rough_pose = true;
                      f.rival_margin_rad = 1.5;
                    },
                    kCare, "3 other poses explain"},
        VerdictCase{"FewUnused", [](F& f) { f.views_used = 8; }, kGood, "8 of 10"},
        VerdictCase{"SomeUnused", [](F& f) { f.views_used = 7; }, kCare, "Only 7 of the 10"},
        VerdictCase{"MostUnused", [](F& f) { f.views_used = 4; }, kNo, "Only 4 of the 10"},
        VerdictCase{"SomeContradict",
                    [](F& f) {
                      f.views_used = 8;
                      f.views_contradicting = 2;
                    },
                    kCare, "In 2 of 10 views the photo and the scan contradict"},
        VerdictCase{"ManyContradict",
                    [](F& f) {
                      f.views_used = 6;
                      f.views_contradicting = 4;
                    },
                    kNo, "In 4 of 10"},
        VerdictCase{"Outliers", [](F& f) { f.outlier_views = 2; }, kCare, "2 of 10 used views"},
        VerdictCase{"SpreadWithinSampling", [](F& f) { f.spread_over_solver = 2.5; }, kGood, ""},
        VerdictCase{"Spread", [](F& f) { f.spread_over_solver = 5.0; }, kCare, "5.0 times"},
        VerdictCase{"WildSpread", [](F& f) { f.spread_over_solver = 30.0; }, kNo, "30.0 times"},
        VerdictCase{"HeldOut", [](F& f) { f.held_out_over_fit = 2.5; }, kCare, "2.5 times worse"},
        VerdictCase{"HalvesWithinNoise", [](F& f) { f.halves_off = 2.8; }, kGood, ""},
        VerdictCase{"HalvesDiffer", [](F& f) { f.halves_off = 4.0; }, kCare, "different poses"},
        VerdictCase{"Moved", [](F& f) { f.halves_off = 8.0; }, kNo, "by 8 sigma"},
        VerdictCase{"RangesWithinNoise",
                    [](F& f) {
                      f.range_excess = 0.012;
                      f.range_excess_sigma = 0.006;
                    },
                    kGood, ""},
        VerdictCase{"RangesUnclear",
                    [](F& f) {
                      f.range_excess = 0.03;
                      f.range_excess_sigma = 0.012;
                    },
                    kCare, "may be 3.0 percent farther away"},
        VerdictCase{"RangesLong", [](F& f) { f.range_excess = 0.01; }, kCare,
                    "Boards are 1.0 percent farther away in the images"},
        VerdictCase{"RangesShort", [](F& f) { f.range_excess = -0.02; }, kNo, "2.0 percent nearer"},
        VerdictCase{"Size", [](F& f) { f.size_excess = -0.02; }, kCare, "2.0 percent smaller"},
        VerdictCase{"OtherSize", [](F& f) { f.size_excess = 0.1; }, kNo, "10.0 percent larger"},
        VerdictCase{"Normals", [](F& f) { f.normals_off_rad = 0.06; }, kCare, "3.4 deg"},
        VerdictCase{"PrintOffByNoise", [](F& f) { f.print_rms_px = 2.0; }, kGood, ""},
        VerdictCase{"Lens",
                    [](F& f) {
                      f.print_rms_px = 2.0;
                      f.print_over_noise = 8.0;
                    },
                    kCare, "2.0 px, 8 times"},
        VerdictCase{"Corners", [](F& f) { f.corner_rms_m = 0.2; }, kNo, "200 mm apart"},
        VerdictCase{"NotFinite", [](F& f) { f.corner_rms_m = kNan; }, kNo, "apart"},
        VerdictCase{"OneView",
                    [](F& f) {
                      f.views_with_board = f.views_used = f.independent_views = 1;
                      f.held_out_over_fit.reset();
                    },
                    kCare, "One view only"},
        VerdictCase{"ThreeViews", [](F& f) { f.independent_views = 3; }, kCare, "3 views"},
        VerdictCase{"NotChecked", [](F& f) { f.is_checked = false; }, kCare, "not compared"},
        VerdictCase{"Coarse", [](F& f) { f.worst_translation_m = 0.02; }, kCare,
                    "20 mm and 0.05 deg, and 10 mm and 0.1 deg are needed"},
        VerdictCase{"Useless", [](F& f) { f.worst_rotation_rad = 0.05; }, kNo, "2.86 deg"},
        VerdictCase{"Uncertain", [](F& f) { f.worst_translation_m.reset(); }, kNo,
                    "cannot be computed"},
        VerdictCase{"TheWorstRuleDecides",
                    [](F& f) {
                      f.independent_views = 3;
                      f.range_excess = 0.03;
                    },
                    kNo, "3.0 percent farther"}),
    [](const auto& one) { return one.param.name; });

TEST(Verdict, FollowsTheNeed) {
  const VerdictFigures figures = Healthy();
  EXPECT_EQ(JudgeResult(figures, {.translation_m = 0.003}).usability, kCare);
  EXPECT_EQ(JudgeResult(figures, {.translation_m = 0.0003}).usability, kNo);
  EXPECT_EQ(JudgeResult(figures, {.rotation_rad = 0.02 * kRadPerDeg}).usability, kCare);
}

}  // namespace
}  // namespace sextant
