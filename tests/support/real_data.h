// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>

namespace sextant::test {

/// Folder of the real data: SEXTANT_DATA, else ../shared/data next to the checkout; none if absent.
std::optional<std::filesystem::path> RealDataFolder();

}  // namespace sextant::test

/// Declares `variable` as the path of a file of the real data, or skips the test and prints the
/// reason.
#define SEXTANT_REAL_DATA(variable, relative)                                              \
  const auto variable##_folder = sextant::test::RealDataFolder();                          \
  if (!variable##_folder) {                                                                \
    GTEST_SKIP() << "REAL DATA ABSENT: set SEXTANT_DATA to the folder that has " relative; \
  }                                                                                        \
  const std::filesystem::path variable = *variable##_folder / relative
