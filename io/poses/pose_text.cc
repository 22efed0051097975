// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <Eigen/Core>
#include <map>
#include <optional>

#include "geometry/coordinate_range.h"
#include "io/blocks/rigid_matrix.h"
#include "io/poses/pose_parts.h"
#include "io/problems/transform_list.h"
#include "io/text/line_reader.h"

namespace sextant {
namespace {

using Rows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
using KittiLines = std::map<std::string, std::vector<double>, std::less<>>;

// The lines "key: numbers"; others (a date) are left out.
Expected<KittiLines> ReadKittiLines(std::string_view text, const std::string& file) {
  LineReader in(file, text);
  KittiLines lines;
  while (in.Next()) {
    std::string key(in.Field(0));
    if (!key.ends_with(':')) continue;
    key.pop_back();
    const bool is_matrix =
        in.field_count() == 4 || in.field_count() == 10 || in.field_count() == 13;
    if (!is_matrix || key.starts_with("calib") || key.starts_with("corner")) continue;
    std::vector<double> numbers;
    for (std::size_t i = 1; i < in.field_count(); ++i) numbers.push_back(in.Real(i, key));
    const auto [at, is_new] = lines.emplace(key, numbers);
    if (!is_new && at->second != numbers) {
      in.Fail(ErrorCode::kParse, "contradicts the earlier line " + key + "; expected one of them");
    }
  }
  if (!in.ok()) return in.TakeError();
  return lines;
}

std::optional<Rigid3d> RigidOf(const std::vector<double>& n) {
  Eigen::Matrix4d matrix = Eigen::Matrix4d::Identity();
  if (n.size() == 12) matrix.topRows<3>() = Eigen::Map<const Rows>(n.data());
  if (n.size() == 9) {
    matrix.topLeftCorner<3, 3>() =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(n.data());
  }
  return RigidFromMatrix(matrix);
}

// The camera's place against the rectified camera 0: K^-1 times the fourth column of P.
Eigen::Vector3d OffsetOf(const std::vector<double>& n) {
  const Eigen::Map<const Rows> p(n.data());
  return p.leftCols<3>().inverse() * p.col(3);
}

bool IsProjection(const std::string& key) {
  return (key.size() == 2 && key[0] == 'P') || key.starts_with("P_rect_");
}

Expected<Eigen::Vector3d> ChosenOffset(const KittiLines& lines, const std::string& file,
                                       std::string_view name) {
  std::optional<Eigen::Vector3d> chosen;
  for (const auto& [key, numbers] : lines) {
    if (!IsProjection(key) || numbers.size() != 12) continue;
    if (!name.empty() && key != name) continue;
    const Eigen::Vector3d offset = OffsetOf(numbers);
    if (!(offset.array().abs() <= kMaxCoordinate_m).all()) {
      return MakeError(ErrorCode::kParse,
                       fmt::format("{}: {}: expected the 12 numbers of a projection, with focal "
                                   "lengths and a place of the camera",
                                   file, key));
    }
    if (chosen && (*chosen - offset).norm() > 1e-6) {
      return MakeError(ErrorCode::kInvalidOption,
                       fmt::format("{0}: has several cameras, which are in different places; "
                                   "choose one, as in {0}:P2",
                                   file));
    }
    chosen = offset;
  }
  if (!name.empty() && !chosen) {
    return MakeError(ErrorCode::kUnknownName,
                     fmt::format("{}: expected a projection {}", file, Quoted(name)));
  }
  return chosen.value_or(Eigen::Vector3d::Zero());
}

// The order of the quaternion by a comment; by the axes of the camera where there is none.
Expected<Rigid3d> OfOrder(std::string_view text, const Rigid3d& w_last, const Rigid3d& w_first,
                          const std::string& file) {
  const bool says_last = text.find("qx qy qz qw") != std::string_view::npos;
  const bool says_first = text.find("qw qx qy qz") != std::string_view::npos;
  if (says_last != says_first) return says_last ? w_last : w_first;
  if (Agree(w_last, w_first) || !IsUprightEitherWay(w_first)) return w_last;
  return MakeError(
      ErrorCode::kInvalidOption,
      fmt::format("{}: the camera is upright {}; add the comment '# x y z qx qy qz qw' or "
                  "'# x y z qw qx qy qz', or write a 4x4 matrix",
                  file,
                  IsUprightEitherWay(w_last)
                      ? "with the quaternion read as x y z w, and as w x y z too"
                      : "only with the quaternion read as w x y z, not as x y z w"));
}

// Seven numbers on one line: x y z qx qy qz qw.
Expected<StatedPose> FromSevenNumbers(std::string_view text, const std::string& file) {
  LineReader in(file, text);
  in.Next();
  std::array<double, 7> n{};
  for (std::size_t i = 0; i < 7; ++i) n[i] = in.Real(i);
  if (in.ok() && !in.AtEnd()) in.Fail(ErrorCode::kParse, "expected one line x y z qx qy qz qw");
  if (!in.ok()) return in.TakeError();
  const std::array<double, 3> xyz = {n[0], n[1], n[2]};
  SEXTANT_ASSIGN_OR_RETURN(const Rigid3d w_last,
                           PoseOfNumbers(xyz, {n[6], n[3], n[4], n[5]}, file, in.line()));
  SEXTANT_ASSIGN_OR_RETURN(const Rigid3d w_first,
                           PoseOfNumbers(xyz, {n[3], n[4], n[5], n[6]}, file, in.line()));
  SEXTANT_ASSIGN_OR_RETURN(const Rigid3d transform, OfOrder(text, w_last, w_first, file));
  return StatedPose{.transform = transform};
}

// The matrix with the number `name`, from 1; without a name all must be the same.
Expected<Rigid3d> ChosenMatrix(const std::vector<Rigid3d>& matrices, const std::string& file,
                               std::string_view name) {
  for (std::size_t i = 0; i < matrices.size(); ++i) {
    if (name == std::to_string(i + 1)) return matrices[i];
    if (!name.empty() || Agree(matrices[i], matrices.front())) continue;
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format("{0}: has {1} matrices, and the first and number {2} differ; choose "
                    "one by its number, as in {0}:{2}",
                    file, matrices.size(), i + 1));
  }
  if (name.empty()) return matrices.front();
  return MakeError(ErrorCode::kUnknownName,
                   fmt::format("{}: expected the number of a matrix from 1 to {}, got {}", file,
                               matrices.size(), Quoted(name)));
}

// "# cam_from_lidar" in a comment, as the format `matrix` of sextant export has it.
std::optional<PoseDirection> CommentedDirection(std::string_view text) {
  for (const PoseDirection direction :
       {PoseDirection::kCamFromLidar, PoseDirection::kLidarFromCam}) {
    if (text.find("# " + std::string(ToString(direction))) != std::string_view::npos) {
      return direction;
    }
  }
  return std::nullopt;
}

}  // namespace

