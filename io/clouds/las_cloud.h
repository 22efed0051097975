// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/error.h"
#include "geometry/point_cloud.h"

namespace sextant {

/// The first bytes of every LAS and LAZ file.
inline constexpr std::string_view kLasMagic = "LASF";

/// Reads a scan from an uncompressed LAS file (ASPRS, versions 1.0 to 1.4, all point formats):
/// coordinates in metres, intensity, and times where the format has them. Compressed files (LAZ)
/// are refused with the command that converts them: no small library of Debian reads them.
/// Errors: kIo; kParse, with the byte. Time is linear in the size; memory is at most twice it.
Expected<PointCloud> ReadLasCloud(const std::filesystem::path& path);
Expected<PointCloud> ParseLasCloud(std::string_view bytes, const std::string& file);

}  // namespace sextant
