// SPDX-License-Identifier: Apache-2.0
#include "report/calibrate_text.h"

#include <fmt/core.h>

#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "base/units.h"
#include "calibrate/trust/view_residuals.h"
#include "eval/statistics/text_table.h"
#include "io/text/number_text.h"
#include "report/report_text.h"
#include "report/wrapped_text.h"

namespace sextant {
namespace {

std::string HeldOutText(const Calibration& calibration, int view) {
  if (!calibration.result) return "-";
  for (const ResultView& result : calibration.result->views) {
    if (result.view == view && result.held_out_m) return Fixed(1e3 * *result.held_out_m, 1);
  }
  return "-";
}

// Why boards were not kept, a line each, under the table.
std::string ReasonsText(const Calibration& calibration) {
  constexpr std::size_t kLongestWhy = 300;
  std::string text;
  for (const BoardRow& row : calibration.assembly.rows) {
    if (row.why.empty()) continue;
    text += fmt::format("  {}: {}: {}\n", Printable(calibration.observed.views[row.view].name, 30),
                        ToString(row.fate), Printable(row.why, kLongestWhy));
  }
  return text.empty() ? text : "\nNot used:\n" + text;
}

// One row per board of each view, with its residuals where there is an answer.
std::string DescribeViews(const Calibration& calibration) {
  const Assembly& assembly = calibration.assembly;
  std::map<std::pair<int, int>, BoardResidual> residuals;
  if (const SolveReport* report = calibration.report()) {
    residuals = ResidualsByBoard(assembly.problem, report->evaluation);
  }
  TextTable table({"view", "board", "", "range [m]", "off [mm]", "[px]", "held out [mm]"},
                  TextTable::Columns::kWords);
  for (const BoardRow& row : assembly.rows) {
    std::vector<std::string> cells(7, "-");
    cells[0] = Printable(calibration.observed.views[row.view].name, 30);
    cells[2] = std::string(ToString(row.fate));
    if (row.board >= 0) {
      const int id = assembly.problem.boards[static_cast<std::size_t>(row.board)].id;
      cells[1] = std::to_string(id);
      const auto found = residuals.find({static_cast<int>(row.view), id});
      if (found != residuals.end()) {
        cells[3] = Fixed(found->second.range_m, 2);
        cells[4] = Fixed(1e3 * found->second.rmse_m, 1);
        if (found->second.rmse_px) cells[5] = Fixed(*found->second.rmse_px, 2);
        cells[6] = HeldOutText(calibration, static_cast<int>(row.view));
      }
    }
    table.AddRow(std::move(cells));
  }
  return table.Plain() + ReasonsText(calibration);
}

std::string ErrorAgainstTruth(const ComparisonRow& row) {
  if (!row.from_truth) return {};
  std::string text =
      fmt::format("  error against the truth    {:.4f} deg, {:.2f} mm",
                  row.from_truth->rotation_rad * kDegPerRad, 1e3 * row.from_truth->translation_m);
  if (row.report->covariance) {
    const Vector6d variance = row.report->covariance->diagonal();
    text += fmt::format(" (1 sigma over all axes {:.4f} deg, {:.2f} mm)",
                        std::sqrt(variance.head<3>().sum()) * kDegPerRad,
                        1e3 * std::sqrt(variance.tail<3>().sum()));
  }
  return text + "\n";
}

std::string WarningsText(const std::vector<std::string>& warnings) {
  std::string text;
  for (const std::string& line : warnings) text += "  " + line + "\n";
  return text.empty() ? text : "\nData diagnostics:\n" + text;
}

}  // namespace

std::string DescribeVerdict(const ResultVerdict& verdict) {
  return Wrapped(
      fmt::format("{}: {}. {}.", ToString(verdict.usability), verdict.reason, verdict.next),
      kTextWidth);
}

std::string CautionAbout(const CalibrationResult& result) {
  if (!result.verdict || result.verdict->usability != Usability::kNotUsable) return {};
  return DescribeVerdict(*result.verdict);
}

std::string DescribeCalibration(const Calibration& calibration) {
  if (calibration.assembly.rows.empty()) return {};
  std::string text;
  if (calibration.result && calibration.result->verdict) {
    text = DescribeVerdict(*calibration.result->verdict) + "\n";
  }
  text += DescribeViews(calibration) + "\n";
  if (!calibration.result) return Narrow(text + WarningsText(calibration.warnings));
  const CalibrationResult& result = *calibration.result;
  text += DescribeAnswer(*calibration.report());
  text += ErrorAgainstTruth(calibration.comparison.front());
  text = Narrow(text);
  if (calibration.comparison.size() > 1) text += "\n" + DescribeComparison(calibration.comparison);
  std::string conclusion = WarningsText(result.warnings) + "\n" + result.closing + "\n";
  if (result.trust) conclusion += "\n" + result.trust->comparison + "\n";
  return text + Narrow(conclusion);
}

}  // namespace sextant
