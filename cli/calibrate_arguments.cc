// SPDX-License-Identifier: Apache-2.0
#include <CLI/CLI.hpp>

#include "cli/calibrate_options.h"
#include "cli/sensor_arguments.h"

namespace sextant::cli {
namespace {

void AddSources(CLI::App& command, CalibrateOptions& options) {
  command.add_option("SESSION", options.session,
                     "Session file (YAML), folder of sextant simulate or with session.yaml, or a\n"
                     "recording (.bag, .db3, .mcap); or use --image and --cloud");
  command.add_option("--image", options.images,
                     "Photos: one, some, or a quoted pattern such as 'photos/*.png'");
  command.add_option("--cloud", options.clouds,
                     "Their scans; paired by what the names have of their own: 7 of pose7.png and\n"
                     "scan_007.pcd");
  command.add_option("--image-topic", options.image_topic, "Of a recording with several");
  command.add_option("--cloud-topic", options.cloud_topic, "Of a recording with several");
  command
      .add_option("--tolerance", options.tolerance_s,
                  "Between the time stamps of an image and its scan [s]")
      ->capture_default_str();
  command.add_option("--board", options.boards_path,
                     "Boards (YAML, or marker_coordinates.txt); else the session's");
  command.add_option("--camera", options.camera_path,
                     "Intrinsics; else the session's or the recording's");
  command.add_option("--camera-name", options.camera_name,
                     "Which camera of a simulated session with several");
}

void AddSensors(CLI::App& command, CalibrateOptions& options) {
  command.add_option("--detector", options.detector, "As for sextant detect");
  command.add_option("--extractor", options.extractor, "As for sextant boards")
      ->capture_default_str();
  AddSearch(command, options.search);
}

}  // namespace

void AddCalibrate(CLI::App& app, CalibrateOptions& options) {
  CLI::App& command = *app.add_subcommand(
      "calibrate", "cam_from_lidar from images and scans of boards, and how sure it is");
  AddSources(command, options);
  command.add_option(
      "--solver", options.solvers,
      "Solvers, separated by commas: the first one's answer is written, the others'\n"
      "are compared to it; see sextant solvers");
  command
      .add_option("--initial", options.initial,
                  "Rough cam_from_lidar, only to choose where the views leave several: a file, or\n"
                  "X Y Z QW QX QY QZ; else a camera that looks along the LiDAR's x")
      ->expected(1, 7);
  AddSensors(command, options);
  command
      .add_option("--bootstrap", options.bootstrap,
                  "How often the views are drawn anew to hold the answer against; 0: not, and no\n"
                  "cross-validation either")
      ->check(CLI::Range(0, 100'000))
      ->capture_default_str();
  command.add_option("--out", options.out_path, "Result file (YAML)")->capture_default_str();
  command.add_option("--json", options.json_path, "The same as JSON; - for standard output");
  command.add_option("--problem", options.problem_path,
                     "Write the correspondences found, for sextant solve and compare (YAML)");
  command.footer(
      "Examples:\n"
      "  sextant calibrate --image photo.png --cloud scan.pcd --board board.yaml --camera "
      "cam.yaml\n"
      "  sextant calibrate --image 'photos/*.png' --cloud 'scans/*.pcd' --board board.yaml "
      "--camera cam.yaml\n"
      "  sextant calibrate session.yaml --solver 'gnc(kabsch),kabsch,refine(ransac(p3p))'\n"
      "  sextant calibrate session.yaml --problem found.yaml && sextant compare found.yaml\n"
      "  sextant calibrate recording.bag --board board.yaml");
}

}  // namespace sextant::cli
