// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "base/text/lower_case.h"
#include "io/blocks/camera_block.h"
#include "io/cameras/camera_file.h"
#include "io/cameras/camera_parts.h"
#include "io/cameras/camera_tree.h"
#include "io/text/number_text.h"
#include "io/text/yaml_fields.h"

namespace sextant {
namespace {

constexpr int kMaxPixels = 1'000'000;
constexpr std::size_t kMaxCoefficients = 14;

// Kalibr's camera models, and what precedes fx, fy, cx, cy in `intrinsics`.
struct KalibrModel {
  std::string_view name;
  std::size_t extra;
};
constexpr KalibrModel kKalibrModels[] = {
    {"pinhole", 0}, {"omni", 1}, {"ds", 2}, {"eucm", 2}, {"fov", 1}};

std::string TextOf(const YamlNode* node) {
  return node == nullptr ? std::string{} : LowerCase(node->text);
}

// The distortion model in ROS's terms, from the two names that other programs use.
std::string ModelOf(const YamlNode& camera) {
  const std::string projection =
      TextOf(FindCameraKey(camera, {"camera_model", "cam_model", "model_type", "Camera.type"}));
  const std::string distortion =
      TextOf(FindCameraKey(camera, {"distortion_model", "distortion_type"}));
  if (projection == "mei" || projection == "omni") return "mei";
  if (projection == "ds") return "double_sphere";
  if (projection == "kannala_brandt" || projection == "kannalabrandt8" ||
      projection == "equidistantcamera" || projection == "fisheye") {
    return "equidistant";
  }
  if (!projection.empty() && projection != "pinhole" && projection != "perspective") {
    return projection;
  }
  // OpenCV's calibration sample marks a fisheye by a flag; the other keys are the same.
  const std::string fisheye = TextOf(camera.Find("fisheye_model"));
  if (fisheye == "1" || fisheye == "true") return "equidistant";
  if (distortion == "radtan" || distortion == "radial-tangential") return "plumb_bob";
  if (distortion == "equi") return "equidistant";
  if (distortion == "none") return "plumb_bob";
  return distortion;
}

int ReadSize(YamlFields& in, const YamlNode& camera, std::size_t index,
             std::initializer_list<std::string_view> keys) {
  for (const std::string_view key : {"resolution", "ImageSize", "image_size"}) {
    const YamlNode* both = camera.Find(key);
    if (both == nullptr) continue;
    const std::vector<double> size = CameraNumbers(in, *both, key, 2);
    if (in.ok() && size.size() != 2) in.Fail(both->line, key, "expected width and height");
    if (!in.ok()) return 0;
    // Matlab states rows and columns.
    const bool is_matlab = FindCameraKey(camera, {"IntrinsicMatrix", "FocalLength"}) != nullptr;
    return static_cast<int>(std::clamp<double>(size[is_matlab ? 1 - index : index], 0, kMaxPixels));
  }
  for (const std::string_view key : keys) {
    if (camera.Find(key) != nullptr) return in.IntegerAt(camera, key, 0, kMaxPixels);
  }
  return 0;
}

double RealOf(YamlFields& in, const YamlNode& camera,
              std::initializer_list<std::string_view> keys) {
  const YamlNode* node = FindCameraKey(camera, {keys.begin(), keys.end()});
  return in.Real(node == nullptr ? in.Require(camera, *keys.begin()) : *node, *keys.begin());
}

// A number, or a matrix of one; 0 if absent.
double OneNumber(YamlFields& in, const YamlNode& camera, std::string_view key) {
  const YamlNode* node = FindCameraKey(camera, {key});
  if (node == nullptr) return 0.0;
  const std::vector<double> numbers = CameraNumbers(in, *node, key, 1);
  if (in.ok() && numbers.size() != 1) in.Fail(node->line, key, "expected one number");
  return in.ok() ? numbers.front() : 0.0;
}

// A list of two numbers.
std::array<double, 2> PairOf(YamlFields& in, const YamlNode& camera, std::string_view key) {
  const std::vector<double> pair = CameraNumbers(in, in.Require(camera, key), key, 2);
  if (in.ok() && pair.size() != 2) in.Fail(camera.line, key, "expected two numbers");
  return in.ok() ? std::array{pair[0], pair[1]} : std::array<double, 2>{};
}

// Bouguet's fc, cc and alpha_c, and Matlab's FocalLength and PrincipalPoint, whose first pixel is
// (1, 1).
void ReadMatlabPairs(YamlFields& in, const YamlNode& camera, bool is_bouguet, CameraParts& parts) {
  const auto [fx, fy] = PairOf(in, camera, is_bouguet ? "fc" : "FocalLength");
  const auto [cx, cy] = PairOf(in, camera, is_bouguet ? "cc" : "PrincipalPoint");
  const double skew = is_bouguet ? fx * OneNumber(in, camera, "alpha_c") : 0.0;
  const double origin = is_bouguet ? 0.0 : 1.0;
  parts.matrix = {fx, skew, cx - origin, 0, fy, cy - origin, 0, 0, 1};
}

// fx, fy, cx, cy as separate keys.
void ReadFocals(YamlFields& in, const YamlNode& camera, CameraParts& parts) {
  const double fx =
      RealOf(in, camera, {"fx", "f_x", "cam_fx", "Camera.fx", "Camera1.fx", "gamma1", "mu"});
  const double fy =
      RealOf(in, camera, {"fy", "f_y", "cam_fy", "Camera.fy", "Camera1.fy", "gamma2", "mv"});
  const double cx =
      RealOf(in, camera, {"cx", "c_x", "cam_cx", "Camera.cx", "Camera1.cx", "u0", "ppx"});
  const double cy =
      RealOf(in, camera, {"cy", "c_y", "cam_cy", "Camera.cy", "Camera1.cy", "v0", "ppy"});
  parts.matrix = {fx, 0, cx, 0, fy, cy, 0, 0, 1};
}

void ReadMatrix(YamlFields& in, const YamlNode& matrix, CameraParts& parts) {
  constexpr std::string_view kName = "camera matrix";
  const std::vector<double> k = CameraNumbers(in, matrix, kName, kMaxCoefficients);
  if (in.ok() && k.size() == 4) {
    parts.matrix = {k[0], 0, k[2], 0, k[1], k[3], 0, 0, 1};
    return;
  }
  if (in.ok() && k.size() != parts.matrix.size()) {
    in.Fail(matrix.line, kName, fmt::format("expected 9 numbers, got {}", k.size()));
  }
  if (!in.ok()) return;
  std::copy(k.begin(), k.end(), parts.matrix.begin());
  // Column by column, as Matlab and Open3D have it.
  const bool is_transposed = k[1] == 0.0 && k[2] == 0.0 && k[5] == 0.0 && k[6] > 0.0 && k[7] > 0.0;
  if (is_transposed) parts.matrix = {k[0], k[3], k[6], k[1], k[4], k[7], k[2], k[5], k[8]};
}

// Waymo's list: fx fy cx cy k1 k2 p1 p2 k3.
bool IsWaymoList(const std::vector<double>& k) {
  return k.size() == 9 && !(k[1] == 0.0 && k[3] == 0.0) && k[8] != 1.0;
}

// Kalibr's `intrinsics`: the parameters of the model, then fx, fy, cx, cy.
void ReadKalibr(YamlFields& in, const YamlNode& camera, const YamlNode& list, CameraParts& parts) {
  const std::string model = TextOf(camera.Find("camera_model"));
  const auto* known = std::find_if(std::begin(kKalibrModels), std::end(kKalibrModels),
                                   [&](const KalibrModel& m) { return m.name == model; });
  const std::size_t extra = known == std::end(kKalibrModels) ? 0 : known->extra;
  const std::vector<double> k = CameraNumbers(in, list, "intrinsics", kMaxCoefficients);
  if (in.ok() && k.size() != extra + 4) {
    in.Fail(list.line, "intrinsics",
            fmt::format("expected {} numbers for the camera model {}, got {}", extra + 4,
                        Quoted(model), k.size()));
  }
  if (!in.ok()) return;
  parts.matrix = {k[extra], 0, k[extra + 2], 0, k[extra + 1], k[extra + 3], 0, 0, 1};
  if (extra > 0) parts.xi = k[0];
  if (extra > 1) parts.alpha = k[1];
}

// P = K [I | t]: the camera's own matrix is its left part.
void ReadProjection(YamlFields& in, const YamlNode& projection, CameraParts& parts) {
  const std::vector<double> p = CameraNumbers(in, projection, "projection", kMaxCoefficients);
  if (in.ok() && p.size() != 12) {
    in.Fail(projection.line, "projection", fmt::format("expected 12 numbers, got {}", p.size()));
  }
  if (!in.ok()) return;
  for (std::size_t row = 0; row < 3; ++row) {
    std::copy_n(p.begin() + 4 * static_cast<long>(row), 3,
                parts.matrix.begin() + 3 * static_cast<long>(row));
  }
}

// Matlab's k1 k2 [k3] and p1 p2, apart.
std::vector<double> MatlabDistortion(YamlFields& in, const YamlNode& camera,
                                     const YamlNode& radial) {
  const std::vector<double> k = CameraNumbers(in, radial, "RadialDistortion", 3);
  std::vector<double> p;
  if (const YamlNode* tangential = camera.Find("TangentialDistortion")) {
    p = CameraNumbers(in, *tangential, "TangentialDistortion", 2);
  }
  if (in.ok() && (k.size() < 2 || p.size() == 1)) {
    in.Fail(radial.line, "RadialDistortion", "expected two or three numbers, and two tangential");
  }
  if (!in.ok()) return {};
  p.resize(2, 0.0);
  return {k[0], k[1], p[0], p[1], k.size() > 2 ? k[2] : 0.0};
}

// The list of a key of any name with "dist" in it: a lens without the distortion that its file
// states would be wrong without a word.
const YamlNode* FindDistortionList(const YamlNode& camera) {
  for (std::size_t i = 0; i < camera.keys.size(); ++i) {
    const YamlNode& value = camera.items[i];
    const bool is_list = value.kind == YamlNode::Kind::kSequence ||
                         (value.kind == YamlNode::Kind::kMap && value.Find("data") != nullptr);
    if (is_list && LowerCase(camera.keys[i]).find("dist") != std::string::npos) return &value;
  }
  return nullptr;
}

using KeyNames = std::vector<std::string_view>;

// The numbers of the first of each of these keys; 0 for one that is absent.
void AddNumbersOf(YamlFields& in, const YamlNode& camera, const std::vector<KeyNames>& names,
                  std::vector<double>& numbers) {
  for (const KeyNames& keys : names) {
    const YamlNode* node = FindCameraKey(camera, keys);
    numbers.push_back(node == nullptr ? 0.0 : in.Real(*node, keys.front()));
  }
}

// k4 to k6 of a rational distortion, where the camera has any. Without p1 and p2, k1 to k4 are more
// likely those of a fisheye.
void AddRational(YamlFields& in, const YamlNode& camera, std::string_view model,
                 std::vector<double>& distortion) {
  static const std::vector<KeyNames> kRational = {{"k4", "k_4", "Camera.k4", "Camera1.k4"},
                                                  {"k5", "k_5", "Camera.k5", "Camera1.k5"},
                                                  {"k6", "k_6", "Camera.k6", "Camera1.k6"}};
  const YamlNode* any = nullptr;
  for (const KeyNames& keys : kRational) {
    if (any == nullptr) any = FindCameraKey(camera, keys);
  }
  if (any == nullptr) return;
  if (model.empty() && FindCameraKey(camera, {"p1", "p_1", "Camera.p1", "Camera1.p1"}) == nullptr) {
    in.Fail(any->line, "k4",
            "expected p1 and p2 beside k1 to k6, or for the k1 to k4 of a fisheye the key "
            "distortion_model: equidistant");
  }
  AddNumbersOf(in, camera, kRational, distortion);
}

// Coefficients under keys of their own: k1, k2, p1, p2 and so on.
std::vector<double> FlatDistortion(YamlFields& in, const YamlNode& camera, std::string_view model) {
  if (model == "double_sphere") return {};
  static const std::vector<KeyNames> kRadialTangential = {
      {"k1", "k_1", "Camera.k1", "Camera1.k1", "cam_d0"},
      {"k2", "k_2", "Camera.k2", "Camera1.k2", "cam_d1"},
      {"p1", "p_1", "Camera.p1", "Camera1.p1", "cam_d2"},
      {"p2", "p_2", "Camera.p2", "Camera1.p2", "cam_d3"},
      {"k3", "k_3", "Camera.k3", "Camera1.k3", "cam_d4"}};
  static const std::vector<KeyNames> kFisheye = {
      {"k1", "k_1", "Camera.k1", "Camera1.k1", "cam_d0"},
      {"k2", "k_2", "Camera.k2", "Camera1.k2", "cam_d1"},
      {"k3", "k_3", "Camera.k3", "Camera1.k3", "cam_d2"},
      {"k4", "k_4", "Camera.k4", "Camera1.k4", "cam_d3"}};
  static const std::vector<KeyNames> kCamodocal = {{"k2"}, {"k3"}, {"k4"}, {"k5"}};
  std::vector<double> distortion;
  if (model != "equidistant") {
    AddNumbersOf(in, camera, kRadialTangential, distortion);
    AddRational(in, camera, model, distortion);
  } else {
    const bool is_camodocal = FindCameraKey(camera, {"mu"}) != nullptr;
    AddNumbersOf(in, camera, is_camodocal ? kCamodocal : kFisheye, distortion);
  }
  return distortion;
}

std::vector<double> ReadDistortion(YamlFields& in, const YamlNode& camera, std::string_view model) {
  if (const YamlNode* radial = camera.Find("RadialDistortion")) {
    return MatlabDistortion(in, camera, *radial);
  }
  const YamlNode* list =
      FindCameraKey(camera, {"distortion_coefficients", "D", "d", "dist_coeffs", "distCoeffs",
                             "distortion_coeffs", "cam_dist", "coeffs", "kc", "D1"});
  if (list == nullptr) list = FindDistortionList(camera);
  if (list != nullptr) {
    return CameraNumbers(in, *list, "distortion coefficients", kMaxCoefficients);
  }
  return FlatDistortion(in, camera, model);
}

Expected<Camera> ReadCameraNode(const CameraNode& node, const std::string& file) {
  YamlFields in(file);
  const YamlNode& camera = *node.map;
  CameraParts parts;
  if (node.projection != nullptr) {
    ReadProjection(in, *node.projection, parts);
    if (!in.ok()) return in.TakeError();
    return AtPlace(CameraFromParts(parts), {.file = file, .name = node.name});
  }
  const std::string model = ModelOf(camera);
  const YamlNode* matrix = FindCameraKey(camera, CameraMatrixKeys());
  const YamlNode* list = camera.Find("intrinsics");
  const YamlNode* numbers = camera.Find("intrinsic");
  std::vector<double> waymo;
  if (numbers != nullptr && matrix == nullptr && list == nullptr) {
    const std::vector<double> k = CameraNumbers(in, *numbers, "intrinsic", kMaxCoefficients);
    if (IsWaymoList(k)) waymo = k;
    matrix = numbers;
  }
  if (!waymo.empty()) {
    parts.matrix = {waymo[0], 0, waymo[2], 0, waymo[1], waymo[3], 0, 0, 1};
  } else if (matrix != nullptr) {
    ReadMatrix(in, *matrix, parts);
    if (camera.Find("IntrinsicMatrix") == matrix) {
      // Matlab's first pixel is (1, 1).
      parts.matrix[2] -= 1.0;
      parts.matrix[5] -= 1.0;
    }
  } else if (list != nullptr) {
    ReadKalibr(in, camera, *list, parts);
  } else if (camera.Find("fc") != nullptr || camera.Find("FocalLength") != nullptr) {
    ReadMatlabPairs(in, camera, camera.Find("fc") != nullptr, parts);
  } else {
    ReadFocals(in, camera, parts);
  }
  if (list == nullptr) parts.xi = OneNumber(in, camera, "xi");
  if (list == nullptr) parts.alpha = OneNumber(in, camera, "alpha");
  const std::vector<double> distortion = waymo.empty()
                                             ? ReadDistortion(in, camera, model)
                                             : std::vector<double>(waymo.begin() + 4, waymo.end());
  parts.width_px = ReadSize(
      in, camera, 0, {"width", "image_width", "cam_width", "Camera.width", "img_dist_w", "nx"});
  parts.height_px = ReadSize(
      in, camera, 1, {"height", "image_height", "cam_height", "Camera.height", "img_dist_h", "ny"});
  if (!in.ok()) return in.TakeError();
  parts.distortion = distortion;
  parts.model = model;
  return AtPlace(CameraFromParts(parts), {.file = file, .name = node.name});
}

// "the file holds 2 cameras: cam0, cam1".
std::string NamesOf(const std::vector<CameraNode>& cameras) {
  std::string names;
  for (const CameraNode& camera : cameras) names += (names.empty() ? "" : ", ") + camera.name;
  return names;
}

// Whether a line that is no comment has a key.
bool HasKeys(std::string_view document) {
  while (!document.empty()) {
    const std::string_view line = document.substr(0, document.find('\n'));
    document.remove_prefix(std::min(line.size() + 1, document.size()));
    if (!line.starts_with('#') && line.find(':') != std::string_view::npos) return true;
  }
  return false;
}

// The documents of a text that separates them by lines "---", as `rostopic echo` and `ros2 topic
// echo` end each message; one for any other text.
std::vector<std::string_view> MessagesOf(std::string_view text) {
  constexpr std::string_view kEnd = "\n---";
  constexpr std::size_t kMaxMessages = 100;
  std::vector<std::string_view> messages;
  // OpenCV's first line is followed by one that begins the document.
  while (!text.starts_with('%') && messages.size() < kMaxMessages) {
    const std::size_t end = text.find(kEnd);
    if (end == std::string_view::npos) break;
    const std::string_view message = text.substr(0, end + 1);
    text.remove_prefix(end + kEnd.size());
    if (HasKeys(message)) messages.push_back(message);
  }
  if (messages.empty() || HasKeys(text)) messages.push_back(text);
  return messages;
}

bool HaveSameIntrinsics(const Camera& a, const Camera& b) {
  return a.model == b.model && a.fx_px == b.fx_px && a.fy_px == b.fy_px && a.cx_px == b.cx_px &&
         a.cy_px == b.cy_px && a.distortion == b.distortion && a.width_px == b.width_px &&
         a.height_px == b.height_px;
}

}  // namespace

Expected<Camera> CameraOfTree(const YamlNode& root, const std::string& file,
                              std::string_view name) {
  const YamlNode* block = root.Find("camera");
  if (name.empty() && block != nullptr && FindCameras(*block).empty()) {
    YamlFields in(file);
    const Camera camera = ReadCameraBlock(in, *block);
    if (!in.ok()) return in.TakeError();
    return camera;
  }
  const std::vector<CameraNode> cameras = FindCameras(root);
  const auto place = fmt::format("{}:{}", file, root.line);
  if (cameras.empty()) {
    return MakeError(ErrorCode::kParse,
                     place +
                         ": expected a camera: camera_matrix, K, fx, intrinsics or camera; "
                         "none of these keys is present");
  }
  if (name.empty()) {
    if (cameras.size() == 1) return ReadCameraNode(cameras.front(), file);
    return MakeError(
        ErrorCode::kParse,
        fmt::format("{}: the file holds {} cameras: {}; name one of them, as in {}:{}", place,
                    cameras.size(), NamesOf(cameras), file, cameras.front().name));
  }
  for (const CameraNode& camera : cameras) {
    if (camera.name == name) return ReadCameraNode(camera, file);
  }
  return MakeError(ErrorCode::kParse, fmt::format("{}: the file has no camera {}; it has {}", place,
                                                  Quoted(std::string(name)), NamesOf(cameras)));
}

Expected<Camera> ParseCameraYaml(std::string_view text, const std::string& file,
                                 std::string_view name) {
  std::optional<Camera> first;
  for (const std::string_view document : MessagesOf(text)) {
    SEXTANT_ASSIGN_OR_RETURN(const YamlNode root, ParseYaml(document, file));
    SEXTANT_ASSIGN_OR_RETURN(const Camera camera, CameraOfTree(root, file, name));
    if (first && !HaveSameIntrinsics(*first, camera)) {
      return MakeError(ErrorCode::kParse,
                       fmt::format("{}: expected one camera, got messages of several; keep those "
                                   "of one camera",
                                   file));
    }
    if (!first) first = camera;
  }
  return *first;
}

}  // namespace sextant
