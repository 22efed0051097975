// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include "e2e/run_sextant.h"
#include "support/run_program.h"
#include "support/scratch_folder.h"

namespace sextant::test {

/// The folder of a session that `sextant simulate` has written, once per process for each scene
/// (its text) and options. Tests do not change it; CopyOfSession is for those that must.
inline std::filesystem::path SharedSession(const std::string& scene,
                                           const std::string& options = "") {
  static std::map<std::string, std::unique_ptr<ScratchFolder>> folders;
  std::unique_ptr<ScratchFolder>& folder = folders[scene + options];
  if (folder == nullptr) {
    folder = std::make_unique<ScratchFolder>();
    WriteText(folder->path() / "scene.yaml", scene);
    const ProgramRun run =
        RunSextant("simulate " + (folder->path() / "scene.yaml").string() + " --out " +
                   (folder->path() / "session").string() + " " + options);
    EXPECT_EQ(run.exit_code, 0) << run.err;
  }
  return folder->path() / "session";
}

/// A copy of the session in the folder of the current test.
inline std::filesystem::path CopyOfSession(const std::filesystem::path& session) {
  std::filesystem::path copy = TestFolder() / "session";
  std::filesystem::copy(session, copy, std::filesystem::copy_options::recursive);
  return copy;
}

}  // namespace sextant::test
