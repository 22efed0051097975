// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace sextant::test {

/// Debian's chromium without a window, with WebGL in software.
class Browser {
 public:
  /// The reason to skip a test where it is not installed.
  static bool IsInstalled();
  static constexpr const char* kAbsent =
      "CHROMIUM ABSENT: install chromium to test reports in a browser";

  /// `profile` is a folder for its own files.
  explicit Browser(std::filesystem::path profile) : profile_(std::move(profile)) {}

  /// What the page has become after its scripts have run, and what it wrote to the console.
  struct Page {
    std::string dom;
    std::string console;
  };
  Page Load(const std::filesystem::path& page) const;
  /// The same of an address, such as "http://127.0.0.1:8735/".
  Page LoadAddress(const std::string& address) const;

  /// Writes a PNG of the page's first `height` pixels.
  void Shoot(const std::filesystem::path& page, int width, int height,
             const std::filesystem::path& png) const;

 private:
  std::filesystem::path profile_;
};

}  // namespace sextant::test
