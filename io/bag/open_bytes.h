// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include "base/error.h"
#include "io/bag/bag.h"

namespace sextant {

/// The readers of OpenBag. `owner` keeps the bytes alive; without one, they must outlive the bag.
/// `file` names them in error messages. Time and memory are those that Bag states.
Expected<std::unique_ptr<Bag>> OpenRosbag1(std::string_view bytes, const std::string& file,
                                           std::shared_ptr<const void> owner);
Expected<std::unique_ptr<Bag>> OpenMcap(std::string_view bytes, const std::string& file,
                                        std::shared_ptr<const void> owner);
// The bytes of a temporary string would not outlive the bag.
Expected<std::unique_ptr<Bag>> OpenRosbag1(std::string&&, const std::string&,
                                           std::nullptr_t) = delete;
Expected<std::unique_ptr<Bag>> OpenMcap(std::string&&, const std::string&, std::nullptr_t) = delete;
Expected<std::unique_ptr<Bag>> OpenRosbag2Sqlite(const std::filesystem::path& path);

}  // namespace sextant
