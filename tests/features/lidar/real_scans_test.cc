// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "features/lidar/corner_extractor.h"
#include "io/acfr_poses.h"
#include "io/pcd_file.h"
#include "support/real_data.h"

namespace sextant::test {
namespace {

double Median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

// Each corner to the nearest stored one: the file's order is not ours, and corners of one board are
// ten times further apart than anything allowed here.
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

TEST(RealScans, AcfrBoardIsFoundInEveryFullScan) {
  SEXTANT_REAL_DATA(folder, "acfr_vlp16");
  const Expected<std::vector<AcfrPose>> poses = ReadAcfrPoses(folder / "poses.csv");
  ASSERT_TRUE(poses) << poses.error().message;
  Board board;
  board.top_right_m = 0.61;
  board.right_bottom_m = 0.85;
  const std::vector<Board> boards = {board};
  std::vector<double> rectangle;
  std::vector<double> plane_lines;
  std::vector<double> lines3d;
  for (const int id : {2, 5, 9, 16, 20, 26, 30}) {
    const Expected<PointCloud> cloud = ReadPcd(folder / fmt::format("full/pose{}.pcd", id));
    ASSERT_TRUE(cloud) << cloud.error().message;
    const Expected<BoardSearch> search = FindBoards(*ScanRings::Build(*cloud), boards, {});
    ASSERT_TRUE(search);
    ASSERT_EQ(search->found.size(), 1U) << "pose " << id;
    const auto pose = std::ranges::find(*poses, id, &AcfrPose::id);
    ASSERT_NE(pose, poses->end());
    const BoardPatch& patch = search->found[0];
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

}  // namespace
}  // namespace sextant::test
