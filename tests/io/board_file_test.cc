// SPDX-License-Identifier: Apache-2.0
#include "io/boards/board_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numbers>

#include "geometry/board_check.h"
#include "io/boards/board_templates.h"
#include "support/bad_text.h"
#include "support/real_data.h"

namespace sextant {
namespace {

using test::BadText;
using testing::HasSubstr;

using ErrorCode::kParse;

constexpr const char* kHollow = R"(boards:
  - id: 3
    name: hollow
    top_right_m: 0.6
    right_bottom_m: 0.8
    thickness_m: 0.005
    hole: {width_m: 0.3, height_m: 0.4, center_in_board_m: [0.1, 0]}
    tags:
      - {family: tag36h11, id: 7, edge_m: 0.1, center_in_board_m: [-0.2, 0.3], rotation_deg: 90}
      - {family: aruco_original, id: 7, edge_m: 0.1, center_in_board_m: [-0.2, -0.3]}
  - {id: 4, top_right_m: 0.85, right_bottom_m: 0.61,
     checker: {inner_columns: 7, inner_rows: 5, square_m: 0.095}}
)";

TEST(BoardFile, ReadsEveryField) {
  const Expected<std::vector<Board>> boards = ParseBoards(kHollow, "b.yaml");
  ASSERT_TRUE(boards) << boards.error().message;
  ASSERT_EQ(boards->size(), 2U);
  const Board& board = boards->front();
  EXPECT_EQ(board.id, 3);
  EXPECT_EQ(board.name, "hollow");
  EXPECT_EQ(board.top_right_m, 0.6);
  EXPECT_EQ(board.right_bottom_m, 0.8);
  EXPECT_EQ(board.thickness_m, 0.005);
  ASSERT_TRUE(board.hole);
  EXPECT_EQ(board.hole->width_m, 0.3);
  EXPECT_EQ(board.hole->height_m, 0.4);
  EXPECT_EQ(board.hole->center_in_board_m, Eigen::Vector2d(0.1, 0.0));
  ASSERT_EQ(board.tags.size(), 2U);
  EXPECT_EQ(board.tags[0].family, "tag36h11");
  EXPECT_EQ(board.tags[0].id, 7);
  EXPECT_EQ(board.tags[0].edge_m, 0.1);
  EXPECT_EQ(board.tags[0].center_in_board_m, Eigen::Vector2d(-0.2, 0.3));
  EXPECT_EQ(board.tags[0].rotation_rad, 0.5 * std::numbers::pi);
  EXPECT_EQ(board.tags[1].rotation_rad, 0.0);
  ASSERT_TRUE(boards->back().checker);
  EXPECT_EQ(boards->back().checker->inner_columns, 7);
  EXPECT_EQ(boards->back().checker->inner_rows, 5);
  EXPECT_EQ(boards->back().checker->square_m, 0.095);
}

constexpr const char* kRoundHoles = R"(id: 0
top_right_m: 1.4
right_bottom_m: 1.0
round_holes:
  - {radius_m: 0.12, center_in_board_m: [-0.25, -0.2]}
  - {radius_m: 0.1, center_in_board_m: [0.25, 0.2]}
tags:
  - {family: aruco_4x4_50, id: 0, edge_m: 0.2, center_in_board_m: [-0.55, -0.35]}
)";

TEST(BoardFile, ReadsRoundHoles) {
  const auto boards = ParseBoards(kRoundHoles, "b.yaml");
  ASSERT_TRUE(boards) << boards.error().message;
  const Board& board = boards->front();
  ASSERT_EQ(board.round_holes.size(), 2U);
  EXPECT_EQ(board.round_holes[0].radius_m, 0.12);
  EXPECT_EQ(board.round_holes[1].center_in_board_m, Eigen::Vector2d(0.25, 0.2));
  EXPECT_TRUE(board.HasSide(kFirstRim + 1));
  EXPECT_FALSE(board.HasSide(kFirstRim + 2));
  const std::string text = FormatBoards(*boards);
  EXPECT_EQ(FormatBoards(*ParseBoards(text, "again.yaml")), text);
}

