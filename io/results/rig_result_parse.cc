// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "io/blocks/camera_block.h"
#include "io/results/optional_fields.h"
#include "io/results/rig_result.h"
#include "io/text/max_id.h"
#include "io/text/yaml_fields.h"

namespace sextant {
namespace {

constexpr const char* kRigKey = "sextant_rig_result";

RigResultSensor ReadSensor(YamlFields& in, const YamlNode& node) {
  RigResultSensor sensor;
  sensor.name = in.FileName(in.Require(node, "name"), "name");
  if (const YamlNode* camera = Present(node, "camera")) {
    sensor.camera = ReadCameraBlock(in, *camera);
  }
  sensor.root_from_sensor = OptionalPose(in, node, "root_from_sensor");
  sensor.covariance = OptionalSymmetric(in, node, "covariance");
  sensor.views = in.IntegerAt(node, "views", 0, kMaxId, 0);
  sensor.used = in.IntegerAt(node, "views_used", 0, kMaxId, 0);
  sensor.true_root_from_sensor = OptionalPose(in, node, "true_root_from_sensor");
  return sensor;
}

RigResultPair ReadPair(YamlFields& in, const YamlNode& node) {
  RigResultPair pair;
  pair.a = in.TextAt(node, "a");
  pair.b = in.TextAt(node, "b");
  pair.a_from_b = ReadPose(in, in.Require(node, "a_from_b"), "a_from_b");
  pair.covariance = OptionalSymmetric(in, node, "covariance");
  pair.views = in.IntegerAt(node, "views", 0, kMaxId, 0);
  const YamlNode* alone = Present(node, "alone");
  if (alone == nullptr) return pair;
  pair.alone_a_from_b = OptionalPose(in, *alone, "a_from_b");
  pair.alone_covariance = OptionalSymmetric(in, *alone, "covariance");
  pair.alone_sigmas = OptionalNonNegative(in, *alone, "off_sigmas");
  return pair;
}

RigResultView ReadRigView(YamlFields& in, const YamlNode& node) {
  RigResultView view{.moment = in.TextAt(node, "moment"),
                     .board = in.IntegerAt(node, "board", 0, kMaxId)};
  const YamlNode& seen = in.Require(node, "seen");
  if (!in.IsSequence(seen, "seen")) return view;
  for (const YamlNode& one : seen.items) {
    view.seen.push_back({.sensor = in.TextAt(one, "sensor"),
                         .used = in.TextAt(one, "used") == "true",
                         .rms = in.NonNegativeAt(one, "rms", 0.0)});
  }
  return view;
}

RigResultNumber ReadNumber(YamlFields& in, const YamlNode& node) {
  return {.sensor = in.TextAt(node, "sensor"),
          .name = in.TextAt(node, "name"),
          .value = in.RealAt(node, "value"),
          .sigma = OptionalNonNegative(in, node, "sigma")};
}

// Each item of a list that may be absent.
template <class Item>
void ReadList(YamlFields& in, const YamlNode& root, std::string_view key,
              Item (*read)(YamlFields&, const YamlNode&), std::vector<Item>& items) {
  const YamlNode* list = Present(root, key);
  if (list == nullptr || !in.IsSequence(*list, key)) return;
  for (const YamlNode& node : list->items) {
    if (!in.ok()) return;
    items.push_back(read(in, node));
  }
}

}  // namespace

Expected<RigResult> ParseRigResult(std::string_view text, const std::string& file) {
  SEXTANT_ASSIGN_OR_RETURN(const YamlNode root, ParseYaml(text, file));
  YamlFields in(file);
  RigResult result;
  if (root.kind != YamlNode::Kind::kMap || root.Find(kRigKey) == nullptr) {
    in.Fail(root.line, {}, "expected the result of a rig, with the key sextant_rig_result");
    return in.TakeError();
  }
  in.IntegerAt(root, kRigKey, 1, 1);
  result.version = OptionalText(in, root, "version");
  result.root = in.TextAt(root, "root");
  in.Require(root, "sensors");
  ReadList(in, root, "sensors", ReadSensor, result.sensors);
  if (std::ranges::count(result.sensors, result.root, &RigResultSensor::name) != 1 && in.ok()) {
    in.Fail(root.Find("root")->line, "root", "expected the name of one of the sensors");
  }
  ReadList(in, root, "pairs", ReadPair, result.pairs);
  ReadList(in, root, "views", ReadRigView, result.views);
  ReadList(in, root, "numbers", ReadNumber, result.numbers);
  result.unconnected = ReadTexts(in, root, "unconnected");
  result.warnings = ReadTexts(in, root, "warnings");
  result.refutations = ReadTexts(in, root, "not_usable");
  if (!in.ok()) return in.TakeError();
  return result;
}

}  // namespace sextant
