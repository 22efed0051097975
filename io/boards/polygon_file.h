// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/error.h"
#include "geometry/scan_marks.h"

namespace sextant {

/// Marks in one scan and its photo, drawn by hand: YAML, see docs/formats.md. Unfinished marks are
/// read too, so that drawing can be resumed; callers check that the marks they need are complete.
/// Errors: kIo; kParse and kNonFinite with file, line and field: no camera, unknown keys, more than
/// four edges, a quadrilateral that crosses itself, repeated boards or corners.
/// Time and memory are those of ParseYaml (io/text/yaml_node.h); at most kMaxBoards boards.
Expected<ScanMarks> ReadPolygons(const std::filesystem::path& path);
Expected<ScanMarks> ParsePolygons(std::string_view text, const std::string& file);

std::string FormatPolygons(const ScanMarks& marks);

}  // namespace sextant