Expected<StatedPose> ParsePoseKitti(std::string_view text, const std::string& file,
                                    std::string_view name) {
  SEXTANT_ASSIGN_OR_RETURN(const KittiLines lines, ReadKittiLines(text, file));
  const auto numbers = [&](std::string_view key) {
    const auto found = lines.find(key);
    return found == lines.end() ? std::vector<double>() : found->second;
  };
  std::vector<double> tr = numbers("Tr_velo_to_cam");
  if (tr.empty()) tr = numbers("Tr_velo_cam");
  if (tr.empty()) tr = numbers("Tr");
  const bool is_raw = tr.empty();
  if (is_raw) tr = numbers("R");
  std::optional<Rigid3d> pose = RigidOf(tr);
  if (tr.empty() || !pose) {
    return MakeError(ErrorCode::kParse,
                     file +
                         ": expected a rotation and a translation in the line Tr_velo_to_cam, "
                         "Tr, or R and T");
  }
  if (is_raw) {
    const std::vector<double> t = numbers("T");
    if (t.size() != 3) return MakeError(ErrorCode::kParse, file + ": expected T: x y z beside R");
    pose->translation = Eigen::Vector3d(t[0], t[1], t[2]);
    StatedPose stated{.transform = *pose};
    RecogniseByAxes(stated);
    return stated;
  }
  SEXTANT_ASSIGN_OR_RETURN(const Eigen::Vector3d offset, ChosenOffset(lines, file, name));
  std::vector<double> rectified = numbers("R0_rect");
  if (rectified.empty()) rectified = numbers("R_rect");
  if (!rectified.empty()) {
    const std::optional<Rigid3d> rotation = RigidOf(rectified);
    if (!rotation) return MakeError(ErrorCode::kParse, file + ": expected a rotation as R0_rect");
    *pose = *rotation * *pose;
  }
  pose->translation += offset;
  return StatedPose{.transform = *pose,
                    .direction = PoseDirection::kCamFromLidar,
                    .basis = "KITTI's Tr maps points of the LiDAR into the camera",
                    .camera_frame = "camera",
                    .lidar_frame = "velodyne"};
}

Expected<StatedPose> ParsePoseNumbers(std::string_view text, const std::string& file,
                                      std::string_view name) {
  LineReader first(file, text);
  StatedPose pose;
  if (first.Next() && first.field_count() == 7 && name.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(pose, FromSevenNumbers(text, file));
  } else {
    const std::string with_last_row = std::string(text) + "\n0 0 0 1\n";
    Expected<std::vector<Rigid3d>> list = ParseTransformList(text, file);
    if (!list) {
      const Expected<std::vector<Rigid3d>> of_rows = ParseTransformList(with_last_row, file);
      if (!of_rows || of_rows->size() != 1) return tl::unexpected<Error>(list.error());
      list = of_rows;
    }
    SEXTANT_ASSIGN_OR_RETURN(pose.transform, ChosenMatrix(*list, file, name));
  }
  pose.direction = CommentedDirection(text);
  if (!pose.direction) {
    RecogniseByAxes(pose);
    return pose;
  }
  pose.basis = "its comment";
  pose.camera_frame = "camera";
  pose.lidar_frame = "lidar";
  return pose;
}

}  // namespace sextant