TEST(BoardFile, RefusesRoundHolesOffTheBoardAndOverPrints) {
  const auto error = [](const std::string& hole) {
    const auto boards =
        ParseBoards("id: 0\ntop_right_m: 1\nright_bottom_m: 1\nround_holes:\n  - " + hole +
                        "\n  - {radius_m: 0.1, center_in_board_m: [0.3, 0.3]}\n"
                        "tags:\n  - {family: tag36h11, id: 1, edge_m: 0.2}\n",
                    "b.yaml");
    return boards ? std::string() : boards.error().message;
  };
  EXPECT_EQ(error("{radius_m: 0.1, center_in_board_m: [-0.3, -0.3]}"), "");
  EXPECT_THAT(error("{radius_m: 0, center_in_board_m: [-0.3, -0.3]}"),
              HasSubstr("b.yaml:5: round_holes 0: radius_m: expected more than zero"));
  EXPECT_THAT(error("{radius_m: 0.1, center_in_board_m: [-0.45, 0]}"), HasSubstr("lie within"));
  EXPECT_THAT(error("{radius_m: 0.1, center_in_board_m: [0.3, 0.15]}"),
              HasSubstr("overlaps the round hole 0"));
  EXPECT_THAT(error("{radius_m: 0.15, center_in_board_m: [-0.15, 0.15]}"),
              HasSubstr("reaches into a round hole"));
}

TEST(BoardFile, ReadsAnAprilGridInItsOwnAndInKalibrsForm) {
  const auto kalibr = ParseBoards(
      "target_type: 'aprilgrid' #gridtype\ntagCols: 6\ntagRows: 5\ntagSize: 0.088\n"
      "tagSpacing: 0.3\n",
      "april.yaml");
  ASSERT_TRUE(kalibr) << kalibr.error().message;
  const auto own = ParseBoards(
      "id: 0\ntop_right_m: 0.8\nright_bottom_m: 0.7\naprilgrid: {columns: 6, rows: 5, tag_m: "
      "0.088, spacing: 0.3}\n",
      "own.yaml");
  ASSERT_TRUE(own) << own.error().message;
  const Board& board = kalibr->front();
  EXPECT_NEAR(board.top_right_m, 6 * 0.1144 + 0.0264, 1e-12);
  EXPECT_NEAR(board.right_bottom_m, 5 * 0.1144 + 0.0264, 1e-12);
  ASSERT_EQ(board.tags.size(), 30U);
  ASSERT_EQ(own->front().tags.size(), 30U);
  for (std::size_t i = 0; i < board.tags.size(); ++i) {
    EXPECT_EQ(board.tags[i].id, static_cast<int>(i));
    EXPECT_EQ(board.tags[i].family, "aruco_tag36h11_border2");
    EXPECT_EQ(board.tags[i].center_in_board_m, own->front().tags[i].center_in_board_m);
  }
  // Tag 0 is at the bottom left, tag 29 at the top right.
  EXPECT_NEAR(board.tags[0].center_in_board_m.x(), -0.286, 1e-12);
  EXPECT_NEAR(board.tags[0].center_in_board_m.y(), 0.2288, 1e-12);
  EXPECT_NEAR(board.tags[29].center_in_board_m.x(), 0.286, 1e-12);
  EXPECT_NEAR(board.tags[29].center_in_board_m.y(), -0.2288, 1e-12);
}

TEST(BoardFile, TakesThePlatesSizeInKalibrsForm) {
  const auto boards = ParseBoards(
      "target_type: checkerboard\ntargetCols: 6\ntargetRows: 7\nrowSpacingMeters: 0.06\n"
      "colSpacingMeters: 0.06\ntop_right_m: 0.5\nright_bottom_m: 0.6\n",
      "checker.yaml");
  ASSERT_TRUE(boards) << boards.error().message;
  EXPECT_EQ(boards->front().top_right_m, 0.5);
  EXPECT_EQ(boards->front().checker->inner_rows, 7);
  EXPECT_THAT(ParseBoards("target_type: circlegrid\n", "c.yaml").error().message,
              HasSubstr("c.yaml:1: target_type: expected aprilgrid or checkerboard"));
}

