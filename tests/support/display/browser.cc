// SPDX-License-Identifier: Apache-2.0
#include "support/display/browser.h"

#include <gtest/gtest.h>

#include <sstream>
#include <vector>

#include "base/process/run_process.h"

namespace sextant::test {
namespace {

ProcessEnd RunChromium(const std::filesystem::path& profile,
                       const std::vector<std::string>& arguments) {
  std::vector<std::string> command = {"chromium",
                                      "--headless",
                                      "--no-sandbox",
                                      "--disable-dev-shm-usage",  // It is small in containers.
                                      "--disable-extensions",
                                      "--disable-background-networking",
                                      "--no-first-run",
                                      "--hide-scrollbars",
                                      "--use-angle=swiftshader",
                                      "--enable-unsafe-swiftshader",
                                      "--ignore-gpu-blocklist",
                                      "--enable-logging=stderr",
                                      "--virtual-time-budget=4000",
                                      "--user-data-dir=" + profile.string()};
  command.insert(command.end(), arguments.begin(), arguments.end());
  const Expected<ProcessEnd> end = RunProcess(command, {.timeout = std::chrono::seconds(120)});
  EXPECT_TRUE(end) << end.error().message;
  if (!end) return {};
  EXPECT_EQ(end->exit_code, 0) << end->err;
  return *end;
}

}  // namespace

bool Browser::IsInstalled() {
  static const bool is_installed = RunProcess({"chromium", "--version"}).has_value();
  return is_installed;
}

Browser::Page Browser::Load(const std::filesystem::path& page) const {
  return LoadAddress("file://" + page.string());
}

Browser::Page Browser::LoadAddress(const std::string& address) const {
  const ProcessEnd end = RunChromium(profile_, {"--dump-dom", address});
  Page loaded{.dom = end.out, .console = {}};
  std::istringstream lines(end.err);
  for (std::string line; std::getline(lines, line);) {
    if (line.find("CONSOLE") != std::string::npos) loaded.console += line + "\n";
  }
  return loaded;
}

void Browser::Shoot(const std::filesystem::path& page, int width, int height,
                    const std::filesystem::path& png) const {
  RunChromium(profile_, {"--window-size=" + std::to_string(width) + "," + std::to_string(height),
                         "--screenshot=" + png.string(), "file://" + page.string()});
}

}  // namespace sextant::test
