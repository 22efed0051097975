// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/cloud_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <vector>

#include "base/text/lower_case.h"
#include "base/text/path_text.h"
#include "io/clouds/cloud_builder.h"
#include "io/clouds/csv_cloud.h"
#include "io/clouds/float_cloud.h"
#include "io/clouds/las_cloud.h"
#include "io/clouds/npy_cloud.h"
#include "io/clouds/pcd_file.h"
#include "io/clouds/ply_file.h"
#include "io/text/line_reader.h"
#include "io/text/number_text.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

std::string LowerExtension(const std::filesystem::path& file) {
  return LowerCase(file.extension().string());
}

template <std::size_t kCount>
bool IsOneOf(const std::string& extension, const std::array<const char*, kCount>& extensions) {
  return std::ranges::find(extensions, extension) != extensions.end();
}

// Besides .txt.
constexpr std::array kTableExtensions = {".csv", ".xyz", ".pts", ".asc", ".tsv"};

bool IsTableExtension(const std::string& extension) {
  return extension == ".txt" || IsOneOf(extension, kTableExtensions);
}

// Whether the bytes are lines of text with three values at least; the first may be a count.
bool LooksLikeTable(std::string_view bytes) {
  const std::string_view head = bytes.substr(0, 4096);
  const bool is_text = std::ranges::none_of(
      head, [](unsigned char c) { return c < 0x20 && c != '\n' && c != '\r' && c != '\t'; });
  if (!is_text) return false;
  for (const auto separator : {LineReader::Separator::kSemicolons, LineReader::Separator::kCommas,
                               LineReader::Separator::kBlanks}) {
    LineReader in("", head, separator);
    for (int line = 0; line < 2 && in.Next(); ++line) {
      if (in.field_count() >= 3) return true;
    }
  }
  return false;
}

// What to do with a file of a form that is known but not read.
std::string_view HintFor(std::string_view bytes) {
  if (bytes.starts_with("PK")) {
    return "; this is an archive (.npz, .zip): save one array with numpy.save";
  }
  if (bytes.starts_with("\x1f\x8b")) return "; this is compressed: unpack it with gunzip";
  if (bytes.starts_with("ASTM-E57")) {
    return "; this is E57: export PLY or PCD, as with CloudCompare";
  }
  return "";
}

Expected<PointCloud> ParseByContent(std::string_view bytes, const std::string& file) {
  const std::string extension = LowerExtension(file);
  if (bytes.starts_with(kNpyMagic)) return ParseNpyCloud(bytes, file);
  if (bytes.starts_with(kLasMagic)) return ParseLasCloud(bytes, file);
  if (bytes.starts_with("# .PCD") || bytes.starts_with("VERSION") || extension == ".pcd") {
    Expected<PointCloud> cloud = ParsePcd(bytes, file);
    if (cloud && !cloud->ring.empty()) OrderRings(*cloud);
    return cloud;
  }
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r") || extension == ".ply") {
    return ParsePly(bytes, file);
  }
  if (extension == ".bin") return ParseFloatCloud(bytes, file);
  if (IsTableExtension(extension) || LooksLikeTable(bytes)) return ParseCsvCloud(bytes, file);
  return MakeError(
      ErrorCode::kParse,
      fmt::format("{}: expected a scan: .pcd, .ply, .las, .npy, .bin (KITTI, nuScenes), or a table "
                  "of numbers (.csv, .txt, .xyz, .pts){}",
                  PathText(file), HintFor(bytes)));
}

}  // namespace

Expected<PointCloud> ReadCloud(const std::filesystem::path& path) {
  return ReadWith(path, ParseCloud);
}

bool IsCloudName(const std::filesystem::path& path) {
  constexpr std::array kExtensions = {".pcd", ".ply", ".las", ".npy", ".bin"};
  const std::string extension = LowerExtension(path);
  return IsOneOf(extension, kExtensions) || IsOneOf(extension, kTableExtensions);
}

Expected<PointCloud> ParseCloud(std::string_view bytes, const std::string& file) {
  SEXTANT_ASSIGN_OR_RETURN(PointCloud cloud, ParseByContent(bytes, file));
  if (const Expected<void> ok = CheckMetres(cloud); !ok) {
    return MakeError(ok.error().code, fmt::format("{}: {}", PathText(file), ok.error().message));
  }
  return cloud;
}

}  // namespace sextant
