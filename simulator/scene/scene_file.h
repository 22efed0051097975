// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "base/error.h"
#include "simulator/scene/scene.h"

namespace sextant {

inline constexpr std::size_t kMaxSceneBoards = 1000;
inline constexpr std::size_t kMaxSceneCameras = 16;
/// Limit for walls, boxes and cylinders each.
inline constexpr std::size_t kMaxSceneShapes = 10'000;

/// Reads a scene from YAML (docs/formats.md) without the checks of ValidateScene. Errors: kIo;
/// kParse and kNonFinite with file, line and field: unknown keys, inconsistent boards, lists that
/// are too long.
/// Time and memory are those of ParseYaml (io/text/yaml_node.h).
Expected<Scene> ReadScene(const std::filesystem::path& path);
Expected<Scene> ParseScene(std::string_view text, const std::string& file);

}  // namespace sextant
