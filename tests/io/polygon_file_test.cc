// SPDX-License-Identifier: Apache-2.0
#include "io/boards/polygon_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/random.h"
#include "geometry/so3.h"
#include "support/bad_text.h"
#include "support/scratch_folder.h"

namespace sextant {
namespace {

using test::BadText;

using ErrorCode::kParse;

constexpr const char* kHeader = R"(sextant_polygons: 1
camera: {model: pinhole, width_px: 640, height_px: 480, fx_px: 320, fy_px: 320, cx_px: 319.5, cy_px: 239.5}
cam_from_lidar: {translation_m: [0, 0.1, -0.2], quaternion_wxyz: [0.5, 0.5, -0.5, 0.5]}
)";

Eigen::Vector2d Pixel(Random& random) {
  const double u = random.Uniform(-100.0, 2000.0);
  const double v = random.Uniform(-100.0, 2000.0);
  return {u, v};
}

Quadrilateral Rectangle(Random& random) {
  const Eigen::Vector2d corner = Pixel(random);
  return {corner, corner + Eigen::Vector2d(40.0, 0.1), corner + Eigen::Vector2d(41.0 / 3.0, 20.0),
          corner + Eigen::Vector2d(0.0, 20.0)};
}

ScanMarks SomeMarks(std::uint64_t seed) {
  Random random(seed);
  ScanMarks marks;
  marks.camera = AssumedCamera(1280, 720);
  marks.camera.model = CameraModel::kBrownConrady;
  marks.camera.distortion = {-0.1, 1.0 / 3e3};
  marks.cam_from_lidar = {ExpSo3({0.1, 0.2, 1.0 / 3.0}), {1.0 / 7.0, -2e-17, 3.0}};
  for (const int id : {3, 0}) {
    marks.boards.push_back({.id = id, .edges = {}});
    for (int edge = 0; edge < 4; ++edge) marks.boards.back().edges.push_back(Rectangle(random));
  }
  marks.boards.push_back({.id = 9, .edges = {Rectangle(random)}});
  marks.boards.push_back({.id = 10, .edges = {}});
  for (int corner = 0; corner < 4; ++corner) {
    marks.corners.push_back({.board = 3, .corner = corner, .pixel = Pixel(random)});
  }
  marks.unfinished = {Pixel(random), Pixel(random), Pixel(random)};
  return marks;
}

TEST(PolygonFile, RoundTripsToTheBit) {
  const ScanMarks marks = SomeMarks(1);
  const std::string text = FormatPolygons(marks);
  const Expected<ScanMarks> read = ParsePolygons(text, "p.yaml");
  ASSERT_TRUE(read) << read.error().message << text;
  EXPECT_EQ(read->camera.distortion, marks.camera.distortion);
  EXPECT_EQ(read->camera.fx_px, marks.camera.fx_px);
  EXPECT_EQ(read->cam_from_lidar.rotation.coeffs(), marks.cam_from_lidar.rotation.coeffs());
  EXPECT_EQ(read->cam_from_lidar.translation, marks.cam_from_lidar.translation);
  ASSERT_EQ(read->boards.size(), marks.boards.size());
  for (std::size_t i = 0; i < marks.boards.size(); ++i) {
    EXPECT_EQ(read->boards[i].id, marks.boards[i].id);
    EXPECT_EQ(read->boards[i].edges, marks.boards[i].edges);
  }
  ASSERT_EQ(read->corners.size(), 4U);
  EXPECT_EQ(read->corners[2].board, 3);
  EXPECT_EQ(read->corners[2].corner, 2);
  EXPECT_EQ(read->corners[2].pixel, marks.corners[2].pixel);
  EXPECT_EQ(read->unfinished, marks.unfinished);
  EXPECT_EQ(FormatPolygons(*read), text);
}

TEST(PolygonFile, NothingMarkedRoundTrips) {
  ScanMarks marks;
  marks.camera = AssumedCamera(640, 480);
  const Expected<ScanMarks> read = ParsePolygons(FormatPolygons(marks), "p.yaml");
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(read->boards.empty());
  EXPECT_TRUE(read->corners.empty());
}

TEST(PolygonFile, AMissingFileIsNamed) {
  const Expected<ScanMarks> read = ReadPolygons("/no/such/polygons.yaml");
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kIo);
  EXPECT_THAT(read.error().message, testing::HasSubstr("/no/such/polygons.yaml"));
}

