// SPDX-License-Identifier: Apache-2.0
#include "simulator/session/session_folder.h"

#include <fmt/core.h>

#include <algorithm>
#include <system_error>

#include "io/output/output_file.h"
#include "io/text/text_file.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

constexpr const char* kSceneFile = "scene.yaml";
constexpr const char* kConfigurationFile = "simulation.yaml";

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
  SEXTANT_ASSIGN_OR_RETURN(OutputFolder locked, OutputFolder::Open(path));
  const SessionFolder folder(std::make_shared<const OutputFolder>(std::move(locked)));
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<std::string> names, folder.FileNames());
  const bool is_ours = std::ranges::count(names, kConfigurationFile) > 0;
  for (const std::string& name : names) {
    if (is_ours || name == kSceneFile) continue;
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("the folder '{}' holds '{}' and no {}: expected an empty folder "
                                 "or one of an earlier simulation",
                                 path.string(), name, kConfigurationFile));
  }
  if (is_ours) {
    // The scene first, as it differs more often.
    SEXTANT_RETURN_IF_ERROR(RequireSame(path / kSceneFile, scene_text));
    SEXTANT_RETURN_IF_ERROR(RequireSame(path / kConfigurationFile, configuration));
    return folder;
  }
  // The configuration is written last, so that its presence marks a complete folder.
  SEXTANT_RETURN_IF_ERROR(folder.Write(kSceneFile, scene_text));
  SEXTANT_RETURN_IF_ERROR(folder.Write(kConfigurationFile, configuration));
  return folder;
}

Expected<std::vector<std::string>> SessionFolder::FileNames() const {
  std::vector<std::string> names;
  std::error_code error;
  for (fs::directory_iterator entry(path(), error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!OutputFolder::IsPassing(name)) names.push_back(name);
  }
  std::ranges::sort(names);
  if (!error) return names;
  return MakeError(ErrorCode::kIo, fmt::format("cannot read the folder '{}': {}", path().string(),
                                               error.message()));
}

Expected<bool> SessionFolder::Complete(const std::string& name,
                                       const std::function<Expected<std::string>()>& make) const {
  std::error_code ignored;
  if (fs::is_regular_file(path() / name, ignored)) return false;
  SEXTANT_ASSIGN_OR_RETURN(const std::string text, make());
  SEXTANT_RETURN_IF_ERROR(Write(name, text));
  return true;
}

Expected<void> SessionFolder::Write(const std::string& name, std::string_view text) const {
  return WriteFileAtomically(path() / name, text);
}

}  // namespace sextant
