// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <functional>
#include <memory>

#include "base/nearest_name.h"
#include "base/version.h"
#include "cli/calibrate_options.h"
#include "cli/commands.h"
#include "cli/result_options.h"
#include "cli/sensor_arguments.h"
#include "cli/study_arguments.h"

namespace sextant::cli {
namespace {

constexpr const char* kIntroduction =
    "sextant finds the rigid transform cam_from_lidar between a LiDAR and a camera, says how sure "
    "it\n"
    "is, and compares every way of finding it.\n"
    "A transform is named by its frames: point_in_cam = cam_from_lidar * point_in_lidar. Camera: "
    "x\n"
    "right, y down, z forward. LiDAR: x forward, y left, z up. Metres and degrees.";

constexpr const char* kFirstSteps =
    "First steps:\n"
    "  sextant calibrate --image photo.png --cloud scan.pcd --board boards.yaml --camera "
    "camera.yaml\n"
    "  sextant simulate scene.yaml --out session    scans and images whose truth is known\n"
    "  sextant detect photo.png --board boards.yaml --camera camera.yaml    boards in a photo\n"
    "  sextant boards scan.pcd --board boards.yaml  boards in a scan\n"
    "  sextant solve points.txt                     cam_from_lidar from your own correspondences\n"
    "  sextant compare points.txt                   every solver on them\n"
    "  sextant solvers                              what there is to choose from\n"
    "Each command has its own --help with examples.\n"
    "Exit codes: 0 answered, 1 no answer (and why), 2 wrong usage or unreadable input.";

constexpr const char* kInputHelp =
    "Correspondences: points.txt of the original package, a problem file (YAML), 3D-3D or 2D-3D\n"
    "pairs (CSV), or poses.csv of cam_lidar_calibration; told apart by content";

constexpr const char* kReorderHelp =
    "Take the order of corners and boards that fits best, where another than the file's fits far\n"
    "better";

void AddInput(CLI::App& command, InputOptions& input) {
  command.add_option("FILE", input.problem_path, kInputHelp)->required();
  command.add_option("--camera", input.camera_path,
                     "Intrinsics: ROS camera_info YAML, OpenCV YAML, or .ini");
  command.add_option("--boards", input.boards_path,
                     "Known board sizes: a board file (YAML), or marker_coordinates.txt of the\n"
                     "original package");
  command.add_flag("--reorder", input.reorder, kReorderHelp);
  command.add_option("--json", input.json_path, "Write the results as JSON; - for standard output");
}

void AddSolve(CLI::App& app, SolveOptions& options) {
  CLI::App& command = *app.add_subcommand("solve", "One solver's answer, with its uncertainty");
  AddInput(command, options.input);
  command
      .add_option("--solver", options.solver, "A solver, possibly composed; see sextant solvers")
      ->capture_default_str();
  command
      .add_option("--overlay", options.overlay,
                  "IMAGE OUT: draw measured and reprojected points on the image, residuals x10")
      ->expected(2);
  command.footer(
      "Examples:\n"
      "  sextant solve points.txt\n"
      "  sextant solve points.txt --solver 'refine(ransac(kabsch, seed=7), loss=huber)'\n"
      "  sextant solve pairs.csv --camera camera.yaml --solver 'refine(epnp)' --json result.json");
}

void AddCompare(CLI::App& app, CompareOptions& options) {
  CLI::App& command = *app.add_subcommand("compare", "Many solvers on the same data, as a table");
  AddInput(command, options.input);
  command.add_option("--solvers", options.solvers,
                     "Solvers, separated by commas; default: every one whose needs the file meets");
  command.add_option("--plot", options.plot_path,
                     "Draw the residuals of every pair under every solver (.svg or .png)");
  command.footer(
      "The distance of each answer to the first is given, and to the truth where the file knows "
      "it.\n"
      "Examples:\n"
      "  sextant compare points.txt\n"
      "  sextant compare points.txt --solvers "
      "'kabsch,icp(init=centroid),drop_worst(kabsch,keep=6)'");
}

void AddAverage(CLI::App& app, AverageOptions& options) {
  CLI::App& command =
      *app.add_subcommand("average", "The single scans and true mean of an avg_values.txt");
  command.add_option("LOG", options.log_path, "avg_values.txt of the original package")->required();
  command.add_option("--json", options.json_path,
                     "Write the results as JSON; - for standard output");
  command.footer(
      "The original package renormalises its quaternion sum at every scan, so that its newest "
      "scan\n"
      "always weighs one half. This recovers the single scans and shows their true mean.\n"
      "Example:\n  sextant average conf/avg_values.txt");
}

void AddCatalogue(CLI::App& app, CatalogueOptions& options) {
  CLI::App& command = *app.add_subcommand("solvers", "What there is, with needs and options");
  command.add_option("NAME", options.name, "One solver in full");
  command.add_flag("--markdown", options.markdown, "The whole catalogue as a page");
  command.footer("Examples:\n  sextant solvers\n  sextant solvers ransac");
}

void AddLidars(CLI::App& app, LidarsOptions& options) {
  CLI::App& command = *app.add_subcommand("lidars", "The LiDARs that can be simulated");
  command.add_flag("--markdown", options.markdown, "For a page");
}

void AddConvert(CLI::App& app, ConvertOptions& options) {
  CLI::App& command =
      *app.add_subcommand("convert", "From one format of correspondences to another");
  command.add_option("FROM", options.from, kInputHelp)->required();
  command
      .add_option("TO", options.to,
                  "Written by its extension: .yaml (everything), .csv (pairs), .txt (points.txt)")
      ->required();
  command.footer("Example:\n  sextant convert points.txt session.yaml");
}

void AddSimulateSession(CLI::App& command, SimulateSessionOptions& options) {
  command.add_option("SCENE", options.scene_path,
                     "Scene file (YAML); a set of them is in experiments/scenes");
  command
      .add_option("--out", options.out,
                  "Folder to write; a run that was stopped goes on where it was")
      ->capture_default_str();
  command.add_option("--scans", options.scans, "How many scans, with their images")
      ->capture_default_str();
  command.add_option("--seed", options.seed, "The same seed gives the same bytes")
      ->capture_default_str();
  command
      .add_option("--level", options.level,
                  "full: points and images; corners: as extractors find them; pairs: pixels marked "
                  "by a\nperson")
      ->capture_default_str();
  command.add_option("--interval", options.interval_s, "From one scan to the next [s]")
      ->capture_default_str();
  command.add_flag("--bag", options.bag, "Also session.bag, of ROS 1, with the scans and images");
  command.add_flag("--ideal", options.ideal, "Sensors without noise, blur and spot of the beam");
  command.add_option("--pcd", options.pcd, "ascii, binary or binary_compressed")
      ->capture_default_str();
  command
      .add_option("--lidar-sigma", options.lidar_sigma_m,
                  "Levels corners and pairs: LiDAR corner noise per axis [m]")
      ->capture_default_str();
  command.add_option("--pixel-sigma", options.pixel_sigma_px,
                     "Levels corners and pairs: corner noise in the image [px]; default 1 and 3.5");
  command.add_option("--sheet", options.sheet_path,
                     "Draw image, scan and edges of the first scan (.png)");
  command.footer(
      "Examples:\n"
      "  sextant simulate experiments/scenes/paper_two_boards.yaml --out session --scans 5\n"
      "  sextant simulate pairs --views 5 --seed 7 --out session.yaml");
}

void AddSimulatePairs(CLI::App& command, SimulatePairsOptions& options) {
  CLI::App& pairs = *command.add_subcommand(
      "pairs", "Corners of the paper's two boards, hung anew for each view");
  PairSimulation& simulation = options.simulation;
  pairs.add_option("--out", options.out, "Problem file to write")->capture_default_str();
  pairs.add_option("--seed", simulation.seed, "The same seed gives the same bytes")
      ->capture_default_str();
  pairs.add_option("--views", simulation.views, "How often the boards are hung")
      ->capture_default_str();
  pairs.add_option("--outliers", simulation.outliers, "Corners that are displaced")
      ->capture_default_str();
  pairs.add_option("--outlier-shift", simulation.outlier_shift_m, "By how much [m]")
      ->capture_default_str();
  pairs.add_option("--lidar-sigma", simulation.lidar_sigma_m, "LiDAR corner noise per axis [m]")
      ->capture_default_str();
  pairs
      .add_option("--camera-sigma", simulation.camera_lateral_sigma_m,
                  "Camera corner noise across the ray [m]")
      ->capture_default_str();
  pairs
      .add_option("--depth-sigma", simulation.camera_depth_sigma_m,
                  "Camera corner noise along the ray [m]")
      ->capture_default_str();
  pairs.add_option("--pixel-sigma", simulation.pixel_sigma_px, "Corner noise in the image [px]")
      ->capture_default_str();
  pairs.footer("Example:\n  sextant simulate pairs --views 5 --seed 7 --out session.yaml");
}

struct SimulateOptions {
  SimulateSessionOptions session;
  SimulatePairsOptions pairs;
  bool of_pairs = false;
};

void AddSimulate(CLI::App& app, SimulateOptions& options) {
  CLI::App& command = *app.add_subcommand("simulate", "Sessions whose truth is known");
  AddSimulateSession(command, options.session);
  AddSimulatePairs(command, options.pairs);
  command.get_subcommand("pairs")->callback([&options] { options.of_pairs = true; });
}

int RunSimulate(const SimulateOptions& options) {
  return options.of_pairs ? RunSimulatePairs(options.pairs) : RunSimulateSession(options.session);
}

// The commands, with what runs the one that the user chose.
class Commands {
 public:
  explicit Commands(CLI::App& app) : app_(app) {}

