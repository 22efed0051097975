// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <initializer_list>

#include "io/blocks/camera_block.h"
#include "io/cameras/camera_file.h"
#include "io/cameras/camera_parts.h"
#include "io/text/number_text.h"
#include "io/text/yaml_fields.h"

namespace sextant {
namespace {

constexpr int kMaxPixels = 1'000'000;

// Tools use different names for the same key.
const YamlNode* FindAny(const YamlNode& map, std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : keys) {
    if (const YamlNode* found = map.Find(key)) return found;
  }
  return nullptr;
}

// A list of numbers, or a matrix {rows, cols, data}.
std::vector<double> ReadNumbers(YamlFields& in, const YamlNode& node, std::string_view name) {
  constexpr std::size_t kMax = kMaxDistortion;
  const bool is_matrix = node.kind == YamlNode::Kind::kMap;
  return in.RealList(is_matrix ? in.Require(node, "data") : node, name, kMax);
}

// A number, or a matrix of one; 0 if absent.
double ReadNumber(YamlFields& in, const YamlNode& root, std::string_view key) {
  const YamlNode* node = root.Find(key);
  if (node == nullptr) return 0.0;
  if (node->kind != YamlNode::Kind::kMap) return in.Real(*node, key);
  const std::vector<double> numbers = ReadNumbers(in, *node, key);
  if (in.ok() && numbers.size() != 1) in.Fail(node->line, key, "expected one number");
  return numbers.size() == 1 ? numbers.front() : 0.0;
}

int ReadSize(YamlFields& in, const YamlNode& root, std::string_view key, std::string_view other) {
  const std::string_view present = root.Find(key) != nullptr ? key : other;
  return root.Find(present) != nullptr ? in.IntegerAt(root, present, 0, kMaxPixels) : 0;
}

// fx, fy, cx, cy, k1, k2, p1, p2, k3 as separate keys.
void ReadFlat(YamlFields& in, const YamlNode& root, CameraParts& parts,
              std::vector<double>& distortion) {
  parts.matrix = {in.RealAt(root, "fx"),
                  0,
                  in.RealAt(root, "cx"),
                  0,
                  in.RealAt(root, "fy"),
                  in.RealAt(root, "cy"),
                  0,
                  0,
                  1};
  for (const std::string_view key : {"k1", "k2", "p1", "p2", "k3"}) {
    distortion.push_back(in.RealAt(root, key, 0.0));
  }
}

void ReadMatrices(YamlFields& in, const YamlNode& root, const YamlNode& matrix, CameraParts& parts,
                  std::vector<double>& distortion) {
  const std::vector<double> k = ReadNumbers(in, matrix, "camera matrix");
  if (in.ok() && k.size() != parts.matrix.size()) {
    in.Fail(matrix.line, "camera matrix", fmt::format("expected 9 numbers, got {}", k.size()));
  }
  if (in.ok()) std::copy(k.begin(), k.end(), parts.matrix.begin());
  if (const YamlNode* d = FindAny(root, {"distortion_coefficients", "D", "d"})) {
    distortion = ReadNumbers(in, *d, "distortion coefficients");
  }
}

}  // namespace

Expected<Camera> ParseCameraYaml(std::string_view text, const std::string& file) {
  SEXTANT_ASSIGN_OR_RETURN(const YamlNode root, ParseYaml(std::string(text), file));
  YamlFields in(file);
  if (const YamlNode* block = root.Find("camera")) {
    const Camera camera = ReadCameraBlock(in, *block);
    if (!in.ok()) return in.TakeError();
    return camera;
  }
  CameraParts parts;
  std::vector<double> distortion;
  if (const YamlNode* matrix = FindAny(root, {"camera_matrix", "K", "k"})) {
    ReadMatrices(in, root, *matrix, parts, distortion);
  } else if (root.Find("fx") != nullptr) {
    ReadFlat(in, root, parts, distortion);
  } else {
    in.Fail(root.line, {},
            "expected a camera: camera_matrix, K, fx or camera; none of these keys is present");
  }
  parts.width_px = ReadSize(in, root, "width", "image_width");
  parts.height_px = ReadSize(in, root, "height", "image_height");
  std::string model;
  if (root.Find("distortion_model") != nullptr) model = in.TextAt(root, "distortion_model");
  parts.xi = ReadNumber(in, root, "xi");
  parts.alpha = ReadNumber(in, root, "alpha");
  if (!in.ok()) return in.TakeError();
  parts.distortion = distortion;
  parts.model = model;
  return AtPlace(CameraFromParts(parts), {.file = file});
}

}  // namespace sextant
