// SPDX-License-Identifier: Apache-2.0
#include "report/calibrate_text.h"

#include <fmt/core.h>

#include "calibrate/trust/view_residuals.h"
#include "eval/statistics/text_table.h"
#include "io/text/number_text.h"

namespace sextant::cli {
namespace {

std::string HeldOutText(const std::vector<ResultView>& judged, int view) {
  for (const ResultView& result : judged) {
    if (result.view == view && result.held_out_m) return Fixed(1e3 * *result.held_out_m, 1);
  }
  return "-";
}

}  // namespace

std::string DescribeViews(const std::vector<SessionView>& views, const Assembly& assembly,
                          const SolveReport* report, const std::vector<ResultView>& judged) {
  constexpr std::size_t kLongestWhy = 150;
  std::map<std::pair<int, int>, BoardResidual> residuals;
  if (report != nullptr) residuals = ResidualsByBoard(assembly.problem, report->evaluation);
  TextTable table({"view", "board", "", "range [m]", "off [mm]", "[px]", "held out [mm]", "why"},
                  TextTable::Columns::kWords);
  for (const BoardRow& row : assembly.rows) {
    std::vector<std::string> cells = {Printable(views[row.view].name, 30),
                                      "-",
                                      std::string(ToString(row.fate)),
                                      "-",
                                      "-",
                                      "-",
                                      "-",
                                      Printable(row.why, kLongestWhy)};
    if (row.board >= 0) {
      const int id = assembly.problem.boards[static_cast<std::size_t>(row.board)].id;
      cells[1] = std::to_string(id);
      const auto found = residuals.find({static_cast<int>(row.view), id});
      if (found != residuals.end()) {
        cells[3] = Fixed(found->second.range_m, 2);
        cells[4] = Fixed(1e3 * found->second.rmse_m, 1);
        if (found->second.rmse_px) cells[5] = Fixed(*found->second.rmse_px, 2);
        cells[6] = HeldOutText(judged, static_cast<int>(row.view));
      }
    }
    table.AddRow(std::move(cells));
  }
  return table.Plain();
}

std::string Wrapped(const std::string& text, std::size_t width) {
  std::string wrapped;
  std::size_t column = 0;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t end = std::min(text.find(' ', i), text.size());
    const std::size_t length = end - i;
    if (column > 0 && column + 1 + length > width) {
      wrapped += '\n';
      column = 0;
    } else if (column > 0) {
      wrapped += ' ';
      ++column;
    }
    wrapped += text.substr(i, length);
    column += length;
    i = end + 1;
  }
  return wrapped + "\n";
}

}  // namespace sextant::cli
