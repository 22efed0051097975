// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "features/lidar/corner_extractor.h"
#include "io/clouds/pcd_file.h"
#include "io/problems/acfr_poses.h"
#include "support/median.h"
#include "support/real_data.h"

namespace sextant::test {
namespace {

// Distance of each corner to the nearest stored one: the file's order differs from ours, and the
// corners of a board are ten times further apart than any distance allowed here.
void AddDistances(const LidarCorners& corners, const AcfrBoardView& stored,
                  std::vector<double>& distances) {
  for (const Eigen::Vector3d& corner : corners.in_lidar) {
    double nearest = std::numeric_limits<double>::max();
    for (const Eigen::Vector3d& other : stored.corners_m) {
      nearest = std::min(nearest, (corner - other).norm());
    }
    distances.push_back(nearest);
  }
}

Eigen::Vector3d CenterOf(const BoardPatch& patch) { return patch.plane.At(patch.fit.center); }

TEST(RealScans, AcfrBoardIsFoundInEveryFullScan) {
  SEXTANT_REAL_DATA(folder, "acfr_vlp16");
  const Expected<std::vector<AcfrPose>> poses = ReadAcfrPoses(folder / "poses.csv");
  ASSERT_TRUE(poses) << poses.error().message;
  Board board;
  board.top_right_m = 0.61;
  board.right_bottom_m = 0.85;
  const std::vector<Board> boards = {board};
  const std::vector<Board> exchanged = {{.top_right_m = 0.85, .right_bottom_m = 0.61}};
  std::vector<double> rectangle;
  std::vector<double> plane_lines;
  std::vector<double> lines3d;
  for (const int id : {2, 4, 5, 8, 9, 11, 13, 15, 16, 19, 20, 22, 24, 26, 27, 29, 30, 33, 36, 38}) {
    const Expected<PointCloud> cloud = ReadPcd(folder / fmt::format("full/pose{}.pcd", id));
    ASSERT_TRUE(cloud) << cloud.error().message;
    const ScanRings rings = *ScanRings::Build(*cloud);
    const Expected<BoardSearch> search = FindBoards(rings, boards, {});
    ASSERT_TRUE(search);
    ASSERT_EQ(search->found.size(), 1U) << "pose " << id;
    const Expected<BoardSearch> other = FindBoards(rings, exchanged, {});
    ASSERT_TRUE(other);
    ASSERT_EQ(other->found.size(), 1U) << "pose " << id;
    const BoardPatch& patch = search->found[0];
    EXPECT_LT((CenterOf(patch) - CenterOf(other->found[0])).norm(), 0.001) << "pose " << id;
    const auto pose = std::ranges::find(*poses, id, &AcfrPose::id);
    ASSERT_NE(pose, poses->end());
    AddDistances(*ExtractCorners("rectangle", patch, board), pose->in_lidar, rectangle);
    AddDistances(*ExtractCorners("plane_lines", patch, board), pose->in_lidar, plane_lines);
    AddDistances(*ExtractCorners("lines3d", patch, board), pose->in_lidar, lines3d);
  }
  // A crude known-size fit on the same scans: median 11 mm, p90 21, max 44 (over all poses).
  EXPECT_LT(Median(rectangle), 0.020);
  EXPECT_LT(*std::ranges::max_element(rectangle), 0.060);
  EXPECT_LT(Median(plane_lines), 0.020);
  EXPECT_LT(Median(lines3d), 0.030);
}

// The ranges are about 7 cm too long, so that angles and ranges together make the board larger than
// it is by as much as it is farther away; the camera agrees with this. 3 to 5 mm a side remain.
TEST(RealScans, OusterBoardIsFoundWithAndWithoutRings) {
  SEXTANT_REAL_DATA(folder, "ouster64");
  Board board;
  board.top_right_m = 1.016;
  board.right_bottom_m = 1.016;
  BoardSearchOptions options;
  options.beam = *FindLidarBeam("os1_64");
  for (const int id : {3, 12, 24}) {
    Expected<PointCloud> cloud = ReadPcd(folder / fmt::format("lidar_data/pointcloud{}.pcd", id));
    ASSERT_TRUE(cloud) << cloud.error().message;
    for (const bool with_field : {true, false}) {
      if (!with_field) cloud->ring.clear();
      const std::string what = fmt::format("scan {}, ring field {}", id, with_field);
      const Expected<BoardSearch> search =
          FindBoards(*ScanRings::Build(*cloud), std::vector<Board>{board}, options);
      ASSERT_TRUE(search);
      ASSERT_EQ(search->found.size(), 1U) << what;
      const Eigen::Vector3d center = search->found[0].plane.At(search->found[0].fit.center);
      EXPECT_NEAR(center.norm(), 3.2, 0.4) << what;  // Not one of the hall's panels.
      const Expected<LidarCorners> corners = ExtractCorners("plane_lines", search->found[0], board);
      ASSERT_TRUE(corners) << corners.error().message;
      double mean = 0.0;
      for (const double side : corners->checks.edge_lengths_m) mean += side / 4.0;
      const double seen_m = 1.016 * center.norm() / (center.norm() - 0.07);
      EXPECT_NEAR(mean, seen_m, 0.012) << what;
    }
  }
}

// Scans with the place of the one board in each, measured independently or seen in its photo. What
// is elsewhere is no board.
struct RealScan {
  const char* file;
  const char* beam;
  double width_m;
  double height_m;
  Eigen::Vector3d center;
  double tolerance_m;
};

const std::vector<RealScan>& RealBoards() {
  static const std::vector<RealScan> scans = {
      {"field/ouster64_garage/pointcloud0.pcd", "os1_64", 1.016, 1.016, {2.47, -.01, -.12}, 0.2},
      {"field/ouster64_garage/pointcloud4.pcd", "os1_64", 1.016, 1.016, {2.92, -.49, -.11}, 0.2},
      {"field/ouster64_garage/pointcloud9.pcd", "os1_64", 1.016, 1.016, {3.18, -.31, -.03}, 0.2},
      {"field/ouster64_garage/pointcloud20.pcd", "os1_64", 1.016, 1.016, {3.13, .25, -.25}, 0.2},
      {"field/ouster64_garage/pointcloud31.pcd", "os1_64", 1.016, 1.016, {3.24, .45, -.11}, 0.2},
  };
  return scans;
}

TEST(RealScans, EachHasItsBoardAndNoOther) {
  for (const RealScan& scan : RealBoards()) {
    SEXTANT_REAL_DATA(path, "");
    const Expected<PointCloud> cloud = ReadPcd(path / scan.file);
    ASSERT_TRUE(cloud) << cloud.error().message;
    const ScanRings rings = *ScanRings::Build(*cloud);
    BoardSearchOptions options;
    options.beam = *FindLidarBeam(scan.beam);
    for (const bool exchanged : {false, true}) {
      Board board{.top_right_m = scan.width_m, .right_bottom_m = scan.height_m};
      if (exchanged) std::swap(board.top_right_m, board.right_bottom_m);
      const Expected<BoardSearch> search = FindBoards(rings, std::vector<Board>{board}, options);
      ASSERT_TRUE(search);
      EXPECT_EQ(search->found.size(), 1U) << scan.file;
      if (search->found.empty()) continue;
      EXPECT_LT((CenterOf(search->found[0]) - scan.center).norm(), scan.tolerance_m) << scan.file;
      EXPECT_TRUE(search->others.empty()) << scan.file;
    }
  }
}

}  // namespace
}  // namespace sextant::test