TEST(BoardFile, ReadsACharucoBoard) {
  const auto text = [](int rows, const char* more) {
    return "id: 0\ntop_right_m: 0.4\nright_bottom_m: 0.5\ncharuco: {columns: 5, rows: " +
           std::to_string(rows) + ", square_m: 0.04, marker_m: 0.03, family: aruco_6x6_250" + more +
           "}\n";
  };
  const auto boards = ParseBoards(text(7, ""), "b.yaml");
  ASSERT_TRUE(boards) << boards.error().message;
  const Board& board = boards->front();
  ASSERT_TRUE(board.checker);
  EXPECT_TRUE(board.checker->holds_tags);
  EXPECT_FALSE(board.checker->starts_white);
  EXPECT_EQ(board.checker->inner_columns, 4);
  EXPECT_EQ(board.checker->inner_rows, 6);
  ASSERT_EQ(board.tags.size(), 17U);
  EXPECT_NEAR((board.tags[0].center_in_board_m - Eigen::Vector2d(-0.04, -0.12)).norm(), 0.0, 1e-12);
  const std::string written = FormatBoards(*boards);
  const auto again = ParseBoards(written, "again.yaml");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(FormatBoards(*again), written);
  const auto legacy = ParseBoards(text(8, ", legacy: true"), "b.yaml");
  ASSERT_TRUE(legacy) << legacy.error().message;
  EXPECT_TRUE(legacy->front().checker->starts_white);
  EXPECT_NEAR((legacy->front().tags[0].center_in_board_m - Eigen::Vector2d(-0.08, -0.14)).norm(),
              0.0, 1e-12);
  EXPECT_THAT(ParseBoards(text(7, ", first_id: 240"), "b.yaml")->front().tags.back().id, 256);
}

TEST(BoardFile, ACheckerboardThatHoldsTagsHasThemInItsWhiteSquares) {
  const char* text =
      "id: 0\ntop_right_m: 0.4\nright_bottom_m: 0.5\n"
      "checker: {inner_columns: 4, inner_rows: 6, square_m: 0.04, holds_tags: true}\n"
      "tags:\n  - {family: aruco_6x6_250, id: 1, edge_m: 0.03, center_in_board_m: [0.04, 0]}\n";
  EXPECT_THAT(ParseBoards(text, "b.yaml").error().message, HasSubstr("within a white square"));
}

TEST(BoardTemplates, AreBoardsWithoutFault) {
  for (const std::string& name : BoardTemplateNames()) {
    const Expected<Board> board = FindBoardTemplate(name);
    ASSERT_TRUE(board) << name;
    EXPECT_FALSE(FindBoardFault(*board)) << name;
    const std::vector<Board> boards = {*board};
    const auto again = ParseBoards(FormatBoards(boards), name);
    ASSERT_TRUE(again) << again.error().message;
  }
  EXPECT_THAT(FindBoardTemplate("fast_calip").error().message, HasSubstr("fast_calib"));
}

TEST(BoardFile, ADocumentMayBeOneBoard) {
  const auto boards = ParseBoards("id: 1\ntop_right_m: 0.5\nright_bottom_m: 0.4\n", "b.yaml");
  ASSERT_TRUE(boards) << boards.error().message;
  ASSERT_EQ(boards->size(), 1U);
  EXPECT_EQ(boards->front().right_bottom_m, 0.4);
}

TEST(BoardFile, RoundTripsToTheSameText) {
  auto boards = ParseBoards(kHollow, "b.yaml");
  ASSERT_TRUE(boards) << boards.error().message;
  (*boards)[0].name = "it's \"new\": \\#1";
  (*boards)[0].tags[0].rotation_rad = 1.234;
  const std::string text = FormatBoards(*boards);
  const auto again = ParseBoards(text, "again.yaml");
  ASSERT_TRUE(again) << again.error().message;
  EXPECT_EQ(FormatBoards(*again), text);
  EXPECT_EQ(again->front().name, boards->front().name);
  EXPECT_EQ(again->front().tags[0].rotation_rad, 1.234);
  EXPECT_EQ(again->front().tags[0].center_in_board_m, boards->front().tags[0].center_in_board_m);
  EXPECT_EQ(again->back().checker->square_m, 0.095);
}

class BadBoardTest : public testing::TestWithParam<BadText> {};

TEST_P(BadBoardTest, EndsInOneLineThatSaysWhereAndWhat) {
  ExpectRefused(ParseBoards(GetParam().text, "b"), GetParam());
}

// A board of 0.6 x 0.8 m with additional lines.
std::string BoardWith(const std::string& lines) {
  return "boards:\n  - id: 0\n    top_right_m: 0.6\n    right_bottom_m: 0.8\n" + lines;
}

std::string Tag(int id, const std::string& center, const std::string& edge = "0.1") {
  return "      - {family: tag36h11, id: " + std::to_string(id) + ", edge_m: " + edge +
         ", center_in_board_m: " + center + "}\n";
}

