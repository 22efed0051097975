// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace CLI {
class App;
}

// The commands that use a result.yaml: their options, arguments and runs.
namespace sextant::cli {

struct ExportCommandOptions {
  std::string result_path;
  std::string format;
  std::string out = "-";
  std::string camera_frame;  ///< Empty: the result's.
  std::string lidar_frame;
  std::string parent;  ///< "lidar" or "camera"; empty: the LiDAR, where the format has a parent.
};

struct ProjectOptions {
  std::string image_path;
  std::string cloud_path;
  std::string result_path;
  std::string camera_path;  ///< Empty: the result's.
  std::string boards_path;  ///< Empty: the result's; they are looked for in the image.
  std::string out_path;
  double point_px = 0.0;     ///< Diameter of a return; 0: by the image's size.
  bool all_returns = false;  ///< Also those that something nearer hides from the camera.
};

struct AdviseCommandOptions {
  std::string result_path;
  std::string picture_path;  ///< Empty: none.
  std::string lidar;         ///< A model of the simulator; empty: the result's, else vlp16.
  double pixel_sigma_px = 0.3;
  int count = 1;
};

void AddExport(CLI::App& app, ExportCommandOptions& options);
void AddProject(CLI::App& app, ProjectOptions& options);
void AddAdvise(CLI::App& app, AdviseCommandOptions& options);

int RunExport(const ExportCommandOptions& options);
int RunProject(const ProjectOptions& options);
int RunAdvise(const AdviseCommandOptions& options);

}  // namespace sextant::cli
