// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>

#include "io/blocks/board_block.h"
#include "io/blocks/board_view_block.h"
#include "io/blocks/camera_block.h"
#include "io/blocks/pose_block.h"
#include "io/problems/problem_yaml.h"
#include "io/text/max_id.h"
#include "io/text/text_file.h"
#include "io/text/yaml_fields.h"

namespace sextant {
namespace {

using Keys = std::vector<std::string>;

// The id of a pair; without one, pair i is corner i mod 4 of board i / 4, as in points.txt.
PairId ReadId(YamlFields& in, const YamlNode& pair, std::size_t index) {
  const YamlNode* node = pair.Find("id");
  if (node == nullptr) {
    const int i = static_cast<int>(index);
    return {.view = 0, .board = i / kCornersPerBoard, .corner = i % kCornersPerBoard};
  }
  static const Keys kKeys = {"view", "board", "corner"};
  PairId id;
  if (!in.IsMap(*node, "id", kKeys)) return id;
  if (node->Find("view") != nullptr) id.view = in.IntegerAt(*node, "view", 0, kMaxId);
  id.board = in.IntegerAt(*node, "board", 0, kMaxId);
  id.corner = in.IntegerAt(*node, "corner", 0, kMaxId);
  return id;
}

void ReadPairs3d3d(YamlFields& in, const YamlNode& list, std::vector<Pair3d3d>& pairs) {
  static const Keys kKeys = {"id", "point_in_cam", "point_in_lidar", "sigma_m",
                             "covariance_in_cam_m2"};
  if (!in.IsSequence(list, "pairs_3d3d")) return;
  for (const YamlNode& node : list.items) {
    if (!in.IsMap(node, "pairs_3d3d", kKeys)) return;
    Pair3d3d pair;
    pair.point_in_cam = in.PointAt(node, "point_in_cam");
    pair.point_in_lidar = in.PointAt(node, "point_in_lidar");
    pair.sigma_m = in.NonNegativeAt(node, "sigma_m", 0.0);
    if (const YamlNode* covariance = node.Find("covariance_in_cam_m2")) {
      in.Reals(*covariance, "covariance_in_cam_m2", {pair.covariance_in_cam.emplace().data(), 9});
    }
    pair.id = ReadId(in, node, pairs.size());
    pairs.push_back(pair);
  }
}

void ReadPairs2d3d(YamlFields& in, const YamlNode& list, std::vector<Pair2d3d>& pairs) {
  static const Keys kKeys = {"id", "pixel", "point_in_lidar", "sigma_px"};
  if (!in.IsSequence(list, "pairs_2d3d")) return;
  for (const YamlNode& node : list.items) {
    if (!in.IsMap(node, "pairs_2d3d", kKeys)) return;
    Pair2d3d pair;
    in.Reals(in.Require(node, "pixel"), "pixel", {pair.pixel.data(), 2});
    pair.point_in_lidar = in.PointAt(node, "point_in_lidar");
    pair.sigma_px = in.NonNegativeAt(node, "sigma_px", 0.0);
    pair.id = ReadId(in, node, pairs.size());
    pairs.push_back(pair);
  }
}

std::vector<Eigen::Vector3d> ReadPointList(YamlFields& in, const YamlNode& list,
                                           std::string_view what) {
  std::vector<Eigen::Vector3d> points;
  if (!in.IsSequence(list, what)) return points;
  for (const YamlNode& node : list.items) points.push_back(in.Point(node, what));
  return points;
}

void ReadProblemBoards(YamlFields& in, const YamlNode& list, std::vector<Board>& boards) {
  static const Keys kKeys = {"id", "top_right_m", "right_bottom_m", "hole", "round_holes"};
  if (!in.IsSequence(list, "boards", kMaxBoards)) return;
  for (const YamlNode& node : list.items) {
    if (!in.IsMap(node, "boards", kKeys)) return;
    in.Require(node, "top_right_m");
    in.Require(node, "right_bottom_m");
    Board board;
    board.id = in.IntegerAt(node, "id", 0, kMaxId);
    board.top_right_m = in.NonNegativeAt(node, "top_right_m", 0.0);
    board.right_bottom_m = in.NonNegativeAt(node, "right_bottom_m", 0.0);
    ReadOpenings(in, node, board);
    boards.push_back(board);
  }
}

void ReadProblemHeader(YamlFields& in, const YamlNode& root) {
  static const Keys kKeys = {"sextant_problem",
                             "comment",
                             "camera",
                             "boards",
                             "pairs_3d3d",
                             "pairs_2d3d",
                             "board_views",
                             "lidar_errors",
                             "point_sets",
                             "truth",
                             "initial_cam_from_lidar"};
  if (root.kind == YamlNode::Kind::kMap && root.Find("sextant_rig") != nullptr) {
    in.Fail(root.line, {},
            "expected a problem of one camera and one LiDAR; this is a rig file: run 'sextant rig' "
            "with it");
  }
  if (root.kind == YamlNode::Kind::kMap && root.Find("sextant_problem") == nullptr) {
    in.Fail(root.line, {},
            "expected a problem file, with the key sextant_problem: 1; is this another kind of "
            "YAML, such as a camera file?");
  }
  if (!in.IsMap(root, "sextant_problem", kKeys)) return;
  in.IntegerAt(root, "sextant_problem", 1, 1);
}

}  // namespace

Expected<ProblemFile> ReadProblemYaml(const std::filesystem::path& path) {
  return ReadWith(path, ParseProblemYaml);
}

Expected<ProblemFile> ParseProblemYaml(std::string_view text, const std::string& file) {
  SEXTANT_ASSIGN_OR_RETURN(const YamlNode root, ParseYaml(text, file));
  YamlFields in(file);
  ReadProblemHeader(in, root);
  if (!in.ok()) return in.TakeError();

  ProblemFile read;
  CalibrationProblem& problem = read.problem;
  if (root.Find("comment") != nullptr) {
    read.comment = in.ParagraphAt(root, "comment");
    std::ranges::replace(read.comment, '\n', ' ');
  }
  if (const YamlNode* node = root.Find("camera")) problem.camera = ReadCameraBlock(in, *node);
  if (const YamlNode* node = root.Find("boards")) ReadProblemBoards(in, *node, problem.boards);
  if (const YamlNode* node = root.Find("initial_cam_from_lidar")) {
    problem.initial_cam_from_lidar = ReadPoseBlock(in, *node, "initial_cam_from_lidar");
  }
  if (const YamlNode* node = root.Find("pairs_3d3d")) ReadPairs3d3d(in, *node, problem.pairs_3d3d);
  if (const YamlNode* node = root.Find("pairs_2d3d")) ReadPairs2d3d(in, *node, problem.pairs_2d3d);
  if (const YamlNode* node = root.Find("lidar_errors")) {
    problem.lidar_errors = ReadLidarErrors(in, *node);
  }
  if (const YamlNode* node = root.Find("board_views")) {
    problem.board_views = ReadBoardViews(in, *node, problem.boards);
  }
  problem.point_sets = WithholdPairing(problem.pairs_3d3d);
  if (const YamlNode* node = root.Find("point_sets")) {
    static const Keys kKeys = {"in_cam", "in_lidar"};
    if (in.IsMap(*node, "point_sets", kKeys)) {
      problem.point_sets.in_cam = ReadPointList(in, in.Require(*node, "in_cam"), "in_cam");
      problem.point_sets.in_lidar = ReadPointList(in, in.Require(*node, "in_lidar"), "in_lidar");
    }
  }
  if (const YamlNode* node = root.Find("truth")) {
    static const Keys kKeys = {"cam_from_lidar"};
    if (in.IsMap(*node, "truth", kKeys)) {
      read.true_cam_from_lidar =
          ReadPoseBlock(in, in.Require(*node, "cam_from_lidar"), "cam_from_lidar");
    }
  }
  if (!in.ok()) return in.TakeError();
  return read;
}

}  // namespace sextant
