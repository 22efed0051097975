// SPDX-License-Identifier: Apache-2.0
// Each detector on photos with known tags.
#include <gmock/gmock.h>

#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "features/camera/quad.h"
#include "features/camera/tag_detector.h"
#include "support/pictures.h"
#include "support/real_data.h"
#include "support/run_program.h"

namespace sextant {
namespace {

using nlohmann::json;

std::vector<TagDetection> TagsIn(const std::filesystem::path& image, const std::string& detector) {
  const Expected<TagDetectorPtr> made = MakeTagDetector(detector);
  if (!made) {
    ADD_FAILURE() << made.error().message;
    return {};
  }
  const Expected<Detections> found = (*made)->Detect(test::ReadPicture(image.string()));
  if (!found) ADD_FAILURE() << found.error().message;
  return found ? found->tags : std::vector<TagDetection>();
}

std::multiset<int> IdsOf(const std::vector<TagDetection>& tags) {
  std::multiset<int> ids;
  for (const TagDetection& tag : tags) ids.insert(tag.id);
  return ids;
}

double LargestDistance(const Quad& a, const Quad& b) {
  double largest = 0.0;
  for (std::size_t k = 0; k < 4; ++k) largest = std::max(largest, (a[k] - b[k]).norm());
  return largest;
}

double LargestCoordinate(const Quad& a, const Quad& b) {
  double largest = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    largest = std::max(largest, (a[k] - b[k]).cwiseAbs().maxCoeff());
  }
  return largest;
}

Quad QuadOf(const json& corners) {
  Quad quad;
  for (std::size_t k = 0; k < 4; ++k)
    quad[k] << corners.at(k).at(0).get<double>(), corners.at(k).at(1).get<double>();
  return quad;
}

// The gold corners are OpenCV's, which without refinement are half a pixel inside.
Quad AsOpenCvReports(const Quad& corners) { return MoveEdgesOut(corners, -0.445); }

TEST(ArucoGold, EveryTagAndNoOther) {
  SEXTANT_REAL_DATA(folder, "aruco_gold");
  const json gold = json::parse(test::ReadText(folder / "gold_corners.json"));
  int images = 0;
  for (const auto& [name, expected] : gold.items()) {
    const std::string detector = expected.at("dictionary") == "tutorial_dict.yml"
                                     ? "aruco(file=" + (folder / "tutorial_dict.yml").string() + ")"
                                     : "aruco(dictionary=6x6_250)";
    const std::vector<TagDetection> tags = TagsIn(folder / name, detector);
    const json& ids = expected.at("ids");
    EXPECT_EQ(IdsOf(tags), std::multiset<int>(ids.begin(), ids.end())) << name;
    for (const TagDetection& tag : tags) {
      const auto at = std::find(ids.begin(), ids.end(), tag.id) - ids.begin();
      const Quad truth = QuadOf(expected.at("corners").at(static_cast<std::size_t>(at)));
      EXPECT_LE(LargestCoordinate(AsOpenCvReports(tag.corners_px), truth), 1.0 + 1e-9)
          << name << " id " << tag.id;
      EXPECT_GT(tag.decision_margin, 5.0) << name << " id " << tag.id;
    }
    ++images;
  }
  EXPECT_EQ(images, 4);
}

TEST(Fiducials, CornersOfTheGoldWithinATenthOfAPixel) {
  SEXTANT_REAL_DATA(folder, "fiducials");
  const json gold = json::parse(test::ReadText(folder / "expected.json"));
  // The gold does not include the correction of subpix.
  const auto as_opencv = [](const Quad& quad) { return MoveEdgesOut(quad, -0.08); };
  int tags_checked = 0;
  for (const char* image : {"tag_01_d7_14cm.png", "tag_245-246_d7_14cm.png"}) {
    const auto tags = TagsIn(folder / image, "aruco(dictionary=5x5_1000,refine=subpix)");
    EXPECT_EQ(tags.size(), gold.at(image).size()) << image;
    for (const TagDetection& tag : tags) {
      const json& corners = gold.at(image).at(std::to_string(tag.id));
      EXPECT_LT(LargestDistance(as_opencv(tag.corners_px), QuadOf(corners)), 0.1) << tag.id;
      ++tags_checked;
    }
  }
  EXPECT_EQ(tags_checked, 3);
}

// Lines "0, (x y), (x y), (x y), (x y)" in the library's pixels.
std::vector<Quad> ReadAprilTagGold(const std::filesystem::path& path) {
  std::vector<Quad> quads;
  std::istringstream stream(test::ReadText(path));
  for (std::string line; std::getline(stream, line);) {
    for (char& c : line) c = c == '(' || c == ')' || c == ',' ? ' ' : c;
    std::istringstream numbers(line);
    double id = 0.0;
    Quad quad;
    numbers >> id;
    for (Eigen::Vector2d& corner : quad) numbers >> corner.x() >> corner.y();
    if (numbers) quads.push_back(quad);
  }
  return quads;
}

Eigen::Vector2d Middle(const Quad& quad) { return 0.25 * (quad[0] + quad[1] + quad[2] + quad[3]); }

TEST(AprilTagPhotos, RecallOfTheGoldWithoutFalseOnes) {
  SEXTANT_REAL_DATA(folder, "apriltag");
  const std::map<std::string, std::pair<int, int>> recall = {
      {"33369213973_9d9bb4cc96_c", {12, 12}}, {"34085369442_304b6bafd9_c", {23, 25}}};
  for (const auto& [name, least_of_all] : recall) {
    const std::vector<Quad> gold = ReadAprilTagGold(folder / (name + ".txt"));
    ASSERT_EQ(std::ssize(gold), least_of_all.second) << name;
    const auto tags = TagsIn(folder / (name + ".jpg"), "apriltag(family=tag36h11)");
    int matched = 0;
    for (const Quad& quad : gold) {
      matched += std::ranges::any_of(tags, [&](const TagDetection& tag) {
        return (Middle(tag.corners_px) + Eigen::Vector2d(0.5, 0.5) - Middle(quad)).norm() < 3.0;
      });
    }
    EXPECT_GE(matched, least_of_all.first) << name;
    EXPECT_EQ(std::ssize(tags), matched) << name << ": false tags";
  }
}

TEST(AprilTagRoom, RecallWithoutFalseOnes) {
  SEXTANT_REAL_DATA(folder, "apriltag_room");
  std::istringstream stream(test::ReadText(folder / "groundtruth.txt"));
  int expected = 0;
  int found = 0;
  for (std::string line; std::getline(stream, line);) {
    std::istringstream words(line);
    std::string image;
    words >> image;
    const std::set<int> truth{std::istream_iterator<int>(words), {}};
    const auto tags =
        TagsIn(folder / image, "apriltag(family=tag36h11,decimate=2,min_margin=30,hamming=1)");
    for (const TagDetection& tag : tags) {
      EXPECT_TRUE(truth.contains(tag.id)) << image << ": false tag " << tag.id;
    }
    expected += static_cast<int>(truth.size());
    for (const int id : truth) found += IdsOf(tags).contains(id) ? 1 : 0;
  }
  EXPECT_GE(expected, 80);
  EXPECT_GE(found, 0.95 * expected) << found << " of " << expected;
}

TEST(DhallPhotos, OriginalDictionaryFindsItsTags) {
  SEXTANT_REAL_DATA(folder, "dhall/photos");
  for (const char* image : {"setup_view1", "setup_view2", "setup_mm1", "experimental_setup"}) {
    const auto tags = TagsIn(folder / (std::string(image) + ".jpg"), "aruco(dictionary=original)");
    EXPECT_EQ(IdsOf(tags), (std::multiset<int>{26, 582})) << image;
  }
  EXPECT_EQ(IdsOf(TagsIn(folder / "board_dim_label.jpg", "aruco(dictionary=original)")),
            (std::multiset<int>{26}));
}

TEST(AcfrImages, CheckerboardsAreFound) {
  SEXTANT_REAL_DATA(folder, "acfr_vlp16/images");
  const TagDetectorPtr detector = *MakeTagDetector("checkerboard(columns=7,rows=5)");
  for (const int pose : {2, 5, 30}) {
    const auto image = folder / ("pose" + std::to_string(pose) + ".png");
    const Expected<Detections> found = detector->Detect(test::ReadPicture(image.string()));
    ASSERT_TRUE(found) << found.error().message;
    ASSERT_EQ(found->checkers.size(), 1U) << image;
    EXPECT_EQ(found->checkers[0].corners_px.size(), 35U);
    EXPECT_FALSE(found->checkers[0].is_turn_known);
  }
}

TEST(OusterImages, HaveNoTag) {
  SEXTANT_REAL_DATA(folder, "ouster64/images");
  for (const char* image : {"frame3.png", "frame12.png", "frame24.png"}) {
    EXPECT_TRUE(TagsIn(folder / image, "aruco(dictionary=6x6_250)").empty()) << image;
    EXPECT_TRUE(TagsIn(folder / image, "aruco(dictionary=original)").empty()) << image;
    EXPECT_TRUE(TagsIn(folder / image, "apriltag(decimate=2,hamming=1)").empty()) << image;
  }
}

}  // namespace
}  // namespace sextant
