// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <CLI/CLI.hpp>

#include "cli/result_options.h"
#include "io/export/export_transform.h"

namespace sextant::cli {
namespace {

std::string FormatsHelp() {
  std::string help;
  for (const ExportFormat& format : ExportFormats()) {
    help += fmt::format("{}{}: {}", help.empty() ? "" : "\n", format.name, format.summary);
  }
  return help;
}

}  // namespace

void AddExport(CLI::App& app, ExportCommandOptions& options) {
  CLI::App& command =
      *app.add_subcommand("export", "A result in the form that other programs take");
  command
      .add_option("RESULT", options.result_path, "result.yaml of sextant calibrate, or its JSON")
      ->required();
  command.add_option("--to", options.format, FormatsHelp())->required();
  command.add_option("--out", options.out, "File to write; - for standard output")
      ->capture_default_str();
  command.add_option("--lidar-frame", options.lidar_frame, "Default: as the result names it");
  command.add_option("--camera-frame", options.camera_frame,
                     "The camera's optical frame (x right, y down); default: as the result names "
                     "it, or\ncamera_optical_frame");
  command
      .add_option("--parent", options.parent,
                  "lidar or camera: whose frame the other's pose is stated in; default: lidar")
      ->check(CLI::IsMember({"lidar", "camera"}));
  command.footer(
      "ROS and URDF state the pose of the child in its parent: with the LiDAR as the parent that "
      "is\n"
      "lidar_from_camera, the inverse of cam_from_lidar. The others hold cam_from_lidar. Each file "
      "says so.\n"
      "Examples:\n"
      "  sextant export result.yaml --to ros2 --lidar-frame velodyne --camera-frame "
      "cam0_optical_frame --out extrinsic.launch.py\n"
      "  sextant export result.yaml --to kitti --out calib.txt");
}

void AddProject(CLI::App& app, ProjectOptions& options) {
  CLI::App& command = *app.add_subcommand("project", "A scan drawn on its image with a result");
  command.add_option("--image", options.image_path, "The photo")->required();
  command.add_option("--cloud", options.cloud_path, "Its scan: PCD, PLY, KITTI .bin or CSV")
      ->required();
  command.add_option("--result", options.result_path, "result.yaml of sextant calibrate")
      ->required();
  command.add_option("--out", options.out_path, "Picture to write (.png or .jpg)")->required();
  command.add_option("--camera", options.camera_path, "Intrinsics; default: the result's");
  command.add_option("--board", options.boards_path,
                     "Boards to outline, by the image and by the scan; default: the result's");
  command
      .add_option("--point-size", options.point_px, "Diameter of a return [px]; 0: by the image")
      ->check(CLI::Range(0.0, 100.0));
  command.add_flag("--all", options.all_returns,
                   "Draw returns that something nearer hides from the camera, too");
  command.footer(
      "Returns are coloured by range. Where the answer is right, they change colour where the "
      "image "
      "has\nits edges, and the two outlines of a board lie on each other.\n"
      "Example:\n  sextant project --image photo.png --cloud scan.pcd --result result.yaml --out "
      "projected.png");
}

void AddAdvise(CLI::App& app, AdviseCommandOptions& options) {
  CLI::App& command =
      *app.add_subcommand("advise", "What the views told so far, and where to hold a board next");
  command
      .add_option("RESULT", options.result_path,
                  "result.yaml of sextant calibrate, its JSON, or a folder with result.yaml in it")
      ->required();
  command.add_option("--picture", options.picture_path,
                     "Draw the place from above and as the camera would see it (.png)");
  command.add_option("--count", options.count, "How many places, each after those before it")
      ->check(CLI::Range(1, 20))
      ->capture_default_str();
  command.add_option("--lidar", options.lidar,
                     "A LiDAR of sextant lidars; default: the result's own rings, else vlp16");
  command.add_option("--pixel-sigma", options.pixel_sigma_px, "Of a printed corner [px]")
      ->check(CLI::Range(0.001, 100.0))
      ->capture_default_str();
  command.footer(
      "The place is the one of a grid, seen by both sensors, that makes the foreseen covariance "
      "smallest\n(D-optimal).\n"
      "Example:\n  sextant advise result.yaml --picture next.png");
}

}  // namespace sextant::cli
