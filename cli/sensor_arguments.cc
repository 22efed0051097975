// SPDX-License-Identifier: Apache-2.0
#include "cli/sensor_arguments.h"

#include <CLI/CLI.hpp>
#include <map>

namespace sextant::cli {

void AddDetect(CLI::App& app, DetectOptions& options) {
  CLI::App& command =
      *app.add_subcommand("detect", "Tags and boards in images: corners, poses, what is missing");
  command.add_option("IMAGE", options.images, "Photos, examined in parallel")->required();
  command.add_option("--board", options.board_path,
                     "What hangs there: board YAML or marker_coordinates.txt; else all tags of "
                     "--detector");
  command.add_option("--camera", options.camera_path,
                     "Intrinsics, for poses and corners in the camera frame");
  command.add_option("--detector", options.detector,
                     "aruco, apriltag or checkerboard, with options; see sextant detectors");
  command.add_option("--overlay", options.overlay_path,
                     "Draw what was found (.png or .jpg); of many images out-NAME.png each");
  command.add_option("--json", options.json_path,
                     "Write the results as JSON; - for standard output");
  command.add_flag("--quick", options.quick, "Do not look into why a tag is missing");
  command.footer(
      "Examples:\n"
      "  sextant detect photo.jpg --board board.yaml --camera camera.yaml --overlay out.png\n"
      "  sextant detect *.png --detector 'aruco(dictionary=6x6_250)' --json -");
}

void AddSearch(CLI::App& command, SearchArguments& search) {
  command.add_option("--region", search.region, "Search only in x y z x y z [m], LiDAR frame")
      ->expected(6);
  command.add_flag("--raw-edges", search.raw_edges,
                   "Take edges where the last return is, uncorrected for steps and beam width");
  command
      .add_option("--lidar", search.lidar,
                  "Sensor, for the width of its beam: vlp16, os1_64, ... as sextant lidars lists")
      ->capture_default_str();
  command.add_option("--beam-aperture", search.aperture_m,
                     "Of another sensor: width of a beam as it leaves [m]");
  command.add_option("--beam-divergence", search.divergence_rad, "Its full angle [rad]");
  command.add_option("--edge-growth", search.growth,
                     "How far beyond an edge the board is still seen, of the beam's width");
  command.add_option("--seed", search.seed, "Of the search for planes")->capture_default_str();
}

void AddBoards(CLI::App& app, BoardsOptions& options) {
  CLI::App& command = *app.add_subcommand("boards", "Boards in LiDAR scans, and their corners");
  command
      .add_option("SCAN", options.scans,
                  "Scans: PCD, PLY, KITTI .bin or CSV; any number, in parallel")
      ->required();
  command
      .add_option("--board", options.boards_path,
                  "Boards to look for (YAML, or marker_coordinates.txt of the original package)")
      ->required();
  command
      .add_option("--extractor", options.extractor,
                  "rectangle (known size), plane_lines, lines3d (the paper's) or lines3d_raw")
      ->capture_default_str();
  command.add_option("--polygons", options.polygons_path,
                     "Take the edges marked with sextant mark instead of searching");
  AddSearch(command, options.search);
  command.add_option("--overlay", options.overlay_path,
                     "Draw the scan round the boards with their corners (.png; one scan)");
  command.add_option("--json", options.json_path,
                     "Write the results as JSON; - for standard output");
  command.footer(
      "Examples:\n"
      "  sextant boards scan.pcd --board boards.yaml\n"
      "  sextant boards scans/*.pcd --board boards.yaml --extractor lines3d --json corners.json");
}

void AddMark(CLI::App& app, MarkOptions& options) {
  CLI::App& command =
      *app.add_subcommand("mark", "Edges in a scan and corners in its photo, marked by hand");
  command.add_option("--cloud", options.cloud_path, "The scan: PCD, PLY, KITTI .bin or CSV")
      ->required();
  command.add_option("--image", options.image_path, "Its photo");
  command.add_option("--camera", options.camera_path,
                     "Intrinsics; default: a camera 90 degrees wide is assumed");
  CLI::Option* const pose =
      command
          .add_option(
              "--cam-from-lidar", options.cam_from_lidar,
              "Rough pose: results (JSON), rts.txt, or X Y Z QW QX QY QZ; default: the camera "
              "looks\nalong the LiDAR's x axis")
          ->expected(1, 7);
  command
      .add_option("--yaw", options.yaw_deg,
                  "Without a pose: turn the assumed camera to the left by so much [deg]")
      ->check(CLI::Range(-360.0, 360.0))
      ->excludes(pose)
      ->capture_default_str();
  command.add_option("--ids", options.ids,
                     "Ids of the boards from left to right; default: 0, 1, ...");
  command.add_option("--out", options.out_path, "Polygon file to write, or to go on with")
      ->capture_default_str();
  command.add_option("--render", options.render_path,
                     "Write a picture (PNG) of the window instead of opening it");
  command.add_option("--width", options.width_px, "Of the window [px]")
      ->check(CLI::Range(320, 8192))
      ->capture_default_str();
  command.add_option("--height", options.height_px, "Of the window [px]")
      ->check(CLI::Range(240, 8192))
      ->capture_default_str();
  command.footer(
      "Draw an area of four clicks round each edge of a board, where the rings leave it: the "
      "top-left\n"
      "edge first, then clockwise, boards from left to right. h shows the keys. Marks that are not "
      "saved\n"
      "are kept beside --out, and the next start goes on with them.\n"
      "Examples:\n"
      "  sextant mark --cloud scan.pcd --yaw 90\n"
      "  sextant mark --cloud scan.pcd --image photo.png --camera camera.yaml --out session.yaml");
}

void AddBoard(CLI::App& app, BoardOptions& options) {
  CLI::App& command =
      *app.add_subcommand("board", "Boards to print at true scale, with a ruler and cut lines");
  command.add_option("FILE", options.board_path, "Board YAML or marker_coordinates.txt")
      ->required();
  command.add_option("--out", options.out, "Written by its extension: .pdf, .svg or .png")
      ->required();
  command.add_option("--id", options.id, "One board of the file; a .pdf holds all");
  command.add_option("--dpi", options.dpi, "Pixels an inch of a .png")
      ->check(CLI::Range(10.0, 2400.0))
      ->capture_default_str();
  command.footer(
      "Print at 100 %, without fitting to the page, and measure the ruler.\n"
      "Example:\n  sextant board board.yaml --out target.pdf");
}

void AddBag(CLI::App& app, BagOptions& options) {
  CLI::App& command =
      *app.add_subcommand("bag", "What a recording holds, and its scans and images");
  command
      .add_option("FILE", options.path,
                  "Recording: .bag of ROS 1, .db3 of ROS 2 or its folder, or .mcap")
      ->required();
  command.add_option(
      "--extract", options.extract_folder,
      "Write scans (.pcd), images, camera_info (.yaml) and pairs.csv into this folder");
  command
      .add_option("--tolerance", options.tolerance_s,
                  "How far apart scan and image of a pair may be [s]")
      ->check(CLI::Range(0.0, 3600.0))
      ->capture_default_str();
  command.footer(
      "A scan and an image are a pair where no other two left are closer in time; each is used "
      "once.\n"
      "Examples:\n  sextant bag session.bag\n  sextant bag session.bag --extract session");
}

void AddDetectors(CLI::App& app, DetectorStudyCommandOptions& options) {
  CLI::App& command = *app.add_subcommand(
      "detectors", "Options of the tag detectors, and how well each finds corners");
  command.add_option("--trials", options.trials, "Rendered tags; 0: the options only")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  command.add_option("--seed", options.seed, "The same seed gives the same figures")
      ->capture_default_str();
  command.add_flag("--markdown", options.markdown, "As a page");
  command.footer("Example:\n  sextant detectors --trials 500");
}

void AddExtractors(CLI::App& app, ExtractorStudyCommandOptions& options) {
  static const std::map<std::string, BoardHolding> holdings = {{"hung", BoardHolding::kHung},
                                                               {"stand", BoardHolding::kOnStand},
                                                               {"hands", BoardHolding::kInHands}};
  CLI::App& command = *app.add_subcommand(
      "extractors", "LiDAR corner extractors, and how well each does with each LiDAR");
  command.add_option("--trials", options.trials, "Simulated scans of each kind; 0: the list only")
      ->check(CLI::Range(0, 1'000'000))
      ->capture_default_str();
  command.add_option("--lidars", options.models, "Only these, as sextant lidars names them")
      ->delimiter(',');
  command.add_option("--holding", options.holding, "How the boards are held: hung, stand, hands")
      ->transform(CLI::CheckedTransformer(holdings, CLI::ignore_case));
  command.add_option("--seed", options.seed, "The same seed gives the same figures")
      ->capture_default_str();
  command.add_flag("--markdown", options.markdown, "As a page");
  command.footer("Example:\n  sextant extractors --trials 200 --lidars vlp16,os1_64");
}

}  // namespace sextant::cli