class BadPolygonsTest : public testing::TestWithParam<BadText> {};

TEST_P(BadPolygonsTest, EndsInOneLineThatSaysWhereAndWhat) {
  ExpectRefused(ParsePolygons(GetParam().text, "p"), GetParam());
}

std::string PolygonsWith(const std::string& lines) { return kHeader + lines; }

INSTANTIATE_TEST_SUITE_P(
    Inputs, BadPolygonsTest,
    testing::Values(
        BadText{"Empty", "", kParse, "p:1"},
        BadText{"Problem", "sextant_problem: 1\n", kParse,
                "expected a polygon file of sextant mark"},
        BadText{"LaterVersion", "sextant_polygons: 2\n", kParse, "p:1: sextant_polygons"},
        BadText{"NoCamera", "sextant_polygons: 1\n", kParse, "camera: expected this key"},
        BadText{"UnknownKey", PolygonsWith("board: []\n"), kParse, "did you mean 'boards'?"},
        BadText{"BoardsAreAMap", PolygonsWith("boards: {}\n"), kParse,
                "p:4: boards: expected a list"},
        BadText{"NoId", PolygonsWith("boards:\n  - edges: []\n"), kParse,
                "p:5: id: expected this key"},
        BadText{"NegativeId", PolygonsWith("boards:\n  - {id: -1, edges: []}\n"), kParse,
                "p:5: id"},
        BadText{"NoEdges", PolygonsWith("boards:\n  - id: 0\n"), kParse,
                "edges: expected this key"},
        BadText{"FiveEdges", PolygonsWith("boards:\n  - {id: 0, edges: [[], [], [], [], []]}\n"),
                kParse, "p:5: edges: expected at most 4, got 5"},
        BadText{"Triangle",
                PolygonsWith("boards:\n  - {id: 0, edges: [[[0, 0], [1, 0], [0, 1]]]}\n"), kParse,
                "p:5: edges: expected four corners [u, v] of a quadrilateral, got 3"},
        BadText{"NotAPixel",
                PolygonsWith("boards:\n  - {id: 0, edges: [[[0, 0], [1, 0], [1], [0, 1]]]}\n"),
                kParse, "p:5: edges: expected 2 numbers, got 1"},
        BadText{
            "NaN",
            PolygonsWith("boards:\n  - {id: 0, edges: [[[0, .nan], [1, 0], [1, 1], [0, 1]]]}\n"),
            ErrorCode::kNonFinite, "p:5: edges"},
        BadText{"CrossesItself",
                PolygonsWith("boards:\n  - {id: 0, edges: [[[0, 0], [1, 1], [1, 0], [0, 1]]]}\n"),
                kParse, "p:5: edges: the quadrilateral crosses itself"},
        BadText{"BoardTwice",
                PolygonsWith("boards:\n  - {id: 7, edges: []}\n  - {id: 7, edges: []}\n"), kParse,
                "p:6: id: board 7 appears twice"},
        BadText{"CornerOutOfRange",
                PolygonsWith("corners:\n  - {board: 0, corner: 8, pixel: [1, 2]}\n"), kParse,
                "p:5: corner"},
        BadText{"CornerTwice",
                PolygonsWith("corners:\n  - {board: 0, corner: 1, pixel: [1, 2]}\n"
                             "  - {board: 0, corner: 1, pixel: [3, 4]}\n"),
                kParse, "p:6: corner: corner 1 of board 0 appears twice"},
        BadText{"FourUnfinished", PolygonsWith("unfinished: [[0, 0], [0, 1], [1, 1], [1, 0]]\n"),
                kParse, "p:4: unfinished: expected at most 3, got 4"}),
    [](const auto& bad) { return bad.param.name; });

}  // namespace
}  // namespace sextant
