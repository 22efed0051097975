// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/cloud_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <cctype>

#include "io/clouds/cloud_builder.h"
#include "io/clouds/csv_cloud.h"
#include "io/clouds/kitti_cloud.h"
#include "io/clouds/pcd_file.h"
#include "io/clouds/ply_file.h"
#include "io/text/number_text.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

std::string LowerExtension(const std::string& file) {
  std::string extension = std::filesystem::path(file).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

}  // namespace

Expected<PointCloud> ReadCloud(const std::filesystem::path& path) {
  return ReadWith(path, ParseCloud);
}

Expected<PointCloud> ParseCloud(std::string_view bytes, const std::string& file) {
  const std::string extension = LowerExtension(file);
  if (bytes.starts_with("# .PCD") || bytes.starts_with("VERSION") || extension == ".pcd") {
    Expected<PointCloud> cloud = ParsePcd(bytes, file);
    if (cloud && !cloud->ring.empty()) OrderRings(*cloud);
    return cloud;
  }
  if (bytes.starts_with("ply\n") || bytes.starts_with("ply\r") || extension == ".ply") {
    return ParsePly(bytes, file);
  }
  if (extension == ".bin") return ParseKittiCloud(bytes, file);
  if (extension == ".csv" || extension == ".txt") return ParseCsvCloud(bytes, file);
  return MakeError(
      ErrorCode::kParse,
      fmt::format("{}: expected a scan: .pcd, .ply, .bin (KITTI) or .csv", Printable(file, 200)));
}

}  // namespace sextant
