// SPDX-License-Identifier: Apache-2.0
#include "io/cameras/camera_file.h"

#include "io/text/line_reader.h"
#include "io/text/text_file.h"

namespace sextant {

Expected<Camera> ReadCamera(const std::filesystem::path& path) {
  return ReadWith(path, ParseCamera);
}

Expected<Camera> ParseCamera(std::string_view text, const std::string& file) {
  // No camera file in YAML begins with a line such as [image].
  LineReader in(file, text);
  if (in.Next() && in.field_count() == 1 && in.Field(0).starts_with('[') &&
      in.Field(0).ends_with(']')) {
    return ParseCameraIni(text, file);
  }
  return ParseCameraYaml(text, file);
}

}  // namespace sextant
