// SPDX-License-Identifier: Apache-2.0
#include "simulator/session/session_folder.h"

#include <fmt/core.h>

#include <system_error>
#include <vector>

#include "io/text/text_file.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSceneFile = "scene.yaml";
constexpr const char* kConfigurationFile = "simulation.yaml";

bool IsHalfWritten(const std::string& name) {
  return name.starts_with('.') && name.ends_with(".tmp");
}

Error FolderError(const fs::path& path, const std::error_code& reason) {
  return {ErrorCode::kIo,
          fmt::format("cannot use the folder '{}': {}", path.string(), reason.message())};
}

Expected<void> RequireSame(const fs::path& path, std::string_view expected) {
  SEXTANT_ASSIGN_OR_RETURN(const std::string text, ReadTextFile(path));
  if (text == expected) return {};
  return MakeError(
      ErrorCode::kInvalidInput,
      fmt::format("{}: the folder holds another simulation; remove it or choose another folder",
                  path.string()));
}

}  // namespace

Expected<SessionFolder> SessionFolder::Open(const fs::path& path, std::string_view scene_text,
                                            std::string_view configuration) {
  std::error_code failed;
  fs::create_directories(path, failed);
  if (failed) return tl::unexpected<Error>(FolderError(path, failed));
  std::vector<fs::path> half_written;
  std::string stranger;
  bool is_ours = false;
  for (fs::directory_iterator entry(path, failed), end; !failed && entry != end;
       entry.increment(failed)) {
    const std::string name = entry->path().filename().string();
    if (IsHalfWritten(name)) {
      half_written.push_back(entry->path());
    } else if (name == kConfigurationFile) {
      is_ours = true;
    } else if (name != kSceneFile) {
      stranger = name;
    }
  }
  if (failed) return tl::unexpected<Error>(FolderError(path, failed));
  if (!is_ours && !stranger.empty()) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("the folder '{}' holds '{}' and no {}: expected an empty folder "
                                 "or one of an earlier simulation",
                                 path.string(), stranger, kConfigurationFile));
  }
  const SessionFolder folder(path);
  if (is_ours) {
    // The scene first, as it differs more often.
    SEXTANT_RETURN_IF_ERROR(RequireSame(path / kSceneFile, scene_text));
    SEXTANT_RETURN_IF_ERROR(RequireSame(path / kConfigurationFile, configuration));
  }
  for (const fs::path& leftover : half_written) fs::remove(leftover, failed);
  if (is_ours) return folder;
  // The configuration is written last, so that its presence marks a complete folder.
  SEXTANT_RETURN_IF_ERROR(folder.Write(kSceneFile, scene_text));
  SEXTANT_RETURN_IF_ERROR(folder.Write(kConfigurationFile, configuration));
  return folder;
}

Expected<bool> SessionFolder::Complete(const std::string& name,
                                       const std::function<Expected<std::string>()>& make) const {
  std::error_code ignored;
  if (fs::is_regular_file(path_ / name, ignored)) return false;
  SEXTANT_ASSIGN_OR_RETURN(const std::string text, make());
  SEXTANT_RETURN_IF_ERROR(Write(name, text));
  return true;
}

Expected<void> SessionFolder::Write(const std::string& name, std::string_view text) const {
  return WriteFileAtomically(path_ / name, text);
}

}  // namespace sextant
