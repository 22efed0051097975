// SPDX-License-Identifier: Apache-2.0
// `sextant print-board`: `sextant detect` finds the printed board, at true scale.
#include <gmock/gmock.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "e2e/run_sextant.h"
#include "support/run_program.h"

namespace sextant {
namespace {

using nlohmann::json;
using test::ProgramRun;
using test::ReadText;
using test::TestFolder;
using test::WriteText;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kHollow =
    "id: 4\nname: target\ntop_right_m: 0.3\nright_bottom_m: 0.25\n"
    "hole: {width_m: 0.08, height_m: 0.06}\n"
    "tags:\n"
    "  - {family: tag36h11, id: 7, edge_m: 0.05, center_in_board_m: [-0.1, -0.07]}\n"
    "  - {family: aruco_5x5_100, id: 9, edge_m: 0.06, center_in_board_m: [0.1, 0.07], "
    "rotation_deg: 90}\n";

ProgramRun Print(const std::string& yaml, const std::string& out, const std::string& more = "") {
  const auto path = TestFolder() / "board.yaml";
  WriteText(path, yaml);
  return test::RunSextant("print-board " + path.string() + " --out " +
                          (TestFolder() / out).string() + " " + more);
}

json DetectBoard(const std::string& image) {
  const ProgramRun run =
      test::RunSextant("detect " + (TestFolder() / image).string() + " --board " +
                       (TestFolder() / "board.yaml").string() + " --json -");
  EXPECT_EQ(run.exit_code, 0) << run.err;
  return json::parse(run.out).at("images").at(0).at("boards").at(0);
}

TEST(PrintBoard, PictureIsFoundAgainAtTrueScale) {
  constexpr double kDpi = 120.0;
  const ProgramRun run = Print(kHollow, "target.png", "--dpi 120");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json board = DetectBoard("target.png");
  ASSERT_EQ(board.at("tags").size(), 2U);
  const auto pixel_of = [&](double x_m, double y_m) {
    constexpr double kBorder_m = 0.02;
    return std::pair((x_m + 0.15 + kBorder_m) * kDpi / 0.0254 - 0.5,
                     (y_m + 0.125 + kBorder_m) * kDpi / 0.0254 - 0.5);
  };
  // The first tag's own top-left, and the second's, which is turned to the board's top-right.
  const std::pair<double, double> expected[] = {pixel_of(-0.125, -0.095), pixel_of(0.13, 0.04)};
  for (std::size_t i = 0; i < 2; ++i) {
    const json& corner = board.at("tags").at(i).at("corners_px").at(0);
    EXPECT_NEAR(corner.at(0).get<double>(), expected[i].first, 0.1) << i;
    EXPECT_NEAR(corner.at(1).get<double>(), expected[i].second, 0.1) << i;
  }
}

TEST(PrintBoard, CheckerboardIsFoundAgain) {
  const ProgramRun run = Print(
      "id: 0\ntop_right_m: 0.3\nright_bottom_m: 0.3\n"
      "checker: {inner_columns: 5, inner_rows: 4, square_m: 0.03}\n",
      "target.png", "--dpi 100");
  ASSERT_EQ(run.exit_code, 0) << run.err;
  const json corners = DetectBoard("target.png").at("checker_px");
  ASSERT_EQ(corners.size(), 20U);
  // Inner corner (0, 0) is two squares from the middle in x and one and a half in y.
  EXPECT_NEAR(corners.at(0).at(0).get<double>(), (0.17 - 0.06) * 100.0 / 0.0254 - 0.5, 0.1);
  EXPECT_NEAR(corners.at(0).at(1).get<double>(), (0.17 - 0.045) * 100.0 / 0.0254 - 0.5, 0.1);
}

TEST(PrintBoard, PagesHaveTheBoardsSizeAndName) {
  ASSERT_EQ(Print(kHollow, "target.svg").exit_code, 0);
  const std::string svg = ReadText(TestFolder() / "target.svg");
  std::smatch match;
  ASSERT_TRUE(std::regex_search(svg, match, std::regex("width=\"([0-9.]+)(pt)?\"")));
  EXPECT_NEAR(std::stod(match[1]), 0.34 * 72.0 / 0.0254, 0.1);
  const ProgramRun run = Print(kHollow, "target.pdf");
  ASSERT_EQ(run.exit_code, 0);
  EXPECT_THAT(test::Unbroken(run.out),
              AllOf(HasSubstr("target.pdf: board 4 of 300 x 250 mm on a page of 340 x 290 mm with "
                              "a ruler of 100 mm"),
                    HasSubstr("Print at 100 %")));
  const std::string pdf = ReadText(TestFolder() / "target.pdf");
  EXPECT_THAT(pdf, StartsWith("%PDF"));
  ASSERT_TRUE(std::regex_search(pdf, match, std::regex("MediaBox \\[ 0 0 ([0-9.]+) ([0-9.]+)")));
  EXPECT_NEAR(std::stod(match[1]), 0.34 * 72.0 / 0.0254, 0.1);
  EXPECT_NEAR(std::stod(match[2]), 0.29 * 72.0 / 0.0254, 0.1);
  ASSERT_EQ(Print(kHollow, "again.pdf").exit_code, 0);
  EXPECT_EQ(pdf, ReadText(TestFolder() / "again.pdf"));
}

TEST(PrintBoard, RefusesWhatItCannotPrint) {
  const std::string two =
      "boards:\n  - {id: 0, top_right_m: 0.2, right_bottom_m: 0.2}\n"
      "  - {id: 1, top_right_m: 0.2, right_bottom_m: 0.2}\n";
  EXPECT_THAT(test::Unbroken(Print(two, "two.pdf").out),
              AllOf(HasSubstr("board 0 of 200 x 200 mm"), HasSubstr(", board 1 of 200 x 200 mm")));
  EXPECT_THAT(Print(two, "two.yaml").out, HasSubstr("two.yaml: the board file"));
  const ProgramRun several = Print(two, "two.png");
  EXPECT_EQ(several.exit_code, 2);
  EXPECT_THAT(several.err, HasSubstr("--id"));
  EXPECT_EQ(Print(two, "two.png", "--id 1").exit_code, 0);
  EXPECT_EQ(Print(two, "two.png", "--id 5").exit_code, 2);
  EXPECT_EQ(Print(kHollow, "target.bmp").exit_code, 2);
  EXPECT_THAT(Print("id: 0\ntop_right_m: 9\nright_bottom_m: 9\n", "huge.png").err,
              HasSubstr("lower --dpi"));
  EXPECT_EQ(Print("id: 0\ntop_right_m: 0\nright_bottom_m: 1\n", "zero.pdf").exit_code, 2);
  const ProgramRun absent = test::RunSextant("print-board --template fast_calib --id 99 --out " +
                                             test::TestPath("absent.pdf"));
  EXPECT_EQ(absent.exit_code, 2);
  EXPECT_THAT(absent.err, HasSubstr("--id: fast_calib has no board 99"));
}

}  // namespace
}  // namespace sextant
