// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "base/error.h"
#include "io/bag/bag.h"

namespace sextant {

/// The readers of OpenBag. `owner` keeps the bytes alive; `file` names them in error messages.
Expected<std::unique_ptr<Bag>> OpenRosbag1(std::string_view bytes, const std::string& file,
                                           std::shared_ptr<const void> owner);
Expected<std::unique_ptr<Bag>> OpenMcap(std::string_view bytes, const std::string& file,
                                        std::shared_ptr<const void> owner);
Expected<std::unique_ptr<Bag>> OpenRosbag2Sqlite(const std::filesystem::path& path);

}  // namespace sextant
