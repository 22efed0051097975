// SPDX-License-Identifier: Apache-2.0
#include "io/problems/acfr_poses.h"

#include <fmt/core.h>

#include <algorithm>

#include "io/text/line_reader.h"
#include "io/text/max_id.h"
#include "io/text/text_file.h"
#include "solvers/matching/corner_order.h"

namespace sextant {
namespace {

constexpr double kMetresPerMm = 1e-3;

Eigen::Vector3d ReadRow(LineReader& in, std::string_view what) {
  Eigen::Vector3d row = Eigen::Vector3d::Zero();
  if (!in.Require(what) || !in.HasFields(3, what)) return row;
  for (int k = 0; k < 3; ++k) row[k] = in.Real(static_cast<std::size_t>(k));
  return row;
}

AcfrBoardView ReadView(LineReader& in, const char* sensor) {
  AcfrBoardView view;
  view.centre_m = kMetresPerMm * ReadRow(in, fmt::format("x,y,z of the {} centre (mm)", sensor));
  view.normal = ReadRow(in, fmt::format("x,y,z of the {} normal", sensor));
  for (std::size_t i = 0; i < 4; ++i) {
    view.corners_m[i] =
        kMetresPerMm * ReadRow(in, fmt::format("x,y,z of {} corner {} of 4 (mm)", sensor, i + 1));
  }
  return view;
}

void ReadSizes(LineReader& in, AcfrPose& pose) {
  const Eigen::Vector3d angles = ReadRow(in, "two angles and 0 (deg)");
  const Eigen::Vector3d other_angles = ReadRow(in, "two angles and 0 (deg)");
  const Eigen::Vector3d widths = kMetresPerMm * ReadRow(in, "two widths and 0 (mm)");
  const Eigen::Vector3d heights = kMetresPerMm * ReadRow(in, "two heights and 0 (mm)");
  pose.angles_deg = {angles[0], angles[1], other_angles[0], other_angles[1]};
  pose.widths_m = {widths[0], widths[1]};
  pose.heights_m = {heights[0], heights[1]};
  pose.distance_m = ReadRow(in, "distance (m),0,0").x();
  pose.m_per_px = ReadRow(in, "metres per pixel,0,0").x();
  if (in.Require("number of the pose,0,0") && in.HasFields(3, "number of the pose,0,0")) {
    pose.id = static_cast<int>(in.Integer(0, 0, kMaxId));
  }
}

// Indices of the camera's corners from the top (smallest y), clockwise in the image.
std::array<std::size_t, 4> FromTheTop(const std::array<Eigen::Vector3d, 4>& corners) {
  std::size_t top = 0;
  double twice_area = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (corners[i].y() < corners[top].y()) top = i;
    const Eigen::Vector3d& a = corners[i];
    const Eigen::Vector3d& b = corners[(i + 1) % 4];
    twice_area += (a.x() * b.y() - b.x() * a.y()) / (a.z() * b.z());
  }
  std::array<std::size_t, 4> order{};
  for (std::size_t k = 0; k < 4; ++k) order[k] = (top + (twice_area > 0.0 ? k : 4 - k)) % 4;
  return order;
}

CornerGroup GroupOf(const AcfrPose& pose) {
  CornerGroup group;
  for (const std::size_t i : FromTheTop(pose.in_cam.corners_m)) {
    group.in_b.push_back(pose.in_cam.corners_m[i]);
  }
  group.in_a.assign(pose.in_lidar.corners_m.begin(), pose.in_lidar.corners_m.end());
  return group;
}

}  // namespace

Expected<std::vector<AcfrPose>> ReadAcfrPoses(const std::filesystem::path& path) {
  return ReadWith(path, ParseAcfrPoses);
}

Expected<std::vector<AcfrPose>> ParseAcfrPoses(std::string_view text, const std::string& file) {
  std::vector<AcfrPose> poses;
  LineReader in(file, text, LineReader::Separator::kCommas);
  do {
    AcfrPose pose;
    pose.in_cam = ReadView(in, "camera");
    pose.in_lidar = ReadView(in, "LiDAR");
    ReadSizes(in, pose);
    poses.push_back(pose);
  } while (in.ok() && !in.AtEnd());
  if (!in.ok()) return in.TakeError();
  return poses;
}

Expected<std::vector<int>> RelabelledAcfrPoses(std::span<const AcfrPose> poses) {
  std::vector<CornerGroup> groups;
  for (const AcfrPose& pose : poses) {
    groups.push_back({{pose.in_cam.corners_m.begin(), pose.in_cam.corners_m.end()},
                      {pose.in_lidar.corners_m.begin(), pose.in_lidar.corners_m.end()}});
  }
  SEXTANT_ASSIGN_OR_RETURN(const CornerOrderFit fit, ResolveCornerOrders(groups));
  const auto usual = std::ranges::max_element(fit.orders, {}, [&](const CornerOrder& order) {
    return std::ranges::count(fit.orders, order);
  });
  std::vector<int> relabelled;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    if (fit.orders[i] != *usual) relabelled.push_back(poses[i].id);
  }
  return relabelled;
}

Expected<CalibrationProblem> ProblemFromAcfrPoses(std::span<const AcfrPose> poses,
                                                  AcfrPoints points) {
  std::vector<CornerGroup> groups;
  for (const AcfrPose& pose : poses) groups.push_back(GroupOf(pose));
  SEXTANT_ASSIGN_OR_RETURN(const CornerOrderFit fit, ResolveCornerOrders(groups));
  CalibrationProblem problem;
  const auto add = [&problem](const Eigen::Vector3d& in_cam, const Eigen::Vector3d& in_lidar,
                              PairId id) {
    Pair3d3d& pair = problem.pairs_3d3d.emplace_back();
    pair.point_in_cam = in_cam;
    pair.point_in_lidar = in_lidar;
    pair.id = id;
  };
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const int view = static_cast<int>(i);
    for (int k = 0; k < kCornersPerBoard; ++k) {
      const int in_lidar = fit.orders[i].IndexInA(k, kCornersPerBoard);
      add(groups[i].in_b[static_cast<std::size_t>(k)],
          groups[i].in_a[static_cast<std::size_t>(in_lidar)],
          {.view = view, .board = 0, .corner = k});
    }
    if (points == AcfrPoints::kCornersAndCentres) {
      add(poses[i].in_cam.centre_m, poses[i].in_lidar.centre_m,
          {.view = view, .board = 0, .corner = kAcfrCentre});
    }
  }
  problem.point_sets = WithholdPairing(problem.pairs_3d3d);
  return problem;
}

}  // namespace sextant
