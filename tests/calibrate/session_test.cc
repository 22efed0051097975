// SPDX-License-Identifier: Apache-2.0
#include "calibrate/session/session.h"

#include <gmock/gmock.h>

#include <chrono>

#include "io/output/output_file.h"
#include "support/scratch_folder.h"

namespace sextant::test {
namespace {

namespace fs = std::filesystem;

std::vector<std::string> NamesOf(const FilePairs& found) {
  std::vector<std::string> names;
  for (const FilePair& pair : found.pairs) {
    names.push_back(pair.name + ": " + pair.image.string() + " " + pair.cloud.string());
  }
  return names;
}

TEST(PairFiles, ByTheDistinguishingPartOfTheirNames) {
  const FilePairs found = PairFiles({"i/pose2.png", "i/pose10.png", "i/pose9.png"},
                                    {"c/pose10.pcd", "c/pose2.pcd", "c/pose9.pcd"});
  EXPECT_THAT(NamesOf(found),
              testing::ElementsAre("2: i/pose2.png c/pose2.pcd", "9: i/pose9.png c/pose9.pcd",
                                   "10: i/pose10.png c/pose10.pcd"));
  EXPECT_TRUE(found.without_partner.empty());
}

TEST(PairFiles, NumbersAreEqualByValue) {
  const FilePairs found =
      PairFiles({"cam_000.png", "cam_001.png", "cam_011.png"}, {"scan_0.pcd", "scan_11.pcd"});
  EXPECT_THAT(NamesOf(found),
              testing::ElementsAre("000: cam_000.png scan_0.pcd", "011: cam_011.png scan_11.pcd"));
  EXPECT_THAT(found.without_partner, testing::ElementsAre(fs::path("cam_001.png")));
}

TEST(ExpandPattern, StarsMatchAnyTextAndTakeNoLongerThanOthers) {
  const ScratchFolder folder;
  const std::string name = std::string(200, 'a') + ".png";
  for (const std::string& file : {name, std::string("ab.png"), std::string("b*.png")}) {
    ASSERT_TRUE(WriteFileAtomically(folder.path() / file, "x"));
  }
  const auto count = [&folder](const std::string& pattern) {
    const auto found = ExpandPattern(folder.path() / pattern);
    return found ? found->size() : 0;
  };
  EXPECT_EQ(count("*"), 3U);
  EXPECT_EQ(count("a*.png"), 2U);
  EXPECT_EQ(count("*b*"), 2U);
  EXPECT_EQ(count("**a**.png**"), 2U);
  EXPECT_EQ(count("*a*b.png"), 1U);
  EXPECT_EQ(count("a*a.png"), 1U);
  EXPECT_EQ(count("ab*b.png"), 0U);
  EXPECT_EQ(count("*.pn"), 0U);
  std::string stars;
  for (int i = 0; i < 60; ++i) stars += "*a";
  const auto start = std::chrono::steady_clock::now();
  EXPECT_EQ(count(stars + "*"), 1U);
  EXPECT_EQ(count(stars + "*c"), 0U);
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(1));
}

// A session file may not list the whole disk.
TEST(ExpandPattern, RefusesMoreFilesThanASessionHas) {
  const ScratchFolder folder;
  fs::create_directory(folder.path() / "f");
  for (int i = 0; i < 100; ++i) {
    ASSERT_TRUE(WriteFileAtomically(folder.path() / "f" / std::to_string(i), ""));
  }
  for (int i = 0; i < 1100; ++i) {
    fs::create_directory_symlink("f", folder.path() / ("f" + std::to_string(i)));
  }
  const auto some = ExpandPattern(folder.path() / "f1*" / "*");
  ASSERT_TRUE(some);
  EXPECT_EQ(some->size(), 211U * 100U);
  const auto all = ExpandPattern(folder.path() / "*" / "*");
  ASSERT_FALSE(all);
  EXPECT_THAT(all.error().message, testing::HasSubstr("more than 100000 files match"));
}

TEST(PairFiles, OneOfEachBelongsTogether) {
  const FilePairs found = PairFiles({"photo.jpg"}, {"turn.pcd"});
  EXPECT_THAT(NamesOf(found), testing::ElementsAre("photo: photo.jpg turn.pcd"));
}

TEST(PairFiles, WordsToo) {
  const FilePairs found =
      PairFiles({"near left.png", "near right.png"}, {"s_near right.ply", "s_near left.ply"});
  EXPECT_EQ(found.pairs.size(), 2U);
}

class SessionFiles : public testing::Test {
 protected:
  void Write(const std::string& name, const std::string& text = "x") const {
    fs::create_directories((folder_.path() / name).parent_path());
    ASSERT_TRUE(WriteFileAtomically(folder_.path() / name, text));
  }
  fs::path At(const std::string& name) const { return folder_.path() / name; }