  template <class Options>
  void Add(void (*add)(CLI::App&, Options&), int (*run)(const Options&)) {
    const auto options = std::make_shared<Options>();
    add(app_, *options);
    // Options must outlive the parsing: the callback holds them.
    Last().callback([this, options, run] { run_ = [options, run] { return run(*options); }; });
  }

  void Add(void (*add)(CLI::App&), int (*run)()) {
    add(app_);
    Last().callback([this, run] { run_ = run; });
  }

  int RunChosen() const { return run_(); }

 private:
  CLI::App& Last() { return *app_.get_subcommands({}).back(); }

  CLI::App& app_;
  std::function<int()> run_;
};

// The parser would only say that a command is required.
bool RefuseUnknownCommand(const CLI::App& app, int argc, char** argv) {
  if (argc < 2 || argv[1][0] == '-') return false;
  std::vector<std::string> known;
  for (const CLI::App* command : app.get_subcommands({})) known.push_back(command->get_name());
  const std::string name = argv[1];
  if (std::find(known.begin(), known.end(), name) != known.end()) return false;
  fmt::print(stderr, "sextant has no command '{}'; {}\n", name, SuggestName(name, known));
  return true;
}

int Main(int argc, char** argv) {
  CLI::App app(kIntroduction, "sextant");
  app.set_version_flag("--version", std::string(Version()));
  app.set_help_all_flag("--help-all", "The help of every command");
  app.require_subcommand(1);
  app.footer(kFirstSteps);
  Commands commands(app);
  commands.Add(AddCalibrate, RunCalibrate);
  commands.Add(AddSolve, RunSolve);
  commands.Add(AddCompare, RunCompare);
  commands.Add(AddDetect, RunDetect);
  commands.Add(AddBoards, RunBoards);
  commands.Add(AddAdvise, RunAdvise);
  commands.Add(AddProject, RunProject);
  commands.Add(AddExport, RunExport);
  commands.Add(AddMark, RunMark);
  commands.Add(AddBoard, RunBoard);
  commands.Add(AddBag, RunBag);
  commands.Add(AddSimulate, RunSimulate);
  commands.Add(AddFuse, RunFuse);
  commands.Add(AddReproduce, RunReproduce);
  commands.Add(AddConvert, RunConvert);
  commands.Add(AddAverage, RunAverage);
  commands.Add(AddCatalogue, RunCatalogue);
  commands.Add(AddDetectors, RunDetectors);
  commands.Add(AddExtractors, RunExtractors);
  commands.Add(AddLidars, RunLidars);
  commands.Add(AddRun, RunExperiment);
  commands.Add(AddMerge, RunMerge);
  commands.Add(AddKinds, RunKinds);
  if (RefuseUnknownCommand(app, argc, argv)) return kWrongUse;
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kAnswered : kWrongUse;
  }
  return commands.RunChosen();
}

}  // namespace
}  // namespace sextant::cli

int main(int argc, char** argv) { return sextant::cli::Main(argc, argv); }
