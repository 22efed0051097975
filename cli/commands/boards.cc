// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <optional>
#include <utility>
#include <vector>

#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "cli/search_options.h"
#include "features/lidar/polygon_edges.h"
#include "io/boards/board_file.h"
#include "io/boards/polygon_file.h"
#include "io/clouds/cloud_file.h"
#include "io/text/text_file.h"
#include "report/boards_report.h"
#include "report/scan_picture.h"

namespace sextant::cli {
namespace {

struct BoardsOptions {
  std::vector<std::string> scans{};
  std::string boards_path{};
  std::string extractor = "rectangle";
  std::string polygons_path{};  ///< Edges marked by hand; empty: boards are searched.
  SearchArguments search{};
  std::string overlay_path{};  ///< Empty: none.
  std::string json_path{};     ///< See Deliver.
  GivenOptions given{};
};

void Declare(BoardsOptions& options, Arguments& arguments) {
  arguments.Add("SCAN", options.scans,
                "Scans, any number: PCD, PLY, LAS, npy, KITTI .bin or a table\n(.csv, .xyz)",
                {.required = true});
  arguments.Add("--board", options.boards_path,
                "Boards to find (YAML, or marker_coordinates.txt of the original package)",
                {.required = true});
  arguments.Add("--extractor", options.extractor,
                "rectangle (known size), plane_lines, lines3d (the paper's) or lines3d_raw",
                {.shows_default = true});
  arguments.Add("--polygons", options.polygons_path,
                "Use the edges marked with sextant mark instead of a search");
  DeclareSearch(options.search, arguments);
  arguments.Add("--overlay", options.overlay_path,
                "Draw the scan around the boards with their corners (.png or .jpg; one scan)",
                {.writes = Writes::kFile});
  arguments.Add("--json", options.json_path, "Write the results as JSON; - for standard output",
                {.writes = Writes::kFileOrStandardOutput});
  arguments.ReportGiven(options.given);
}

// The boards that the search finds, or those in the polygons that a person has drawn.
Expected<BoardSearch> SearchOf(const ScanRings& rings, const std::vector<Board>& boards,
                               const BoardSearchOptions& options,
                               const std::optional<ScanMarks>& marks) {
  if (!marks) return FindBoards(rings, boards, options);
  BoardSearch search;
  SEXTANT_ASSIGN_OR_RETURN(search.found, PatchesFromPolygons(rings, *marks, boards, options));
  return search;
}

ScanReport Examine(const std::string& path, const std::vector<Board>& boards,
                   const std::string& extractor, const BoardSearchOptions& options,
                   const std::optional<ScanMarks>& marks) {
  ScanReport report{.path = path};
  const Expected<PointCloud> cloud = ReadCloud(path);
  if (!cloud) {
    report.failure = cloud.error();
    return report;
  }
  const Expected<ScanRings> rings = ScanRings::Build(*cloud);
  if (!rings) {
    report.failure = Error{rings.error().code, fmt::format("{}: {}", path, rings.error().message)};
    return report;
  }
  report.returns = static_cast<int>(rings->points().size());
  report.rings = rings->rings();
  Expected<BoardSearch> search = SearchOf(*rings, boards, options, marks);
  if (!search) {
    report.failure =
        Error{search.error().code, fmt::format("{}: {}", path, search.error().message)};
    return report;
  }
  report.search = *std::move(search);
  for (const BoardPatch& patch : report.search.found) {
    report.corners.push_back(
        ExtractCorners(extractor, patch, boards[static_cast<std::size_t>(patch.board)]));
  }
  return report;
}

bool HasAllBoards(const ScanReport& report, std::size_t boards) {
  if (report.failure || report.corners.size() < boards) return false;
  for (const Expected<LidarCorners>& corners : report.corners) {
    if (!corners) return false;
  }
  return true;
}

Expected<void> CheckScans(const BoardsOptions& options) {
  if (!options.polygons_path.empty()) {
    SEXTANT_RETURN_IF_ERROR(
        RefuseGiven(options.given, {"--region"}, "is for a search, which --polygons replaces"));
  }
  if (!options.overlay_path.empty() && options.scans.size() > 1) {
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format("--overlay draws one scan, and {} were given", options.scans.size()));
  }
  for (const std::string& scan : options.scans) SEXTANT_RETURN_IF_ERROR(CheckInput(scan));
  return {};
}

int Run(const BoardsOptions& options) {
  const Expected<std::vector<Board>> boards = ReadBoards(options.boards_path);
  if (!boards) return Refuse("boards", boards.error());
  const Expected<BoardSearchOptions> search = SearchOptionsFrom(options.search);
  if (!search) return Refuse("boards", search.error());
  std::optional<ScanMarks> marks;
  if (!options.polygons_path.empty()) {
    const Expected<ScanMarks> read = ReadPolygons(options.polygons_path);
    if (!read) return Refuse("boards", read.error());
    marks = *read;
  }
  // The name is checked before any scan is read.
  if (const auto known = ExtractCorners(options.extractor, {}, {});
      !known && known.error().code == ErrorCode::kUnknownName) {
    return Refuse("boards", known.error());
  }
  if (const Expected<void> ok = CheckScans(options); !ok) return Refuse("boards", ok.error());
  std::vector<ScanReport> reports(options.scans.size());
  {
    Progress progress;
    ProgressCounter counter(progress.Callback(), "scans", reports.size());
    tbb::parallel_for(std::size_t{0}, reports.size(), [&](std::size_t i) {
      reports[i] = Examine(options.scans[i], *boards, options.extractor, *search, marks);
      counter.Step();
    });
  }
  int complete = 0;
  bool unreadable = false;
  for (const ScanReport& report : reports) {
    complete += HasAllBoards(report, boards->size()) ? 1 : 0;
    if (!report.failure) continue;
    unreadable = true;
    Refuse("boards", *report.failure);
  }
  const int found = complete == static_cast<int>(reports.size()) ? kAnswered : kNoAnswer;
  const int code =
      Deliver("boards", options.json_path, DescribeScans(reports, *boards, options.extractor),
              ScansJson(reports, *boards, options.extractor), unreadable ? kWrongUse : found);
  if (options.overlay_path.empty() || unreadable) return code;
  const Expected<void> drawn =
      DrawScan(options.scans[0], reports[0], *boards, options.overlay_path);
  return drawn ? code : Refuse("boards", drawn.error());
}

}  // namespace

Command BoardsCommand() {
  constexpr const char* kFooter =
      "Examples:\n"
      "  sextant boards scan.pcd --board boards.yaml\n"
      "  sextant boards scans/*.pcd --board boards.yaml --extractor lines3d --json corners.json";
  return MakeCommand<BoardsOptions>("boards", "Boards in LiDAR scans, and their corners", kFooter,
                                    Declare, Run);
}

}  // namespace sextant::cli
