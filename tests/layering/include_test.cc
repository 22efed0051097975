// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "support/source_tree.h"

namespace sextant::test {
namespace {

using Folders = std::vector<std::string_view>;

// What a folder may include of ours besides itself. Siblings (features and io; camera and lidar)
// never include each other.
const std::map<std::string_view, Folders>& MayInclude() {
  static const std::map<std::string_view, Folders> table = {
      {"base", {}},
      {"geometry", {"base"}},
      {"solvers", {"base", "geometry"}},
      {"solvers/opencv", {"base", "geometry", "solvers"}},
      {"features/camera", {"base", "geometry", "solvers"}},
      {"features/lidar", {"base", "geometry", "solvers"}},
      {"features", {"base", "geometry", "solvers", "features/camera", "features/lidar"}},
      {"io", {"base", "geometry", "solvers"}},
      {"io/bag", {"base", "geometry", "io"}},
      {"eval/simulator", {"base", "geometry", "features/camera", "io"}},
      {"eval/camera",
       {"base", "geometry", "solvers", "features/camera", "io", "eval", "eval/simulator"}},
      {"eval/lidar", {"base", "geometry", "features/lidar", "eval", "eval/simulator"}},
      {"eval",
       {"base", "geometry", "solvers", "solvers/opencv", "features", "features/camera",
        "features/lidar", "io", "eval/simulator"}},
      {"calibrate",
       {"base", "geometry", "solvers", "features/camera", "features/lidar", "io", "io/bag",
        "eval"}},
      {"calibrate/bag",
       {"base", "geometry", "features/camera", "features/lidar", "io", "io/bag", "calibrate"}},
      {"eval/experiment",
       {"base", "geometry", "solvers", "solvers/opencv", "features/camera", "features/lidar", "io",
        "eval", "eval/simulator", "eval/camera", "eval/lidar", "calibrate"}},
      {"bench",
       {"base", "geometry", "solvers", "solvers/opencv", "features", "features/camera",
        "features/lidar", "io", "io/bag", "eval", "eval/simulator", "eval/camera", "eval/lidar",
        "eval/experiment", "calibrate", "calibrate/bag", "tests"}},
      {"cli",
       {"base", "geometry", "solvers", "solvers/opencv", "features", "features/camera",
        "features/lidar", "io", "io/bag", "eval", "eval/simulator", "eval/camera", "eval/lidar",
        "eval/experiment", "calibrate", "calibrate/bag"}},
      {"cli/mpi", {"base", "io", "eval/experiment", "cli"}},
      {"tests",
       {"base", "geometry", "solvers", "solvers/opencv", "features", "features/camera",
        "features/lidar", "io", "io/bag", "eval", "eval/simulator", "eval/camera", "eval/lidar",
        "eval/experiment", "calibrate", "calibrate/bag", "bench", "cli"}},
  };
  return table;
}

// Libraries that only some folders may include.
const std::map<std::string_view, Folders>& OnlyIn() {
  static const std::map<std::string_view, Folders> table = {
      {"opencv2/",
       {"solvers/opencv", "features", "features/camera", "features/lidar", "io", "eval",
        "eval/simulator", "eval/camera", "eval/experiment", "calibrate", "calibrate/bag", "bench",
        "cli", "tests"}},
      {"apriltag", {"features/camera", "bench"}},
      {"tbb/",
       {"features", "eval", "eval/simulator", "eval/camera", "eval/lidar", "eval/experiment",
        "calibrate", "calibrate/bag", "bench", "cli", "cli/mpi", "tests"}},
      {"ceres/", {"solvers", "features", "features/camera", "features/lidar", "bench", "tests"}},
      {"sqlite3", {"io/bag", "tests"}},
      {"bzlib", {"io/bag"}},
      {"lz4", {"io/bag"}},
      {"zstd", {"io/bag"}},
      {"yaml-cpp/", {"io", "eval", "tests"}},
      {"nlohmann/", {"io", "eval", "eval/experiment", "bench", "cli", "tests"}},
      {"CLI/", {"cli", "cli/mpi"}},
      {"mpi.h", {"cli/mpi"}},
      {"opengv/", {"bench"}},
      {"pcl/", {"bench"}},
      {"open3d/", {"bench"}},
      {"valgrind/", {"tests"}},
      {"gtest/", {"tests"}},
      {"gmock/", {"tests"}},
  };
  return table;
}

// Tests stand in folders like those they test and may include what any test may.
std::string_view LayerOf(std::string_view folder) {
  return folder.starts_with("tests") ? "tests" : folder;
}

bool Contains(const Folders& folders, std::string_view folder) {
  return std::ranges::count(folders, folder) > 0;
}

// Why a file of the layer `from` may not #include "header"; none where it may.
std::optional<std::string> WhyForbidden(std::string_view from, std::string_view header) {
  const std::size_t slash = header.rfind('/');
  if (slash == std::string_view::npos) return "is not named from the project's root";
  const std::string_view folder = header.substr(0, slash);
  // The tests' own headers are named from their folder.
  const bool is_of_tests = Exists("tests/" + std::string(header));
  const std::string_view to = is_of_tests ? "tests" : LayerOf(folder);
  if (!MayInclude().contains(from)) return "comes from a folder that MayInclude() does not know";
  if (to == from || Contains(MayInclude().at(from), to)) return std::nullopt;
  return "points against the layers";
}

std::optional<std::string> WhyForbiddenLibrary(std::string_view from, std::string_view header) {
  for (const auto& [prefix, folders] : OnlyIn()) {
    if (header.starts_with(prefix) && !Contains(folders, from)) {
      return "is of a library that OnlyIn() keeps out of this folder";
    }
  }
  return std::nullopt;
}

// The header that a line includes between `open` and `close`; empty where it includes none.
std::string_view IncludedBy(std::string_view line, char open, char close) {
  constexpr std::string_view kInclude = "#include ";
  if (!line.starts_with(kInclude) || line.size() <= kInclude.size()) return {};
  line.remove_prefix(kInclude.size());
  if (line.front() != open) return {};
  return line.substr(1, line.find(close, 1) - 1);
}

TEST(Layering, EveryIncludeGoesDownward) {
  int includes = 0;
  for (const SourceFile& file : ReadSourceTree()) {
    if (!IsCpp(file) || file.folder == "tests/install/consumer") continue;
    const std::string_view from = LayerOf(file.folder);
    for (std::size_t i = 0; i < file.lines.size(); ++i) {
      const std::string_view ours = IncludedBy(file.lines[i], '"', '"');
      const std::string_view library = IncludedBy(file.lines[i], '<', '>');
      includes += ours.empty() ? 0 : 1;
      const std::optional<std::string> why =
          ours.empty() ? WhyForbiddenLibrary(from, library) : WhyForbidden(from, ours);
      EXPECT_FALSE(why) << file.path << ":" << i + 1 << ": " << file.lines[i] << " " << *why;
    }
  }
  EXPECT_GT(includes, 50);
}

TEST(Layering, EveryIncludedHeaderStandsWhereItsNameSays) {
  for (const SourceFile& file : ReadSourceTree()) {
    if (!IsCpp(file) || file.folder == "tests/install/consumer") continue;
    for (const std::string& line : file.lines) {
      const std::string header(IncludedBy(line, '"', '"'));
      EXPECT_TRUE(header.empty() || Exists(header) || Exists("tests/" + header))
          << file.path << ": " << line << " names no file of the project";
    }
  }
}

TEST(Layering, WrongDirectionsAreSeen) {
  EXPECT_TRUE(WhyForbidden("geometry", "solvers/kernels/kabsch.h"));
  EXPECT_TRUE(WhyForbidden("solvers", "solvers/opencv/epnp.h"));
  EXPECT_TRUE(WhyForbidden("features", "io/problems/points_file.h"));
  EXPECT_TRUE(WhyForbidden("io", "features/camera/aruco.h"));
  EXPECT_TRUE(WhyForbidden("io", "io/bag/bag.h"));
  EXPECT_TRUE(WhyForbidden("features/camera", "features/lidar/board.h"));
  EXPECT_TRUE(WhyForbidden("eval", "support/scenes.h"));
  EXPECT_TRUE(WhyForbidden("solvers", "kabsch.h"));
  EXPECT_TRUE(WhyForbidden("unknown", "base/error.h"));
  EXPECT_TRUE(WhyForbiddenLibrary("solvers", "opencv2/core.hpp"));
  EXPECT_FALSE(WhyForbiddenLibrary("solvers/opencv", "opencv2/core.hpp"));
  EXPECT_FALSE(WhyForbidden("solvers", "geometry/rigid3d.h"));
  EXPECT_FALSE(WhyForbidden("tests", "support/scenes.h"));
  EXPECT_EQ(IncludedBy("#include \"io/a.h\"", '"', '"'), "io/a.h");
  EXPECT_EQ(IncludedBy("#include <opencv2/core.hpp>", '<', '>'), "opencv2/core.hpp");
  EXPECT_EQ(IncludedBy("int include = 0;", '"', '"'), "");
}

}  // namespace
}  // namespace sextant::test