  ScratchFolder folder_;
};

TEST_F(SessionFiles, PatternsInNaturalOrder) {
  for (const char* name : {"a10.png", "a9.png", "a1.png", "b1.png", "a1.pcd"}) Write(name);
  const auto found = ExpandPattern(At("a*.png"));
  ASSERT_TRUE(found) << found.error().message;
  EXPECT_THAT(*found, testing::ElementsAre(At("a1.png"), At("a9.png"), At("a10.png")));
  const auto none = ExpandPattern(At("c*.png"));
  ASSERT_FALSE(none);
  EXPECT_EQ(none.error().code, ErrorCode::kMissingData);
  EXPECT_FALSE(ExpandPattern(At("no folder/a*.png")));
}

TEST_F(SessionFiles, AFileWithPatternsTakesPathsFromItsFolder) {
  Write("photos/p1.png");
  Write("photos/p2.png");
  Write("scans/s1.pcd");
  Write("scans/s2.pcd");
  Write("session.yaml",
        "sextant_session: 1\nboards: boards.yaml\ncamera: cam.yaml\nimages: photos/p*.png\n"
        "clouds: scans/s*.pcd\ninitial_cam_from_lidar: {translation_m: [0, 0, 0.5], "
        "quaternion_wxyz: [1, 0, 0, 0]}\n");
  const Expected<Session> session = ReadSession(folder_.path());
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_EQ(session->boards, At("boards.yaml"));
  EXPECT_EQ(session->camera, At("cam.yaml"));
  EXPECT_THAT(NamesOf(session->files),
              testing::ElementsAre(
                  "1: " + At("photos/p1.png").string() + " " + At("scans/s1.pcd").string(),
                  "2: " + At("photos/p2.png").string() + " " + At("scans/s2.pcd").string()));
  ASSERT_TRUE(session->initial_cam_from_lidar);
  EXPECT_EQ(session->initial_cam_from_lidar->translation.z(), 0.5);
}

TEST_F(SessionFiles, PairsAreNamed) {
  const Expected<Session> session = ParseSession(
      "sextant_session: 1\nboards: b.yaml\npairs:\n  - {image: a.png, cloud: a.pcd}\n"
      "  - {name: second, image: b.png, cloud: b.pcd}\n",
      "x/session.yaml");
  ASSERT_TRUE(session) << session.error().message;
  EXPECT_THAT(NamesOf(session->files),
              testing::ElementsAre("a: x/a.png x/a.pcd", "second: x/b.png x/b.pcd"));
}

TEST_F(SessionFiles, WhatIsWrongIsSaidWithItsLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"boards: b.yaml\n", "sextant_session"},
      {"sextant_session: 1\nboard: b.yaml\n", "did you mean 'boards'"},
      {"sextant_session: 1\n", "expected one of pairs, images with clouds, and bag"},
      {"sextant_session: 1\nbag: a.bag\nimages: a*.png\nclouds: b*.pcd\n", "expected one of"},
      {"sextant_session: 1\npairs:\n  - {image: a.png}\n", "cloud"},
      {"sextant_session: 2\nbag: a.bag\n", "sextant_session"},
      {"4\n1 2 3\n", "run 'sextant solve' with it"},
      {"sextant_problem: 1\n", "run 'sextant solve' with it"},
      {"sextant_session: 1\npairs:\n  - {name: \"a\\nb\", image: a, cloud: b}\n",
       "s.yaml:3: name: expected text of one line"},
  };
  for (const auto& [text, expected] : cases) {
    const Expected<Session> session = ParseSession(text, "s.yaml");
    ASSERT_FALSE(session) << text;
    EXPECT_THAT(session.error().message, testing::HasSubstr("s.yaml"));
    EXPECT_THAT(session.error().message, testing::HasSubstr(expected)) << text;
  }
}

