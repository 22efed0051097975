// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "base/error.h"
#include "eval/experiment/report/report.h"

namespace sextant {

/// A figure of an experiment as it once was, with what chance alone makes of it.
struct GoldenFigure {
  std::string condition;
  std::string subject;
  std::string statistic;
  double value = 0.0;
  double low = 0.0;  ///< 95 percent interval: the tolerance.
  double high = 0.0;
};

/// The figures of the experiment's tables; those without a value or an interval are left out.
std::vector<GoldenFigure> CollectFigures(const Experiment& experiment, const ReportData& data);

/// A figure a line, so that a change reads well as a diff.
std::string FormatGolden(const std::vector<GoldenFigure>& figures);
Expected<std::vector<GoldenFigure>> ParseGolden(const std::string& text, const std::string& file);

/// What got worse by more than chance: a line each that says which solver, where and by how much.
/// Worse are errors above their golden interval and rates below it. A figure that is new or gone is
/// a line too.
std::vector<std::string> CompareWithGolden(const std::vector<GoldenFigure>& golden,
                                           const std::vector<GoldenFigure>& now);

}  // namespace sextant
