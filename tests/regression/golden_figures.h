// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "eval/experiment/report/report.h"

namespace sextant {

/// A stored figure of an experiment with its tolerance.
struct GoldenFigure {
  std::string condition;
  std::string subject;
  std::string statistic;
  double value = 0.0;
  double low = 0.0;  ///< 95 percent interval: the tolerance.
  double high = 0.0;
};

/// The figures of the experiment's tables, without those that lack a value or an interval.
std::vector<GoldenFigure> CollectFigures(const Experiment& experiment, const ReportData& data);

/// One figure per line, for readable diffs.
std::string FormatGolden(const std::vector<GoldenFigure>& figures);
Expected<std::vector<GoldenFigure>> ParseGolden(const std::string& text, const std::string& file);

/// One line for each figure that got significantly worse: solver, condition and by how much. Worse
/// means errors above the golden interval and rates below it. New and missing figures have a line
/// too.
std::vector<std::string> CompareWithGolden(const std::vector<GoldenFigure>& golden,
                                           const std::vector<GoldenFigure>& now);

}  // namespace sextant
