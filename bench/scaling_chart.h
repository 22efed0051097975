// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "base/error.h"
#include "bench/process_cost.h"

namespace sextant::bench {

/// Growth of the cost of one task.
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
  std::string name;  ///< File name of its plot.
  std::string title;
  std::string text;
  std::string x;  ///< Name of the quantity that is varied.
  bool log_x = true;
  bool rates = false;  ///< Show `amount` over seconds instead of seconds.
  double amount = 1.0;
  std::vector<Curve> curves;
};

/// Draws time and memory next to each other as NAME.svg and NAME.png in the folder. Errors: those
/// of DrawPlot.
Expected<void> DrawChart(const Chart& chart, const std::filesystem::path& folder);

/// The chapter in Markdown: title, text, plot, and a table of all points.
std::string ChapterOf(const Chart& chart);

}  // namespace sextant::bench
