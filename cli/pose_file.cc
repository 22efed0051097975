// SPDX-License-Identifier: Apache-2.0
#include "cli/pose_file.h"

#include <fmt/core.h>

#include <cmath>

#include "io/problems/transform_list.h"
#include "io/results/results_json.h"
#include "io/text/text_file.h"
#include "io/text/yaml_fields.h"

namespace sextant::cli {
namespace {

Expected<Rigid3d> FromResults(const std::string& path) {
  const Expected<ResultFile> results = ReadResults(path);
  if (!results) return tl::unexpected<Error>(results.error());
  for (const SolverResult& result : results->results) {
    if (result.report) return result.report->cam_from_lidar;
  }
  return MakeError(ErrorCode::kMissingData, path + ": expected a result with an answer");
}

// Other keys, of this or a later version, are ignored.
Expected<Rigid3d> ParsePoseYaml(std::string_view text, const std::string& file) {
  SEXTANT_ASSIGN_OR_RETURN(const YamlNode root, ParseYaml(text, file));
  const YamlNode* node = root.Find("cam_from_lidar");
  if (node == nullptr) {
    return MakeError(ErrorCode::kMissingData,
                     file + ": expected the key cam_from_lidar, as result.yaml has it");
  }
  YamlFields in(file);
  Rigid3d pose;
  double wxyz[4] = {};
  pose.translation = in.PointAt(*node, "translation_m");
  in.Reals(in.Require(*node, "quaternion_wxyz"), "quaternion_wxyz", wxyz);
  pose.rotation = Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
  const double length = pose.rotation.norm();
  if (in.ok() && !(std::abs(length - 1.0) < 1e-5)) {
    in.Fail(node->line, "quaternion_wxyz", fmt::format("expected length 1, got {:g}", length));
  }
  if (!in.ok()) return in.TakeError();
  pose.rotation.normalize();
  return pose;
}

}  // namespace

Expected<Rigid3d> ReadPoseFile(const std::string& path) {
  if (path.ends_with(".json")) return FromResults(path);
  if (path.ends_with(".yaml") || path.ends_with(".yml")) return ReadWith(path, ParsePoseYaml);
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<Rigid3d> poses, ReadTransformList(path));
  return poses.front();
}

}  // namespace sextant::cli
