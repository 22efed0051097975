// SPDX-License-Identifier: Apache-2.0
#include "io/problems/data_manifest.h"

#include <fmt/core.h>

#include <boost/crc.hpp>
#include <charconv>
#include <cmath>
#include <system_error>
#include <utility>

#include "io/text/text_file.h"
#include "io/text/yaml_fields.h"

namespace sextant {
namespace {

constexpr std::size_t kMaxManifestFiles = 10'000;

std::string TextOr(YamlFields& fields, const YamlNode& map, std::string_view key) {
  return fields.ok() && map.Find(key) != nullptr ? fields.TextAt(map, key) : std::string();
}

ReferencePose ReadReference(YamlFields& fields, const YamlNode& node) {
  ReferencePose reference;
  fields.IsMap(node, "reference",
               std::vector<std::string>{"translation_m", "quaternion_wxyz", "rotation", "from",
                                        "sigma_mm", "sigma_deg"});
  reference.from = fields.TextAt(node, "from");
  reference.sigma_mm = fields.NonNegativeAt(node, "sigma_mm", 0.0);
  reference.sigma_deg = fields.NonNegativeAt(node, "sigma_deg", 0.0);
  Rigid3d& pose = reference.cam_from_lidar;
  pose.translation = fields.PointAt(node, "translation_m");
  if (!fields.ok()) return reference;
  constexpr double kMaxError = 1e-2;
  if (node.Find("rotation") != nullptr) {
    double rows[9] = {};
    fields.Reals(*node.Find("rotation"), "rotation", rows);
    const Eigen::Matrix3d matrix =
        Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(rows);
    const bool is_rotation =
        (matrix * matrix.transpose() - Eigen::Matrix3d::Identity()).norm() < kMaxError &&
        matrix.determinant() > 0.0;
    if (!is_rotation) fields.Fail(node.line, "rotation", "expected the 9 numbers of a rotation");
    pose.rotation = Eigen::Quaterniond(matrix).normalized();
    return reference;
  }
  double q[4] = {};
  fields.Reals(fields.Require(node, "quaternion_wxyz"), "quaternion_wxyz", q);
  pose.rotation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
  if (fields.ok() && !(std::abs(pose.rotation.norm() - 1.0) < kMaxError)) {
    fields.Fail(node.line, "quaternion_wxyz", "expected a quaternion of length 1");
  }
  pose.rotation.normalize();
  return reference;
}

// Relative, and within the folder of the data.
void CheckPath(YamlFields& fields, int line, std::string_view key, const std::string& text) {
  const std::filesystem::path path(text);
  bool leaves = path.is_absolute();
  for (const auto& part : path) leaves = leaves || part == "..";
  if (leaves) fields.Fail(line, key, "expected a path within the folder of the data");
}

ManifestFile ReadFile(YamlFields& fields, const YamlNode& node) {
  ManifestFile file;
  fields.IsMap(node, "files", std::vector<std::string>{"path", "bytes", "crc32"});
  file.path = fields.TextAt(node, "path");
  CheckPath(fields, node.line, "path", file.path);
  file.bytes = static_cast<std::uint64_t>(fields.IntegerAt(node, "bytes", 0, 2'000'000'000));
  const std::string crc = fields.TextAt(node, "crc32");
  const char* end = crc.data() + crc.size();
  const auto [stop, error] = std::from_chars(crc.data(), end, file.crc32, 16);
  if (fields.ok() && (error != std::errc() || stop != end || crc.size() != 8)) {
    fields.Fail(node.line, "crc32", "expected 8 hexadecimal digits");
  }
  return file;
}

Expected<DataManifest> ManifestOf(const YamlNode& root, YamlFields& fields) {
  fields.IsMap(root, "manifest",
               std::vector<std::string>{"sextant_data", "name", "about", "source", "licence",
                                        "pairs", "images", "scans", "boards", "camera", "metres",
                                        "lidar_first", "reference", "files"});
  fields.IntegerAt(root, "sextant_data", 1, 1);
  DataManifest manifest;
  manifest.name = fields.TextAt(root, "name");
  manifest.about = fields.TextAt(root, "about");
  manifest.source = fields.TextAt(root, "source");
  manifest.licence = fields.TextAt(root, "licence");
  for (const auto& [key, text] : {std::pair{"pairs", &manifest.pairs},
                                  {"images", &manifest.images},
                                  {"scans", &manifest.scans},
                                  {"boards", &manifest.boards},
                                  {"camera", &manifest.camera}}) {
    *text = TextOr(fields, root, key);
    CheckPath(fields, root.line, key, *text);
  }
  manifest.metres = fields.RealAt(root, "metres", 1.0);
  if (fields.ok() && !(manifest.metres > 0.0 && manifest.metres <= 1000.0)) {
    fields.Fail(root.line, "metres", "expected the length of the unit, in metres");
  }
  manifest.lidar_first = TextOr(fields, root, "lidar_first") == "true";
  const bool has_views = !manifest.images.empty() && !manifest.scans.empty() &&
                         !manifest.boards.empty() && !manifest.camera.empty();
  if (fields.ok() && manifest.pairs.empty() == !has_views) {
    fields.Fail(root.line, "manifest",
                "expected either pairs, or images, scans, boards and camera");
  }
  if (const YamlNode* node = fields.ok() ? root.Find("reference") : nullptr) {
    manifest.reference = ReadReference(fields, *node);
  }
  const YamlNode& files = fields.Require(root, "files");
  if (fields.IsSequence(files, "files", kMaxManifestFiles)) {
    for (const YamlNode& node : files.items) manifest.files.push_back(ReadFile(fields, node));
  }
  if (!fields.ok()) return fields.TakeError();
  return manifest;
}

}  // namespace

Expected<DataManifest> ReadManifest(const std::filesystem::path& path) {
  return ReadWith(path, ParseManifest);
}

Expected<DataManifest> ParseManifest(std::string_view text, const std::string& file) {
  SEXTANT_ASSIGN_OR_RETURN(const YamlNode root, ParseYaml(text, file));
  YamlFields fields(file);
  return ManifestOf(root, fields);
}

Expected<void> CheckFiles(const DataManifest& manifest, const std::filesystem::path& data) {
  for (const ManifestFile& file : manifest.files) {
    const std::filesystem::path path = data / file.path;
    std::error_code error;
    if (!std::filesystem::exists(path, error)) {
      return MakeError(ErrorCode::kMissingData,
                       fmt::format("{} is absent from the real data", file.path));
    }
    SEXTANT_ASSIGN_OR_RETURN(const std::string bytes, ReadTextFile(path));
    boost::crc_32_type crc;
    crc.process_bytes(bytes.data(), bytes.size());
    if (bytes.size() != file.bytes || crc.checksum() != file.crc32) {
      return MakeError(
          ErrorCode::kInvalidInput,
          fmt::format("{}: {} bytes with the checksum {:08x}, expected {} with {:08x}; "
                      "it is not the file of the manifest",
                      file.path, bytes.size(), crc.checksum(), file.bytes, file.crc32));
    }
  }
  return {};
}

}  // namespace sextant