INSTANTIATE_TEST_SUITE_P(
    Inputs, BadBoardTest,
    testing::Values(
        BadText{"Empty", "", kParse, "b:1: the file is empty"},
        BadText{"NoBoards", "boards: []", kParse, "b:1: boards: expected at least one board"},
        BadText{"UnknownKey", BoardWith("    hol: {}\n"), kParse,
                "b:5: board: unknown key 'hol'; did you mean 'hole'?"},
        BadText{"ABeginningIsMeant", "id: 0\ncheckerboard: {}\ntop_right_m: 1\n", kParse,
                "b:2: board: unknown key 'checkerboard'; did you mean 'checker'?"},
        BadText{"WrongKeyOfOneBoard", "id: 0\nright_bottom_m: 1\ntop_righ_m: 1\n", kParse,
                "b:3: board: unknown key 'top_righ_m'; did you mean 'top_right_m'?"},
        BadText{"Camera", "image_width: 1280\ncamera_matrix: {}\n", kParse,
                "b:1: expected boards, with the key 'boards', but this is a file of a camera"},
        BadText{"NameOfTwoLines", "id: 0\nname: \"a\\nb\"\ntop_right_m: 1\n", kParse,
                "b:2: name: expected text of one line, got 'a\\x0ab'"},
        BadText{"NameWithEscape", "id: 0\nname: \"a\\eb\"\ntop_right_m: 1\n", kParse,
                "b:2: not valid YAML: name: control characters are not allowed"},
        BadText{"UnknownTagKey", BoardWith("    tags:\n      - {familie: x}\n"), kParse,
                "b:6: tag: unknown key 'familie'; did you mean 'family'?"},
        BadText{"NoId", "boards:\n  - {top_right_m: 1, right_bottom_m: 1}\n", kParse,
                "b:2: id: expected this key"},
        BadText{"ZeroSide", "id: 0\ntop_right_m: 0\nright_bottom_m: 1\n", kParse,
                "b:2: board: top_right_m: expected more than zero"},
        BadText{"NegativeSide", "id: 0\ntop_right_m: 1\nright_bottom_m: -1\n", kParse,
                "b:3: board: right_bottom_m: expected more than zero"},
        BadText{"Millimetres", "id: 0\ntop_right_m: 600\nright_bottom_m: 450\n", kParse,
                "b:2: board: top_right_m: 600 m? sizes are in metres"},
        BadText{"MillimetresOfATag", BoardWith("    tags:\n" + Tag(1, "[0, 0]", "250")), kParse,
                "b:6: tag 0: edge_m: 250 m? sizes are in metres"},
        BadText{"MillimetresOfKalibr",
                "target_type: aprilgrid\ntagCols: 6\ntagRows: 6\ntagSize: 88\ntagSpacing: 0.3\n",
                kParse, "b:4: tagSize: 88 m? sizes are in metres"},
        BadText{"MillimetresOfThickness", BoardWith("    thickness_m: 5\n"), kParse,
                "b:5: board: thickness_m: 5 m? sizes are in metres"},
        BadText{"NotANumber", "id: 0\ntop_right_m: .nan\nright_bottom_m: 1\n",
                ErrorCode::kNonFinite, "b:2: top_right_m"},
        BadText{"Thickness", BoardWith("    thickness_m: -1\n"), kParse, "b:5: board: thickness_m"},
        BadText{"HoleWithoutSize", BoardWith("    hole: {width_m: 0.0, height_m: 0.1}\n"), kParse,
                "b:5: hole: width_m: expected more than zero"},
        BadText{"HoleTooLarge", BoardWith("    hole: {width_m: 0.6, height_m: 0.1}\n"), kParse,
                "b:5: hole: expected the opening to lie within the board"},
        BadText{"HoleShifted",
                BoardWith("    hole: {width_m: 0.3, height_m: 0.1, center_in_board_m: [0.2, 0]}\n"),
                kParse, "within the board"},
        BadText{"TagWithoutSize", BoardWith("    tags:\n" + Tag(1, "[0, 0]", "0")), kParse,
                "b:6: tag 0: edge_m: expected more than zero"},
        BadText{"TagOffTheBoard",
                BoardWith("    tags:\n" + Tag(1, "[0, 0]") + Tag(2, "[0.26, 0.2]")), kParse,
                "b:7: tag 1: center_in_board_m: it reaches over the board's edge"},
        BadText{
            "TurnedTagOffTheBoard",
            BoardWith("    tags:\n      - {family: a, id: 1, edge_m: 0.59, rotation_deg: 45}\n"),
            kParse, "over the board's edge"},
        BadText{
            "TagInTheHole",
            BoardWith("    hole: {width_m: 0.3, height_m: 0.3}\n    tags:\n" + Tag(1, "[0.1, 0]")),
            kParse, "b:7: tag 0: center_in_board_m: it reaches into the board's hole"},
        BadText{"TagsOverlap",
                BoardWith("    tags:\n" + Tag(1, "[0, 0]") + Tag(2, "[0.099, 0.09]")), kParse,
                "b:7: tag 1: center_in_board_m: it overlaps the tag 1 of tag36h11"},
        BadText{"TagTwice", BoardWith("    tags:\n" + Tag(1, "[0, 0]") + Tag(1, "[0, 0.2]")),
                kParse, "b:7: tag 1: id: the id 1 of tag36h11 is on this board a second time"},
        BadText{
            "TagOverChecker",
            BoardWith("    checker: {inner_columns: 3, inner_rows: 3, square_m: 0.1}\n    tags:\n" +
                      Tag(1, "[0, 0.2]")),
            kParse, "it overlaps the checkerboard"},
        BadText{"CheckerTooLarge",
                BoardWith("    checker: {inner_columns: 6, inner_rows: 3, square_m: 0.1}\n"),
                kParse, "b:5: checker: center_in_board_m: it reaches over the board's edge"},
        BadText{"CheckerOfNothing",
                BoardWith("    checker: {inner_columns: 1, inner_rows: 3, square_m: 0.1}\n"),
                kParse, "b:5: checker: inner_columns: expected 2 to 1000"},
        BadText{"BoardTwice", BoardWith("  - {id: 0, top_right_m: 1, right_bottom_m: 1}\n"), kParse,
                "b:5: id: the board on line 2 already has the id 0"},
        BadText{"TagOnTwoBoards",
                BoardWith("    tags:\n" + Tag(1, "[0, 0]")) +
                    "  - id: 1\n    top_right_m: 1\n    right_bottom_m: 1\n    tags:\n" +
                    Tag(1, "[0, 0]"),
                kParse, "b:11: tag 0: id: the id 1 of 'tag36h11' is already on board 0"},
        BadText{"MarkersOfThreeBoards",
                "3\n" + std::string("48\n46\n4\n5\n20\n48\n46\n4\n5\n20\n") + "48\n46\n4\n5\n20\n",
                ErrorCode::kInvalidInput, "expected one tag id per board, 3 in all, got 2"},
        BadText{"MarkerLargerThanItsBoard", "2\n48\n46\n4\n5\n20\n48\n46\n4\n5\n43\n",
                ErrorCode::kInvalidInput, "b: board 2: center_in_board_m: it reaches over"}),
    [](const auto& bad) { return bad.param.name; });

