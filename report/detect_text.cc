// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <cmath>
#include <string_view>

#include "base/units.h"
#include "report/detect_report.h"

namespace sextant {
namespace {

double MeanSide(const Quad& quad) {
  double sum = 0.0;
  for (std::size_t k = 0; k < 4; ++k) sum += 0.25 * (quad[(k + 1) % 4] - quad[k]).norm();
  return sum;
}

std::string DescribeTag(const TagDetection& tag, const Quad& corners) {
  std::string text = fmt::format("tag {} of {}:", tag.id, tag.family);
  for (const Eigen::Vector2d& corner : corners) {
    text += fmt::format(" ({:.2f}, {:.2f})", corner.x(), corner.y());
  }
  return text + fmt::format(", {:.0f} px per side, margin {:.0f}, {} wrong bits", MeanSide(corners),
                            tag.decision_margin, tag.hamming);
}

std::string DescribeSeenTag(const SeenTag& seen) {
  if (!seen.refined) {
    return fmt::format("    {}\n      not refined: {}\n",
                       DescribeTag(seen.detection, seen.detection.corners_px),
                       seen.refined.error().message);
  }
  const double sigma = std::sqrt(seen.refined->covariance_px2.trace() / 8.0);
  return fmt::format("    {}, 1 sigma {:.3f} px, blur {:.2f} px\n",
                     DescribeTag(seen.detection, seen.refined->corners_px), sigma,
                     seen.refined->blur_px);
}

// The choice among the orientations that are possible.
constexpr std::string_view kAssumedUpright = ", in the orientation with its corner 0 at the top";

std::string DescribeChecker(const CheckerDetection& checker) {
  std::string text =
      fmt::format("  checkerboard of {} x {} inner corners{}:", checker.inner_columns,
                  checker.inner_rows, checker.is_turn_known ? "" : kAssumedUpright);
  const auto columns = static_cast<std::size_t>(checker.inner_columns);
  for (std::size_t i = 0; i < checker.corners_px.size(); ++i) {
    const Eigen::Vector2d& corner = checker.corners_px[i];
    if (i % columns == 0) text += "\n   ";
    text += fmt::format(" ({:.2f}, {:.2f})", corner.x(), corner.y());
  }
  return text + "\n";
}

std::string DescribePose(const SeenBoard& board) {
  const BoardPose& pose = **board.pose;
  const Eigen::Vector3d& t = pose.cam_from_board.translation;
  const EulerZyx euler = ToEulerZyx(pose.cam_from_board.rotation);
  const Vector6d sigma = pose.covariance.diagonal().cwiseSqrt();
  std::string text = fmt::format(
      "    cam_from_board: {:.4f} {:.4f} {:.4f} m, yaw {:.3f} pitch {:.3f} roll {:.3f} deg, "
      "reprojection {:.3f} px\n      1 sigma: {:.2f} {:.2f} {:.2f} mm, {:.3f} {:.3f} {:.3f} deg\n",
      t.x(), t.y(), t.z(), euler.yaw * kDegPerRad, euler.pitch * kDegPerRad,
      euler.roll * kDegPerRad, pose.rms_px, 1e3 * sigma[3], 1e3 * sigma[4], 1e3 * sigma[5],
      kDegPerRad * sigma[0], kDegPerRad * sigma[1], kDegPerRad * sigma[2]);
  for (std::size_t k = 0; k < board.corners.points.size(); ++k) {
    const Eigen::Vector3d& corner = board.corners.points[k];
    const Eigen::Vector3d off = board.corners.CovarianceOf(k).diagonal().cwiseSqrt() * 1e3;
    text += fmt::format("    corner {}: {:.4f} {:.4f} {:.4f} m, 1 sigma {:.2f} {:.2f} {:.2f} mm\n",
                        k, corner.x(), corner.y(), corner.z(), off.x(), off.y(), off.z());
  }
  if (pose.ambiguous_with) {
    text += fmt::format(
        "    ambiguous: the opposite tilt, {:.1f} deg from this, fits about as well "
        "(chi-square +{:.1f}); add a tag to the board or move it nearer\n",
        kDegPerRad * DistanceBetween(pose.cam_from_board, *pose.ambiguous_with).rotation_rad,
        pose.ambiguity_chi_square);
  }
  return text;
}

std::string DescribeBoard(const ImageReport& report, const SeenBoard& seen, const Board& board) {
  const std::size_t expected = board.tags.size();
  std::string text =
      fmt::format("  board {}{}", board.id, board.name.empty() ? "" : " " + board.name);
  if (expected > 0) text += fmt::format(": {} of {} tags", seen.tags.size(), expected);
  if (board.checker && board.checker->holds_tags) {
    text += fmt::format(", {} of {} corners between them",
                        seen.is_checker_missing ? 0 : seen.printed.front().pixels.size(),
                        board.checker->inner_columns * board.checker->inner_rows);
  } else if (board.checker) {
    text += fmt::format(": checkerboard of {} x {} inner corners {}", board.checker->inner_columns,
                        board.checker->inner_rows, seen.checker ? "found" : "not found");
    if (seen.checker && !seen.checker->is_turn_known) {
      text += kAssumedUpright;
    }
  }
  text += "\n";
  // Between tags in a checkerboard, its corners count, and the tags' own corners are not needed.
  const bool counts_tags = !board.checker || !board.checker->holds_tags || seen.is_checker_missing;
  for (const SeenTag& tag : seen.tags) {
    text += counts_tags
                ? DescribeSeenTag(tag)
                : fmt::format("    {}\n", DescribeTag(tag.detection, tag.detection.corners_px));
  }
  for (const std::size_t tag : seen.duplicate_tags) {
    text += fmt::format("    tag {} of {}: found more than once, so not used\n", board.tags[tag].id,
                        board.tags[tag].family);
  }
  for (const ExplainedTag& missing : report.missing) {
    if (missing.board != seen.index) continue;
    const BoardTag& tag = board.tags[missing.tag];
    text += fmt::format("    tag {} of {} not found: {}\n", tag.id, tag.family, missing.why.text);
  }
  if (!seen.pose) return text;
  return text + (*seen.pose ? DescribePose(seen)
                            : fmt::format("    no pose: {}\n", seen.pose->error().message));
}

}  // namespace

std::string DescribeDetection(const ImageReport& report, const std::vector<Board>& boards) {
  std::string text =
      fmt::format("{} ({} x {})\n", report.path, report.size.width, report.size.height);
  for (const SeenBoard& board : report.seen.boards) {
    text += DescribeBoard(report, board, boards[board.index]);
  }
  if (!boards.empty() && !report.seen.other_tags.empty()) text += "  on no board:\n";
  for (const TagDetection& tag : report.seen.other_tags) {
    text += fmt::format("    {}\n", DescribeTag(tag, tag.corners_px));
  }
  for (const CheckerDetection& checker : report.checkers) text += DescribeChecker(checker);
  if (boards.empty() && report.seen.other_tags.empty() && report.checkers.empty()) {
    text += report.sought_checkers ? "  no checkerboard\n" : "  no tag\n";
  }
  for (const FamilyMatch& match : report.other_families) {
    text += fmt::format("  {} would find: {}\n", match.family, fmt::join(match.ids, ", "));
  }
  return text;
}

}  // namespace sextant
