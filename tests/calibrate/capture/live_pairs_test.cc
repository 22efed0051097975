// SPDX-License-Identifier: Apache-2.0
#include "calibrate/capture/live_pairs.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace sextant {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> PairsOf(const std::vector<std::filesystem::path>& images,
                                 const std::vector<std::filesystem::path>& clouds) {
  std::vector<std::string> names;
  for (const FilePair& pair : PairSoFar(images, clouds, 0.05).pairs) {
    names.push_back(pair.name + ": " + pair.image.string() + " " + pair.cloud.string());
  }
  return names;
}

TEST(StampInName, KnowsSecondsAndTheirFractions) {
  EXPECT_EQ(StampInName("1700000000"), 1'700'000'000'000'000'000);
  EXPECT_EQ(StampInName("cam0_1700000000123"), 1'700'000'000'123'000'000);
  EXPECT_EQ(StampInName("1700000000123456"), 1'700'000'000'123'456'000);
  EXPECT_EQ(StampInName("1700000000123456789"), 1'700'000'000'123'456'789);
  EXPECT_EQ(StampInName("left-1700000000.123456"), 1'700'000'000'123'456'000);
  EXPECT_EQ(StampInName("1700000000_000000001"), 1'700'000'000'000'000'001);
}

TEST(StampInName, CountersAndDatesAreNoTimes) {
  for (const char* name : {"photo_7", "photo", "", "0000000007", "2024-05-01_12-30-05",
                           "20240501123005", "9999999999", "1700000000.5", "1700000000-123456",
                           "17000000001234567890123", "99999999999999999999999"}) {
    EXPECT_EQ(StampInName(name), std::nullopt) << name;
  }
}

TEST(PairSoFar, ASinglePhotoIsNotPairedWithAnotherMomentsScan) {
  EXPECT_THAT(PairsOf({"photo_7.png"}, {"scan_8.pcd"}), IsEmpty());
  EXPECT_THAT(PairsOf({"photo_7.png"}, {"scan_007.pcd"}),
              ElementsAre("7: photo_7.png scan_007.pcd"));
  EXPECT_THAT(PairsOf({"photo.png"}, {"scan.pcd"}), IsEmpty());
  EXPECT_THAT(PairsOf({}, {"scan_1.pcd"}), IsEmpty());
}

TEST(PairSoFar, ByTheLastNumbersWhateverHasArrived) {
  EXPECT_THAT(PairsOf({"cam0_1.png", "cam0_2.png"}, {"scan_2.pcd"}),
              ElementsAre("2: cam0_2.png scan_2.pcd"));
  // The date has numbers, too, of which one alone would be ambiguous.
  EXPECT_THAT(
      PairsOf({"2024-05-01_12-30-05.png", "2024-05-01_12-31-05.png"}, {"2024-05-01_12-31-05.pcd"}),
      ElementsAre("2024-05-01_12-31-05: 2024-05-01_12-31-05.png 2024-05-01_12-31-05.pcd"));
  const FilePairs found = PairSoFar({"a_1.png", "a_2.png"}, {"b_2.pcd", "b_3.pcd"}, 0.05);
  EXPECT_THAT(found.without_partner,
              ElementsAre(std::filesystem::path("a_1.png"), std::filesystem::path("b_3.pcd")));
}

TEST(PairSoFar, NamesWithoutTellingNumbersArePairedAsCalibrateDoes) {
  EXPECT_THAT(PairsOf({"near.png", "far.png"}, {"near.pcd", "far.pcd"}),
              ElementsAre("f: far.png far.pcd", "ne: near.png near.pcd"));
  // The last numbers are those of versions.
  EXPECT_THAT(PairsOf({"p1_v2.png", "p2_v2.png"}, {"s1.pcd", "s2.pcd"}),
              ElementsAre("1: p1_v2.png s1.pcd", "2: p2_v2.png s2.pcd"));
}

TEST(PairSoFar, TimesArePairedWithinTheTolerance) {
  EXPECT_THAT(PairsOf({"1700000000.100000.png", "1700000001.100000.png"},
                      {"1700000001.140000.pcd", "1700000000.300000.pcd"}),
              ElementsAre("1700000001.100000: 1700000001.100000.png 1700000001.140000.pcd"));
}

}  // namespace
}  // namespace sextant
