// SPDX-License-Identifier: Apache-2.0
// Paths that are no files: every reader refuses them at once, in one line.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "calibrate/observe/photo_file.h"
#include "calibrate/session/session.h"
#include "eval/experiment/definition/experiment.h"
#include "eval/experiment/reproduction/claims.h"
#include "eval/experiment/run/row_file.h"
#include "fuzz/outcome.h"
#include "io/boards/board_file.h"
#include "io/boards/marker_files.h"
#include "io/boards/polygon_file.h"
#include "io/cameras/camera_file.h"
#include "io/clouds/cloud_file.h"
#include "io/original/average_log.h"
#include "io/original/original_config.h"
#include "io/poses/pose_file.h"
#include "io/problems/read_problem.h"
#include "io/problems/transform_list.h"
#include "io/results/calibration_result.h"
#include "io/results/results_json.h"
#include "simulator/scene/scene_file.h"
#include "solvers/all/all_solvers.h"
#include "support/run_program.h"
#ifdef SEXTANT_WITH_BAG
#include "io/bag/bag.h"
#endif

namespace sextant::test {
namespace {

namespace fs = std::filesystem;

struct PathReader {
  const char* name;
  /// Reads the path, checks the outcome, and returns whether it was read.
  std::function<bool(const fs::path&)> read;
};

template <class T>
bool IsRead(const Expected<T>& outcome) {
  CheckOutcome(outcome);
  return outcome.has_value();
}

const std::vector<PathReader>& PathReaders() {
  static const std::vector<PathReader> readers = {
      {"Cloud", [](const fs::path& path) { return IsRead(ReadCloud(path)); }},
      {"Image", [](const fs::path& path) { return IsRead(ReadImage(path)); }},
      {"Camera", [](const fs::path& path) { return IsRead(ReadCamera(path)); }},
      {"Boards", [](const fs::path& path) { return IsRead(ReadBoards(path)); }},
      {"Markers", [](const fs::path& path) { return IsRead(ReadDetectedMarkers(path)); }},
      {"Polygons", [](const fs::path& path) { return IsRead(ReadPolygons(path)); }},
      {"Problem", [](const fs::path& path) { return IsRead(ReadProblem(path)); }},
      {"Transforms", [](const fs::path& path) { return IsRead(ReadTransformList(path)); }},
      {"AverageLog", [](const fs::path& path) { return IsRead(ReadAverageLog(path)); }},
      {"Config", [](const fs::path& path) { return IsRead(ReadOriginalConfig(path)); }},
      {"Results", [](const fs::path& path) { return IsRead(ReadResults(path)); }},
      {"Result", [](const fs::path& path) { return IsRead(ReadCalibrationResult(path)); }},
      {"Pose", [](const fs::path& path) { return IsRead(ReadPoseFile(path)); }},
      {"Session", [](const fs::path& path) { return IsRead(ReadSession(path)); }},
      {"Scene", [](const fs::path& path) { return IsRead(ReadScene(path)); }},
      {"Claims", [](const fs::path& path) { return IsRead(ReadClaims(path)); }},
      {"Experiment",
       [](const fs::path& path) {
         return IsRead(ReadExperiment(path, BuiltinKinds(), AllSolvers()));
       }},
      {"Rows",
       [](const fs::path& path) {
         const Expected<RowFileReader> reader = RowFileReader::Open(path);
         CheckOutcome(reader);
         return reader.has_value();
       }},
#ifdef SEXTANT_WITH_BAG
      {"Bag", [](const fs::path& path) { return IsRead(OpenBag(path)); }},
#endif
  };
  return readers;
}

void ExpectRefusedByAll(const fs::path& path) {
  for (const PathReader& reader : PathReaders()) {
    SCOPED_TRACE(reader.name);
    EXPECT_FALSE(reader.read(path));
  }
}

TEST(Paths, NothingThere) { ExpectRefusedByAll(TestFolder() / "missing"); }

TEST(Paths, AnEmptyFolder) {
  fs::create_directory(TestFolder() / "folder");
  ExpectRefusedByAll(TestFolder() / "folder");
}

TEST(Paths, ALinkToItself) {
  const fs::path link = TestFolder() / "loop";
  fs::create_symlink(link, link);
  ExpectRefusedByAll(link);
}

TEST(Paths, AFolderThatContainsItself) {
  const fs::path folder = TestFolder() / "folder";
  fs::create_directory(folder);
  fs::create_directory_symlink(folder, folder / "folder");
  ExpectRefusedByAll(folder);
}

TEST(Paths, APipeThatNobodyWrites) {
  const fs::path pipe = TestFolder() / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  ExpectRefusedByAll(pipe);
}

TEST(Paths, DevicesWithoutAnEnd) {
  ExpectRefusedByAll("/dev/zero");
  ExpectRefusedByAll("/dev/null");
}

TEST(Paths, AFileBelowAFile) {
  WriteText(TestFolder() / "file", "text");
  ExpectRefusedByAll(TestFolder() / "file" / "file");
}

TEST(Paths, ANameTooLong) { ExpectRefusedByAll(TestFolder() / std::string(5000, 'a')); }

TEST(Paths, AZeroByteInTheName) { ExpectRefusedByAll(TestPath(std::string("a\0b", 3))); }

TEST(Paths, ControlCharactersInTheName) {
  const fs::path path = TestFolder() / "a\x1b[2J\nb";
  ExpectRefusedByAll(path);
  WriteText(path, "\x1b[2J");
  ExpectRefusedByAll(path);
}

}  // namespace
}  // namespace sextant::test
