// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "cli/search_options.h"
#include "eval/extractors/extractor_study.h"
#include "eval/synthetic/simulate_pairs.h"

namespace sextant::cli {

/// Exit codes, a contract with scripts.
inline constexpr int kAnswered = 0;
inline constexpr int kNoAnswer = 1;  ///< The input was read, and no solver answered.
inline constexpr int kWrongUse = 2;  ///< Wrong usage, or an input or output that fails.

/// What `solve` and `compare` share.
struct InputOptions {
  std::string problem_path;
  std::string camera_path;  ///< Empty: the problem's own.
  std::string boards_path;  ///< Board file or marker_coordinates.txt; empty: the problem's own.
  bool reorder = false;
  std::string json_path;  ///< Empty: none; "-": standard output, and no text there.
};

struct SolveOptions {
  InputOptions input;
  std::string solver = "kabsch";
  std::vector<std::string> overlay;  ///< Image to draw on and file to write; empty: none.
};

struct CompareOptions {
  InputOptions input;
  std::string solvers;    ///< Empty: every one whose needs the input meets.
  std::string plot_path;  ///< Empty: none.
};

struct AverageOptions {
  std::string log_path;
  std::string json_path;
};

struct CatalogueOptions {
  std::string name;  ///< Empty: all, a line each.
  bool markdown = false;
};

struct LidarsOptions {
  bool markdown = false;
};

struct ConvertOptions {
  std::string from;
  std::string to;
};

struct BoardOptions {
  std::string board_path;
  std::string out;
  std::optional<int> id;  ///< None: every board of the file.
  double dpi = 150.0;     ///< Of a PNG.
};

struct DetectOptions {
  std::vector<std::string> images;
  std::string board_path;    ///< Empty: all tags that the detector finds.
  std::string camera_path;   ///< Empty: no poses.
  std::string detector;      ///< Empty: the usual ones of the boards' families.
  std::string overlay_path;  ///< Empty: none.
  std::string json_path;
  bool quick = false;  ///< Without looking into why a tag is missing.
};

struct DetectorStudyCommandOptions {
  int trials = 200;
  std::uint64_t seed = 1;
  bool markdown = false;
};

struct ExtractorStudyCommandOptions {
  std::vector<std::string> models;  ///< Empty: all.
  BoardHolding holding = BoardHolding::kHung;
  int trials = 0;  ///< 0: the list of extractors only.
  std::uint64_t seed = 1;
  bool markdown = false;
};

struct SimulatePairsOptions {
  PairSimulation simulation;
  std::string out = "session.yaml";
};

struct SimulateSessionOptions {
  std::string scene_path;
  std::string out = "session";
  std::string level = "full";
  std::string pcd = "binary";
  std::string sheet_path;  ///< Empty: none.
  std::uint64_t seed = 1;
  int scans = 1;
  double interval_s = 1.0;
  bool ideal = false;
  bool bag = false;
  double lidar_sigma_m = 0.0068;
  std::optional<double> pixel_sigma_px;  ///< None: as the level has it.
};

struct ExperimentOptions {
  std::string experiment_path;
  std::string out;                     ///< Folder; empty: results/NAME.
  std::string solvers;                 ///< Empty: the file's.
  std::vector<std::string> row_files;  ///< Of shards, to be merged.
  int threads = 0;                     ///< 0: all.
  std::uint64_t trials = 0;            ///< 0: as the file says.
  std::optional<std::uint64_t> seed;
  std::string shard;  ///< "2/8"; empty: all.
  bool quick = false;
  bool fresh = false;
  bool no_csv = false;
};

struct FuseOptions {
  std::vector<std::string> clouds;
  std::vector<std::string> from;  ///< A file with cam_from_lidar for each cloud but the last.
  std::string to;                 ///< The same of the last cloud.
  std::string rts_path;           ///< Instead of both.
  std::string out = "fused.ply";
};

struct ReproduceOptions {
  std::string experiments = "experiments";
  std::string claims = "paper/claims.yaml";
  std::string out;  ///< Empty: paper, or build/paper-quick.
  int threads = 0;  ///< 0: all.
  bool quick = false;
};

struct MarkOptions {
  std::string cloud_path;
  std::string image_path;                   ///< Empty: none.
  std::string camera_path;                  ///< Empty: one is assumed.
  std::vector<std::string> cam_from_lidar;  ///< A file, or x y z qw qx qy qz; empty: the axes.
  double yaw_deg = 0.0;                     ///< Of the assumed camera, to the left.
  std::vector<int> ids;                     ///< Of the boards, from left to right.
  std::string out_path = "polygons.yaml";
  std::string render_path;  ///< A picture of the window to write instead of opening it.
  int width_px = 1280;      ///< Of the window.
  int height_px = 800;
};

struct BagOptions {
  std::string path;
  std::string extract_folder;  ///< Empty: nothing is written.
  double tolerance_s = 0.05;
};

struct BoardsOptions {
  std::vector<std::string> scans;
  std::string boards_path;
  std::string extractor = "rectangle";
  std::string polygons_path;  ///< Edges marked by hand; empty: boards are searched.
  SearchArguments search;
  std::string overlay_path;  ///< Empty: none.
  std::string json_path;
};

/// Each runs one command, prints its answer or one line of error, and returns the exit code.
int RunSolve(const SolveOptions& options);
int RunCompare(const CompareOptions& options);
int RunBoards(const BoardsOptions& options);
int RunAverage(const AverageOptions& options);
int RunCatalogue(const CatalogueOptions& options);
int RunLidars(const LidarsOptions& options);
int RunBoard(const BoardOptions& options);
int RunDetect(const DetectOptions& options);
int RunDetectors(const DetectorStudyCommandOptions& options);
int RunExtractors(const ExtractorStudyCommandOptions& options);
int RunConvert(const ConvertOptions& options);
int RunBag(const BagOptions& options);
int RunFuse(const FuseOptions& options);
int RunReproduce(const ReproduceOptions& options);
int RunExperiment(const ExperimentOptions& options);
int RunMerge(const ExperimentOptions& options);
int RunKinds();
int RunMark(const MarkOptions& options);
int RunSimulateSession(const SimulateSessionOptions& options);
int RunSimulatePairs(const SimulatePairsOptions& options);

}  // namespace sextant::cli
