// SPDX-License-Identifier: Apache-2.0
// Two real scans of small_gicp's data with the relative pose published by its authors.
#include <gtest/gtest.h>

#include <array>
#include <fstream>
#include <map>
#include <numbers>
#include <vector>

#include "io/clouds/cloud_file.h"
#include "solvers/icp/icp.h"
#include "support/real_data.h"

namespace sextant {
namespace {

Eigen::Matrix4d ReadMatrix(const std::filesystem::path& path) {
  std::ifstream file(path);
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Zero();
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) file >> matrix(row, column);
  }
  return matrix;
}

// One mean point per cell, so that a distant wall has the same weight as the ground near the
// sensor. The authors of the data do the same.
std::vector<Eigen::Vector3d> Thinned(const std::vector<Eigen::Vector3d>& points, double cell_m) {
  struct Sum {
    Eigen::Vector3d point = Eigen::Vector3d::Zero();
    int count = 0;
  };
  std::map<std::array<int, 3>, Sum> cells;
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3i at = (point / cell_m).array().floor().cast<int>();
    Sum& sum = cells[{at.x(), at.y(), at.z()}];
    sum.point += point;
    ++sum.count;
  }
  std::vector<Eigen::Vector3d> thinned;
  for (const auto& [at, sum] : cells) thinned.push_back(sum.point / sum.count);
  return thinned;
}

// Point-to-plane ICP from the identity. The published pose is an estimate, not the truth, hence
// tolerances in degrees and centimetres.
TEST(GicpScans, IcpFromIdentityReachesThePublishedPose) {
  SEXTANT_REAL_DATA(folder, "gicp");
  const Expected<PointCloud> target = ReadCloud(folder / "target.ply");
  const Expected<PointCloud> source = ReadCloud(folder / "source.ply");
  ASSERT_TRUE(target) << target.error().message;
  ASSERT_TRUE(source) << source.error().message;
  constexpr double kCell_m = 0.25;
  const Expected<IcpFit> fit =
      FitIcp(Thinned(target->points, kCell_m), Thinned(source->points, kCell_m), Rigid3d{},
             {.metric = IcpMetric::kPlane, .max_distance_m = 1.0});
  ASSERT_TRUE(fit) << fit.error().message;
  const Eigen::Matrix4d published = ReadMatrix(folder / "T_target_source.txt");
  const Eigen::Quaterniond rotation(Eigen::Matrix3d(published.topLeftCorner<3, 3>()));
  const double angle_deg =
      fit->target_from_source.rotation.angularDistance(rotation) * 180.0 / std::numbers::pi;
  const double distance_m =
      (fit->target_from_source.translation - published.topRightCorner<3, 1>()).norm();
  RecordProperty("angle_deg", std::to_string(angle_deg));
  RecordProperty("distance_m", std::to_string(distance_m));
  EXPECT_LT(angle_deg, 0.5);
  EXPECT_LT(distance_m, 0.03);
}

}  // namespace
}  // namespace sextant
