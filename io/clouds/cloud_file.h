// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/error.h"
#include "geometry/point_cloud.h"

namespace sextant {

/// Reads one scan from a file of any of these formats: PCD, PLY, LAS and npy, recognised by their
/// first bytes; KITTI's and nuScenes' .bin by their extension; and tables of numbers (.csv, .txt,
/// .xyz, .pts, .asc, .tsv, or any file that looks like one). Points with infinite or NaN
/// coordinates are rays without a return and become NaN; rings are numbered from the lowest
/// (OrderRings of io/clouds/cloud_builder.h). Errors: kIo, also for files above kMaxTextBytes;
/// kParse; kNonFinite: with the file, the line or the byte, and the field; kInvalidInput for
/// coordinates that cannot be metres. Time and memory: see the formats; at most 64 times the file's
/// size and 64 MiB.
Expected<PointCloud> ReadCloud(const std::filesystem::path& path);
/// The format is recognised by the first bytes, else by the extension of `file`.
Expected<PointCloud> ParseCloud(std::string_view bytes, const std::string& file);

/// Whether a file is a scan by its extension, in any case. Not .txt, which names anything.
bool IsCloudName(const std::filesystem::path& path);

}  // namespace sextant