TEST(BoardFile, TagsMayTouchEachOtherAndTheEdge) {
  const auto boards = ParseBoards(BoardWith("    tags:\n" + Tag(1, "[-0.25, 0]") +
                                            Tag(2, "[-0.15, 0]") + Tag(3, "[-0.25, 0.1]")),
                                  "b");
  EXPECT_TRUE(boards) << boards.error().message;
}

// In the order in which the package's session lists the markers' corners in the image, the tag's
// own top-left points to the board's right corner, and the tag is near the board's left corner.
TEST(BoardFile, TakesTheOriginalsMarkersWithTheirTags) {
  SEXTANT_REAL_DATA(path, "dhall/session_2017-05-03/marker_coordinates.txt");
  const auto boards = ReadBoards(path);
  ASSERT_TRUE(boards) << boards.error().message;
  ASSERT_EQ(boards->size(), 2U);
  EXPECT_EQ((*boards)[0].tags.at(0).id, 26);
  EXPECT_EQ((*boards)[1].tags.at(0).id, 582);
  const BoardTag& tag = (*boards)[0].tags.at(0);
  EXPECT_EQ(tag.family, "aruco_original");
  EXPECT_NEAR(tag.edge_m, 0.205, 1e-12);
  // The marker's pose and the board's corners of that session, in the board frame.
  EXPECT_NEAR(tag.center_in_board_m.x(), -0.0815, 1e-6);
  EXPECT_NEAR(tag.center_in_board_m.y(), 0.0995, 1e-6);
  EXPECT_NEAR((*boards)[1].tags.at(0).center_in_board_m.y(), 0.1025, 1e-6);
  const Eigen::Vector2d own_top_left = TagCorners(tag)[0] - tag.center_in_board_m;
  EXPECT_NEAR((own_top_left - Eigen::Vector2d(0.1025, -0.1025)).norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace sextant