TEST_F(SessionFiles, AFolderOfASimulatedSession) {
  for (const char* name :
       {"boards.yaml", "cam_info.yaml", "cam_right_info.yaml", "cam_000.png", "cam_001.png",
        "cam_right_000.png", "cam_right_001.png", "scan_000.pcd", "scan_001.pcd"}) {
    Write(name);
  }
  Write("truth.yaml",
        "sextant_truth: 1\ncameras:\n  - camera: cam\n    cam_from_lidar: {translation_m: [1, 2, "
        "3], quaternion_wxyz: [1, 0, 0, 0]}\n  - camera: cam_right\n    cam_from_lidar: "
        "{translation_m: [4, 5, 6], quaternion_wxyz: [1, 0, 0, 0]}\n");
  const Expected<Session> first = ReadSession(folder_.path());
  ASSERT_TRUE(first) << first.error().message;
  EXPECT_EQ(first->camera, At("cam_info.yaml"));
  EXPECT_EQ(first->files.pairs.size(), 2U);
  EXPECT_EQ(first->files.pairs[1].image, At("cam_001.png"));
  EXPECT_TRUE(first->files.without_partner.empty());
  EXPECT_EQ(first->true_cam_from_lidar->translation.x(), 1.0);
  const Expected<Session> second = ReadSession(folder_.path(), "cam_right");
  ASSERT_TRUE(second) << second.error().message;
  EXPECT_EQ(second->files.pairs[1].image, At("cam_right_001.png"));
  EXPECT_EQ(second->true_cam_from_lidar->translation.x(), 4.0);
  const Expected<Session> none = ReadSession(folder_.path(), "left");
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().message, testing::HasSubstr("cam, cam_right"));
}

TEST_F(SessionFiles, ATopicIsRefusedWithoutARecording) {
  Write("session.yaml",
        "sextant_session: 1\nimages: a.png\nclouds: a.pcd\nimage_topic: /cam/image_raw\n");
  const Expected<Session> session = ReadSession(folder_.path());
  ASSERT_FALSE(session);
  EXPECT_THAT(session.error().message, testing::HasSubstr("image_topic: is for a recording"));
}

TEST_F(SessionFiles, ANameOfACameraIsRefusedWhereThereAreNone) {
  Write("session.yaml", "sextant_session: 1\nimages: a.png\nclouds: a.pcd\n");
  for (const fs::path& path : {folder_.path(), At("session.yaml"), At("drive.bag")}) {
    const Expected<Session> session = ReadSession(path, "left");
    ASSERT_FALSE(session) << path;
    EXPECT_THAT(session.error().message, testing::HasSubstr("'left'")) << path;
  }
}

TEST_F(SessionFiles, RecordingsByTheirEndings) {
  EXPECT_EQ(ReadSession(At("drive.mcap"))->bag, At("drive.mcap"));
  Write("rosbag2/drive.db3");
  EXPECT_EQ(ReadSession(At("rosbag2"))->bag, At("rosbag2"));
  fs::create_directories(At("empty"));
  const Expected<Session> nothing = ReadSession(At("empty"));
  ASSERT_FALSE(nothing);
  EXPECT_THAT(nothing.error().message, testing::HasSubstr("--image"));
}

}  // namespace
}  // namespace sextant::test
