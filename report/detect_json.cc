// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>

#include "base/text/escape.h"
#include "base/version.h"
#include "io/blocks/json_blocks.h"
#include "report/detect_report.h"

namespace sextant {
namespace {

using nlohmann::ordered_json;

ordered_json Rows(const Eigen::MatrixXd& matrix) {
  ordered_json rows = ordered_json::array();
  for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
    ordered_json row = ordered_json::array();
    for (Eigen::Index j = 0; j < matrix.cols(); ++j) row.push_back(matrix(i, j));
    rows.push_back(std::move(row));
  }
  return rows;
}

template <class Points>
ordered_json PixelsJson(const Points& points) {
  ordered_json list = ordered_json::array();
  for (const Eigen::Vector2d& point : points) list.push_back({point.x(), point.y()});
  return list;
}

ordered_json TagJson(const TagDetection& tag) {
  return {{"family", tag.family},
          {"id", tag.id},
          {"corners_px", PixelsJson(tag.corners_px)},
          {"decision_margin", tag.decision_margin},
          {"hamming", tag.hamming}};
}

ordered_json CheckerJson(const CheckerDetection& checker) {
  return {{"inner_columns", checker.inner_columns},
          {"inner_rows", checker.inner_rows},
          {"corners_px", PixelsJson(checker.corners_px)},
          {"is_turn_known", checker.is_turn_known}};
}

ordered_json SeenTagJson(const SeenTag& seen) {
  ordered_json tag = TagJson(seen.detection);
  tag["refined"] = seen.refined.has_value();
  if (!seen.refined) {
    tag["not_refined"] = seen.refined.error().message;
    return tag;
  }
  tag["corners_px"] = PixelsJson(seen.refined->corners_px);
  tag["covariance_px2"] = Rows(seen.refined->covariance_px2);
  tag["blur_px"] = seen.refined->blur_px;
  tag["noise_grey"] = seen.refined->noise_grey;
  return tag;
}

ordered_json BoardPoseJson(const BoardPose& pose) {
  ordered_json result = {{"cam_from_board", PoseJson(pose.cam_from_board)},
                         {"covariance", Rows(pose.covariance)},
                         {"rms_px", pose.rms_px},
                         {"chi_square", pose.chi_square},
                         {"residuals", pose.residuals},
                         {"ambiguous_with", nullptr}};
  if (pose.ambiguous_with) result["ambiguous_with"] = PoseJson(*pose.ambiguous_with);
  return result;
}

ordered_json BoardJson(const ImageReport& report, const SeenBoard& seen, const Board& board) {
  ordered_json result = {{"board", board.id}, {"name", board.name}};
  result["tags"] = ordered_json::array();
  for (const SeenTag& tag : seen.tags) result["tags"].push_back(SeenTagJson(tag));
  result["missing"] = ordered_json::array();
  for (const ExplainedTag& missing : report.missing) {
    if (missing.board != seen.index) continue;
    const BoardTag& tag = board.tags[missing.tag];
    result["missing"].push_back({{"family", tag.family},
                                 {"id", tag.id},
                                 {"cause", ToString(missing.why.cause)},
                                 {"text", missing.why.text}});
  }
  result["duplicates"] = ordered_json::array();
  for (const std::size_t tag : seen.duplicate_tags) {
    result["duplicates"].push_back(board.tags[tag].id);
  }
  result["checker_px"] = nullptr;
  if (seen.checker) result["checker_px"] = PixelsJson(seen.checker->corners_px);
  result["pose"] = nullptr;
  if (!seen.pose || !*seen.pose) return result;
  result["pose"] = BoardPoseJson(**seen.pose);
  result["corners_in_cam_m"] = ordered_json::array();
  for (const Eigen::Vector3d& corner : seen.corners.points) {
    result["corners_in_cam_m"].push_back({corner.x(), corner.y(), corner.z()});
  }
  result["corners_covariance_m2"] = Rows(seen.corners.covariance);
  return result;
}

}  // namespace

std::string FormatDetections(const std::vector<std::string>& paths,
                             const std::vector<ImageResult>& results,
                             const std::vector<Board>& boards) {
  ordered_json document = {{"sextant", Version()}, {"images", ordered_json::array()}};
  for (std::size_t i = 0; i < results.size(); ++i) {
    ordered_json image = {{"path", paths[i]}, {"error", nullptr}};
    if (!results[i]) {
      image["error"] = {{"code", ToString(results[i].error().code)},
                        {"message", results[i].error().message}};
    } else {
      const ImageReport& report = *results[i];
      image["width_px"] = report.size.width;
      image["height_px"] = report.size.height;
      image["boards"] = ordered_json::array();
      for (const SeenBoard& seen : report.seen.boards) {
        image["boards"].push_back(BoardJson(report, seen, boards[seen.index]));
      }
      image["other_tags"] = ordered_json::array();
      for (const TagDetection& tag : report.seen.other_tags) {
        image["other_tags"].push_back(TagJson(tag));
      }
      image["other_checkers"] = ordered_json::array();
      for (const CheckerDetection& checker : report.checkers) {
        image["other_checkers"].push_back(CheckerJson(checker));
      }
      image["other_families"] = ordered_json::array();
      for (const FamilyMatch& match : report.other_families) {
        image["other_families"].push_back({{"family", match.family}, {"ids", match.ids}});
      }
    }
    document["images"].push_back(std::move(image));
  }
  return JsonText(document);
}

}  // namespace sextant
