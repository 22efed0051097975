// SPDX-License-Identifier: Apache-2.0
#include "io/cameras/camera_file.h"

#include "io/cameras/camera_text.h"
#include "io/cameras/camera_tree.h"
#include "io/text/line_reader.h"
#include "io/text/text_file.h"

namespace sextant {

namespace {

// A line such as [image] begins no YAML, "intrinsic" alone is Livox's.
bool IsIni(std::string_view text, const std::string& file) {
  LineReader in(file, text);
  if (!in.Next() || in.field_count() != 1) return false;
  const std::string_view first = in.Field(0);
  return (first.starts_with('[') && first.ends_with(']')) || first == "intrinsic";
}

}  // namespace

Expected<Camera> ReadCamera(const std::filesystem::path& path) {
  const std::string text = path.string();
  const std::size_t colon = text.rfind(':');
  std::error_code ignored;
  if (colon == std::string::npos || std::filesystem::exists(path, ignored)) {
    return ReadWith(path, ParseCamera);
  }
  return ReadWith(text.substr(0, colon), [&](std::string_view content, const std::string& file) {
    return ParseNamedCamera(content, file, std::string_view(text).substr(colon + 1));
  });
}

Expected<Camera> ParseCamera(std::string_view text, const std::string& file) {
  return ParseNamedCamera(text, file, {});
}

Expected<Camera> ParseNamedCamera(std::string_view text, const std::string& file,
                                  std::string_view name) {
  constexpr std::string_view kByteOrderMark = "\xef\xbb\xbf";
  if (text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  if (text.starts_with("<?xml") || text.starts_with("<opencv_storage")) {
    SEXTANT_ASSIGN_OR_RETURN(const YamlNode root, ParseCameraXml(text, file));
    return CameraOfTree(root, file, name);
  }
  if (IsIni(text, file)) return ParseCameraIni(text, file);
  if (auto colmap = ParseCameraColmap(text, file, name)) return *std::move(colmap);
  if (const auto assignments = TreeOfAssignments(text)) {
    return CameraOfTree(*assignments, file, name);
  }
  return ParseCameraYaml(text, file, name);
}

}  // namespace sextant
