// SPDX-License-Identifier: Apache-2.0
#include "cli/program.h"

#include "cli/commands/commands.h"
#include "cli/features.h"

namespace sextant::cli {
namespace {

constexpr const char* kIntroduction =
    "sextant finds the rigid transform cam_from_lidar between a LiDAR and a camera, with its\n"
    "uncertainty, and compares the methods for it.\n"
    "\n"
    "Start here: photos of a board, the scans taken with them, the size of the board, and the\n"
    "camera's intrinsics give the answer and a verdict on it.\n"
    "  sextant calibrate --image 'photo_*.png' --cloud 'scan_*.pcd' --board board.yaml "
    "--camera camera.yaml\n"
    "No board yet? Print one. No recording yet? Simulate one, whose true transform is known.\n"
    "  sextant print-board board.yaml --out target.pdf\n"
    "  sextant simulate experiments/scenes/paper_two_boards.yaml --out session --scans 5\n"
    "  sextant calibrate session";

constexpr const char* kFooter =
    "point_in_cam = cam_from_lidar * point_in_lidar. Camera: x right, y down, z forward.\n"
    "LiDAR: x forward, y left, z up. Metres and degrees.\n"
    "'sextant COMMAND --help' has the options of a command and examples.\n"
    "An existing file is replaced only if sextant wrote it; --overwrite replaces any.\n"
    "Exit codes: 0 answered, 1 no answer (with the reason), 2 wrong usage or unreadable input,\n"
    "3 answered, with the verdict NOT USABLE (check: moved), 4 an output could not be written,\n"
    "5 check: cannot tell, 70 out of memory or an error in sextant.";

}  // namespace

Program SextantProgram() {
  return {.name = "sextant",
          .version = VersionText(),
          .introduction = kIntroduction,
          .footer = kFooter,
          .groups = {{"Calibrate",
                      {CalibrateCommand(), CaptureCommand(), RigCommand(), AdviseCommand(),
                       CheckCommand(), RefineSceneCommand(), ProjectCommand(), ReportCommand(),
                       ExportCommand()}},
                     {"Look at images, scans and recordings",
                      {DetectCommand(), BoardsCommand(), MarkCommand(), BagCommand()}},
                     {"Make and convert data",
                      {SimulateCommand(), PrintBoardCommand(), ConvertCommand(), FuseCommand()}},
                     {"Solvers, on correspondences of your own",
                      {SolveCommand(), CompareCommand(), AverageCommand(), ListCommand()}},
                     {"Experiments", {RunCommand(), MergeCommand(), ReproduceCommand()}},
                     {"The program itself", {CompletionCommand(), ManualCommand()}}},
          .renamed = {{"board", "print-board"},
                      {"solvers", "list solvers"},
                      {"detectors", "list detectors"},
                      {"extractors", "list extractors"},
                      {"lidars", "list lidars"},
                      {"kinds", "list kinds"}}};
}

}  // namespace sextant::cli
