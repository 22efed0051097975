// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <bit>
#include <cassert>
#include <cstring>

#include "io/clouds/ply_file.h"

namespace sextant {
namespace {

void Append(float value, std::string& bytes) {
  static_assert(std::endian::native == std::endian::little);
  char raw[sizeof(value)];
  std::memcpy(raw, &value, sizeof(value));
  bytes.append(raw, sizeof(value));
}

}  // namespace

std::string FormatPly(const PointCloud& cloud, std::span<const PlyColor> colors) {
  assert(colors.empty() || colors.size() == cloud.points.size());
  std::string bytes = fmt::format(
      "ply\nformat binary_little_endian 1.0\ncomment metres\nelement vertex {}\n"
      "property float x\nproperty float y\nproperty float z\n",
      cloud.points.size());
  if (!cloud.intensity.empty()) bytes += "property float intensity\n";
  if (!colors.empty()) bytes += "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  bytes += "end_header\n";
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    for (int k = 0; k < 3; ++k) Append(static_cast<float>(cloud.points[i][k]), bytes);
    if (!cloud.intensity.empty()) Append(cloud.intensity[i], bytes);
    if (!colors.empty()) {
      for (const unsigned char part : colors[i]) bytes += static_cast<char>(part);
    }
  }
  return bytes;
}

}  // namespace sextant
