// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "bench/process_cost.h"

namespace sextant::bench {

/// How the cost of one thing grows.
struct Curve {
  struct Point {
    double x = 0.0;
    Cost cost;
  };
  std::string name;
  std::vector<Point> points;
};

/// A chapter of docs/scaling.md: curves over one quantity.
struct Chart {
  std::string name;  ///< Of the files of its picture.
  std::string title;
  std::string text;
  std::string x;  ///< What is varied.
  bool log_x = true;
  bool rates = false;  ///< Show `amount` over seconds instead of seconds.
  double amount = 1.0;
  std::vector<Curve> curves;
};

/// Time and memory side by side, as NAME.svg and NAME.png in the folder. Errors: those of DrawPlot.
Expected<void> DrawChart(const Chart& chart, const std::filesystem::path& folder);

/// Title, text, picture, and a table of every point.
std::string ChapterOf(const Chart& chart);

}  // namespace sextant::bench
