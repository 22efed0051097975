// SPDX-License-Identifier: Apache-2.0
#include "io/clouds/kitti_cloud.h"

#include <fmt/core.h>

#include "io/clouds/cloud_builder.h"
#include "io/clouds/scalar_type.h"
#include "io/text/number_text.h"
#include "io/text/text_file.h"

namespace sextant {

Expected<PointCloud> ReadKittiCloud(const std::filesystem::path& path) {
  return ReadWith(path, ParseKittiCloud);
}

Expected<PointCloud> ParseKittiCloud(std::string_view bytes, const std::string& file) {
  constexpr std::size_t kPointSize = 16;
  if (bytes.empty() || bytes.size() % kPointSize != 0) {
    return MakeError(ErrorCode::kParse,
                     fmt::format("{}: byte {}: the file ends within a point; expected x, y, z, "
                                 "intensity as float32, 16 bytes per point (KITTI)",
                                 Printable(file, 200), bytes.size()));
  }
  CloudBuilder builder({.x = 0, .y = 1, .z = 2, .intensity = 3}, bytes.size() / kPointSize);
  for (std::size_t at = 0; at < bytes.size(); at += kPointSize) {
    SEXTANT_RETURN_IF_ERROR(builder.Add([&](std::size_t column) {
      return LoadScalar(bytes.data() + at + 4 * column, ScalarType::kFloat32, false);
    }));
  }
  return std::move(builder).Finish();
}

}  // namespace sextant
