// SPDX-License-Identifier: Apache-2.0
#include "cli/study_arguments.h"

#include <CLI/CLI.hpp>

namespace sextant::cli {

void AddFuse(CLI::App& app, FuseOptions& options) {
  CLI::App& command =
      *app.add_subcommand("fuse", "Point clouds of calibrated sensors in one frame");
  command
      .add_option("CLOUD", options.clouds,
                  "Clouds, each in the frame of its own camera: PCD, PLY, KITTI .bin or CSV")
      ->required();
  command.add_option("--from", options.from,
                     "cam_from_lidar of the camera of each cloud but the last: result.yaml, JSON\n"
                     "of sextant solve, or a 4x4 matrix in rows");
  command.add_option("--to", options.to, "The same of the last cloud: all go to its frame");
  command.add_option("--rts", options.rts_path,
                     "Instead: rts.txt of the original package, a 4x4 matrix a cloud");
  command.add_option("--out", options.out, "Cloud to write: .ply (a colour a cloud) or .pcd")
      ->capture_default_str();
  command.footer(
      "Cameras need not see the same: the LiDAR joins them. last_from_cloud = T_last * "
      "inverse(T).\n"
      "Examples:\n"
      "  sextant fuse front.pcd side.pcd --from front.yaml --to side.yaml --out both.ply\n"
      "  sextant fuse cam1.pcd cam2.pcd --rts conf/rts.txt");
}

}  // namespace sextant::cli
