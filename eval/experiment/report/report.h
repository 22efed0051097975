// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "eval/experiment/definition/experiment.h"
#include "eval/experiment/report/figure.h"
#include "eval/experiment/run/row_file.h"
#include "eval/statistics/text_table.h"

namespace sextant {

/// All that a report says, each figure computed once.
class ReportData {
 public:
  /// Figures of every statistic that the experiment's tables and plots show. Errors: kIo;
  /// kInvalidInput where the rows are not the experiment's.
  static Expected<ReportData> Compute(const Experiment& experiment, const RowFileReader& reader);

  const std::vector<CellKey>& cells(std::size_t condition) const { return cells_[condition]; }
  /// By cell of the condition. Requires a statistic of the experiment's report.
  const std::vector<Figure>& figures(std::size_t condition, const Statistic& statistic) const {
    return figures_[condition].at(statistic.text);
  }

 private:
  std::vector<std::vector<CellKey>> cells_;
  std::vector<std::map<std::string, std::vector<Figure>>> figures_;
};

/// One table of a report, with the conditions that it is of.
struct ReportTable {
  std::string title;
  TextTable table;
};
std::vector<ReportTable> MakeTables(const Experiment& experiment, const ReportData& data);

/// The page of the experiment: Markdown, for a terminal, and LaTeX (booktabs).
std::string FormatMarkdown(const Experiment& experiment, const ReportData& data);
std::string FormatPlain(const Experiment& experiment, const ReportData& data);
std::string FormatLatex(const Experiment& experiment, const ReportData& data);

/// Gnuplot's commands for a plot of the report; empty where none of its figures is finite.
std::string PlotCommands(const Experiment& experiment, const PlotSpec& plot,
                         const ReportData& data);

/// Every metric of every cell: count, mean, RMS, deviation and quantiles, the median with its
/// interval; and the figures of the tables. JSON.
Expected<std::string> FormatSummary(const Experiment& experiment, const RowFileReader& reader,
                                    const ReportData& data);

/// Every row, tidy: experiment, condition, axes, subject, trial, index, metrics. Empty where NaN.
/// Written without holding it in memory.
Expected<void> WriteRowsCsv(const Experiment& experiment, const RowFileReader& reader,
                            const std::filesystem::path& path);

/// "pairs=20, outliers=0.3" without one axis; what the conditions of one table or line share.
std::string PlaceWithout(const Experiment& experiment, const Condition& condition,
                         const std::string& axis);

/// "kabsch", or "kabsch #3" for a step of a sequence.
std::string SubjectText(const Condition& condition, const CellKey& cell);

}  // namespace sextant
