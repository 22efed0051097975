// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "cli/search_options.h"

namespace CLI {
class App;
}

namespace sextant::cli {

struct CalibrateOptions {
  std::string session;              ///< Session file, folder or recording; empty: files as below.
  std::vector<std::string> images;  ///< Files, or one pattern with *.
  std::vector<std::string> clouds;
  std::string boards_path;  ///< Empty: the session's.
  std::string camera_path;  ///< Empty: the session's.
  std::string camera_name;  ///< Of a simulated session with several; empty: the first.
  std::string solvers;      ///< The first one answers, the others are compared to it.
  std::string image_topic;  ///< Of a recording; empty: the only one.
  std::string cloud_topic;
  double tolerance_s = 0.05;         ///< Between the stamps of an image and its scan.
  std::vector<std::string> initial;  ///< A file, or X Y Z QW QX QY QZ; empty: along the axes.
  std::string detector;
  std::string extractor = "rectangle";
  SearchArguments search;
  int bootstrap = 100;  ///< Draws of the views; 0: none, and no cross-validation either.
  std::string out_path = "result.yaml";  ///< Empty: none.
  std::string json_path;
  std::string problem_path;  ///< What the solvers are given; empty: not written.
};

void AddCalibrate(CLI::App& app, CalibrateOptions& options);

/// As the commands of commands.h.
int RunCalibrate(const CalibrateOptions& options);

}  // namespace sextant::cli
