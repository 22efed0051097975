// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "eval/experiment/report/report.h"

namespace sextant {

/// A recorded figure of an experiment with its 95 percent interval, which serves as the tolerance.
struct GoldenFigure {
  std::string condition;
  std::string subject;
  std::string statistic;
  double value = 0.0;
  double low = 0.0;  ///< Ends of the 95 percent interval.
  double high = 0.0;
};

/// The figures of the experiment's tables, without those that have no value or no interval.
std::vector<GoldenFigure> CollectFigures(const Experiment& experiment, const ReportData& data);

/// JSON with one figure per line, so that changes are readable as a diff.
std::string FormatGolden(const std::vector<GoldenFigure>& figures);
Expected<std::vector<GoldenFigure>> ParseGolden(const std::string& text, const std::string& file);

/// One line of text for each figure that became significantly worse: which solver, where and by how
/// much. An error is worse above its golden interval, a rate below it. New and missing figures are
/// listed as well.
std::vector<std::string> CompareWithGolden(const std::vector<GoldenFigure>& golden,
                                           const std::vector<GoldenFigure>& now);

}  // namespace sextant
