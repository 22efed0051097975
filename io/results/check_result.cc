// SPDX-License-Identifier: Apache-2.0
#include "io/results/check_result.h"

#include <nlohmann/json.hpp>

#include "base/text/escape.h"
#include "base/units.h"
#include "io/blocks/camera_block.h"
#include "io/blocks/json_blocks.h"
#include "io/results/optional_fields.h"
#include "io/text/yaml_fields.h"

namespace sextant {
namespace {

using CheckJson = nlohmann::ordered_json;

constexpr const char* kCheckKey = "sextant_check";

Vector6d FromDegreesAndMm(Vector6d value) {
  value.head<3>() *= kRadPerDeg;
  value.tail<3>() *= 1e-3;
  return value;
}

void ReadCheckedPairs(YamlFields& in, const YamlNode& root, CheckResult& result) {
  const YamlNode* list = Present(root, "files");
  if (list == nullptr || !in.IsSequence(*list, "files")) return;
  for (const YamlNode& node : list->items) {
    if (!in.ok()) return;
    result.pairs.push_back({.name = in.TextAt(node, "name"),
                            .image_path = in.TextAt(node, "image"),
                            .cloud_path = in.TextAt(node, "cloud")});
  }
}

}  // namespace

std::array<double, 6> InDegreesAndMm(const Vector6d& value) {
  const Vector6d plain =
      (Vector6d() << kDegPerRad * value.head<3>(), 1e3 * value.tail<3>()).finished();
  return {plain[0], plain[1], plain[2], plain[3], plain[4], plain[5]};
}

std::string FormatCheckResult(const CheckResult& result) {
  CheckJson json = {{kCheckKey, 1},
                    {"version", result.version},
                    {"pose", result.pose_path},
                    {"pose_read_as", result.read_as},
                    {"pose_read_by", result.read_by},
                    {"pairs", result.pairs.size()},
                    {"state", result.state},
                    {"change_is_certain", result.is_certain},
                    {"reason", result.reason},
                    {"change_deg_mm", InDegreesAndMm(result.change)}};
  // As an array even where nothing is known, so that readers need no second form.
  json["sigma_deg_mm"] = result.sigma ? CheckJson(InDegreesAndMm(*result.sigma))
                                      : CheckJson(std::vector<CheckJson>(6, nullptr));
  json["detect_deg_mm"] = {kDegPerRad * result.detect_rad, 1e3 * result.detect_m};
  json["cam_from_lidar"] = PoseJson(result.cam_from_lidar);
  if (result.camera) json["camera"] = CameraJson(*result.camera);
  json["files"] = CheckJson::array();
  for (const CheckedPair& pair : result.pairs) {
    json["files"].push_back(
        {{"name", pair.name}, {"image", pair.image_path}, {"cloud", pair.cloud_path}});
  }
  return JsonText(json);
}

Expected<CheckResult> ParseCheckResult(std::string_view text, const std::string& file) {
  SEXTANT_ASSIGN_OR_RETURN(const YamlNode root, ParseYaml(text, file));
  YamlFields in(file);
  if (root.kind != YamlNode::Kind::kMap || root.Find(kCheckKey) == nullptr) {
    in.Fail(root.line, {}, "expected the result of a check, with the key sextant_check");
    return in.TakeError();
  }
  in.IntegerAt(root, kCheckKey, 1, 1);
  CheckResult result{.version = OptionalText(in, root, "version"),
                     .pose_path = in.TextAt(root, "pose"),
                     .read_as = OptionalText(in, root, "pose_read_as"),
                     .read_by = OptionalText(in, root, "pose_read_by"),
                     .state = in.TextAt(root, "state"),
                     .is_certain = in.TextAt(root, "change_is_certain") == "true",
                     .reason = in.TextAt(root, "reason")};
  result.cam_from_lidar = ReadPose(in, in.Require(root, "cam_from_lidar"), "cam_from_lidar");
  if (const YamlNode* camera = Present(root, "camera")) {
    result.camera = ReadCameraBlock(in, *camera);
  }
  result.change =
      FromDegreesAndMm(ReadVector6(in, in.Require(root, "change_deg_mm"), "change_deg_mm"));
  const YamlNode& sigma = in.Require(root, "sigma_deg_mm");
  const bool is_known = !sigma.items.empty() && sigma.items[0].kind != YamlNode::Kind::kNull;
  if (is_known) result.sigma = FromDegreesAndMm(ReadVector6(in, sigma, "sigma_deg_mm"));
  Eigen::Vector2d detect = Eigen::Vector2d::Zero();
  in.Reals(in.Require(root, "detect_deg_mm"), "detect_deg_mm", {detect.data(), 2});
  result.detect_rad = kRadPerDeg * detect.x();
  result.detect_m = 1e-3 * detect.y();
  ReadCheckedPairs(in, root, result);
  if (!in.ok()) return in.TakeError();
  return result;
}

bool IsCheckResult(std::string_view text) {
  const std::size_t at = text.find_first_not_of("{ \t\r\n\"");
  return at != std::string_view::npos && text.substr(at).starts_with(kCheckKey);
}

}  // namespace sextant
