// SPDX-License-Identifier: Apache-2.0
// Pairs in a wrong order, repeated or contradictory, as people sent them.
#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "base/random.h"
#include "e2e/run_sextant.h"
#include "geometry/rigid3d.h"
#include "geometry/so3.h"
#include "support/real_data.h"
#include "support/run_program.h"

namespace sextant::test {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr int kNotUsable = 3;

std::string Solve(const std::filesystem::path& file, const std::string& options,
                  int exit_code = 0) {
  const ProgramRun run = RunSextant("solve " + file.string() + " " + options);
  EXPECT_EQ(run.exit_code, exit_code) << run.err;
  EXPECT_EQ(run.out.starts_with("NOT USABLE: "), exit_code == kNotUsable);
  return run.out;
}

TEST(OrderCases, ElevenPointsInAWrongOrder) {
  SEXTANT_REAL_DATA(pairs, "../cases/eleven_in_wrong_order/pairs.csv");
  EXPECT_THAT(Solve(pairs, "--solver kabsch", kNotUsable), HasSubstr("[0,6,8,2,9,4,5,7,10,3,1]"));
  EXPECT_THAT(Solve(pairs, "--solver kabsch --reorder"), HasSubstr("order above was taken"));
}

TEST(OrderCases, BoardsThatContradictEachOtherInTheBestOrder) {
  SEXTANT_REAL_DATA(points, "../cases/rival_orders/points.txt");
  const std::string text = Solve(points, "--solver kabsch --reorder");
  EXPECT_THAT(text, HasSubstr("[3,2,1,0,5,6,7,4]"));
  EXPECT_THAT(text, HasSubstr("contradiction: the boards fit"));
}

TEST(OrderCases, RowsOfABoardMirrored) {
  SEXTANT_REAL_DATA(pairs, "../cases/mirrored_rows/pairs.csv");
  const std::string camera = " --camera " + (pairs.parent_path() / "camera.yaml").string();
  const std::string text = Solve(pairs, "--solver 'refine(sqpnp)' --reorder" + camera, kNotUsable);
  EXPECT_THAT(text, HasSubstr("facing each other"));
  EXPECT_THAT(text, HasSubstr("3.192 px"));
}

TEST(OrderCases, ABoardWhoseCornersRunTheOtherWay) {
  SEXTANT_REAL_DATA(points, "../cases/points_txt_variants/one_board_reversed.txt");
  EXPECT_THAT(Solve(points, "--solver kabsch", kNotUsable), HasSubstr("facing each other"));
  const auto good = points.parent_path() / "good.txt";
  EXPECT_THAT(Solve(good, "--solver kabsch"), Not(HasSubstr("facing each other")));
  EXPECT_THAT(Solve(good, "--solver kabsch --reorder"),
              HasSubstr("--reorder keeps the given order"));
}

TEST(OrderCases, TooManyPointsWithoutBoardsAreSaid) {
  SEXTANT_REAL_DATA(pairs, "../cases/bad_line_92_pairs/pairs.csv");
  const std::string camera = " --camera " + (pairs.parent_path() / "camera.yaml").string();
  const std::string text = Unbroken(Solve(pairs, "--solver 'refine(sqpnp)' --reorder" + camera));
  EXPECT_THAT(text, HasSubstr("at most 12 are examined"));
  EXPECT_THAT(text, HasSubstr("have the same LiDAR point"));
}

// The text of an answer from its pose on, without the name of the file.
std::string Sigmas(const std::string& text) {
  const std::size_t begin = text.find("sigma");
  return begin == std::string::npos ? text : text.substr(begin, 120);
}

TEST(OrderCases, DataThatIsNotWhatItSeemsIsNotUsable) {
  SEXTANT_REAL_DATA(wide, "../cases/wrong_focal_length/pairs_m.csv");
  const std::string camera = " --camera " + (wide.parent_path() / "camera.yaml").string();
  for (const char* spec : {"'refine(sqpnp)'", "'ransac(p3p)'", "'refine(ransac(p3p))'"}) {
    EXPECT_THAT(Solve(wide, std::string("--solver ") + spec + camera, kNotUsable),
                HasSubstr("focal length is about 946.8 px"));
  }
  const auto units = wide.parent_path().parent_path() / "units_and_roles";
  Solve(units / "v_good.csv", "");
  for (const char* file : {"v_lidar_mm.csv", "v_feet.csv", "v_swapped_roles.csv"}) {
    Solve(units / file, "", kNotUsable);
  }
}

TEST(OrderCases, RepeatedPairsDoNotLowerTheSigma) {
  SEXTANT_REAL_DATA(repeated, "../cases/units_and_roles/v_duplicates.csv");
  const auto unique = repeated.parent_path() / "v_duplicates_unique.csv";
  const std::string text = Solve(repeated, "--solver kabsch");
  EXPECT_THAT(text, HasSubstr("6 pairs repeat others"));
  EXPECT_EQ(Sigmas(text), Sigmas(Solve(unique, "--solver kabsch")));
}

// Pairs in no particular place, as CSV without ids, of which two rows are exchanged.
std::string PairsWithTwoRowsExchanged() {
  Random random(5);
  const Rigid3d cam_from_lidar{ExpSo3({0.3, -1.2, 0.4}), {0.1, -0.2, 0.3}};
  std::vector<Eigen::Vector3d> in_cam;
  std::vector<Eigen::Vector3d> in_lidar;
  for (int i = 0; i < 12; ++i) {
    const double x = random.Uniform(-2.0, 2.0);
    const double y = random.Uniform(-1.0, 1.0);
    const double z = random.Uniform(3.0, 7.0);
    in_cam.emplace_back(x, y, z);
    in_lidar.push_back(cam_from_lidar.Inverse() * in_cam.back());
    in_lidar.back().x() += 0.01 * random.Normal();
    in_lidar.back().y() += 0.01 * random.Normal();
  }
  std::swap(in_lidar[3], in_lidar[7]);
  std::string text = "camx,camy,camz,lidarx,lidary,lidarz\n";
  for (std::size_t i = 0; i < in_cam.size(); ++i) {
    const Eigen::Vector3d& c = in_cam[i];
    const Eigen::Vector3d& l = in_lidar[i];
    text += fmt::format("{},{},{},{},{},{}\n", c.x(), c.y(), c.z(), l.x(), l.y(), l.z());
  }
  return text;
}

// A robust answer leaves both out, so that it is as good as that of the right order.
TEST(OrderCases, TwoRowsThatAreExchangedAreNamedAndLeftOut) {
  const std::string file = TestPath("pairs.csv");
  WriteText(file, PairsWithTwoRowsExchanged());
  const std::string text = Unbroken(Solve(file, ""));
  EXPECT_THAT(text, HasSubstr("pairs 4 and 8 are exchanged"));
  EXPECT_THAT(text, HasSubstr("outliers: 2 of 12 pairs"));
  EXPECT_THAT(Solve(file, "--reorder"), HasSubstr("12 of 12 pairs"));
  EXPECT_THAT(Unbroken(Solve(file, "--solver kabsch", kNotUsable)),
              HasSubstr("pairs 4 and 8 are exchanged"));
}

}  // namespace
}  // namespace sextant::test
