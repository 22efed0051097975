// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "eval/experiment/definition/experiment.h"
#include "eval/experiment/definition/timing.h"
#include "eval/experiment/report/figure.h"
#include "eval/experiment/run/row_file.h"
#include "eval/statistics/text_table.h"

namespace sextant {

/// All figures of a report, each computed once.
class ReportData {
 public:
  /// Computes every statistic that the experiment's tables and plots show. Errors: kIo;
  /// kInvalidInput if the rows do not belong to the experiment.
  static Expected<ReportData> Compute(const Experiment& experiment, const RowFileReader& reader);

  const std::vector<CellKey>& cells(std::size_t condition) const { return cells_[condition]; }
  /// One figure per cell of the condition. Requires a statistic of the experiment's report.
  const std::vector<Figure>& figures(std::size_t condition, const Statistic& statistic) const {
    return figures_[condition].at(statistic.text);
  }
  /// See TrialValuesOf. Requires a metric of a plot or a ranking of the experiment's report.
  const std::vector<std::vector<double>>& values(std::size_t condition, int metric) const {
    return values_[condition].at(metric);
  }
  /// What TimeSubjects measured; empty if nothing.
  const std::vector<TimingRow>& timing() const { return timing_; }
  void SetTiming(std::vector<TimingRow> rows) { timing_ = std::move(rows); }

 private:
  std::vector<std::vector<CellKey>> cells_;
  std::vector<std::map<std::string, std::vector<Figure>>> figures_;
  std::vector<std::map<int, std::vector<std::vector<double>>>> values_;
  std::vector<TimingRow> timing_;
};

/// One table of a report; the title names its conditions.
struct ReportTable {
  std::string title;
  TextTable table;
};
std::vector<ReportTable> MakeTables(const Experiment& experiment, const ReportData& data);

/// The words by which the Markdown states what wrote it.
std::string ReportOrigin(const Experiment& experiment);

/// The report as Markdown, as plain text for a terminal, and its tables in LaTeX (booktabs).
std::string FormatMarkdown(const Experiment& experiment, const ReportData& data);
std::string FormatPlain(const Experiment& experiment, const ReportData& data);
std::string FormatLatex(const Experiment& experiment, const ReportData& data);

/// Gnuplot commands for a plot of the report; empty if none of its figures is finite. CurveCommands
/// are those of the types but kLines.
std::string PlotCommands(const Experiment& experiment, const PlotSpec& plot,
                         const ReportData& data);

std::string CurveCommands(const Experiment& experiment, const PlotSpec& plot,
                          const ReportData& data);

/// JSON with every metric of every cell (count, mean, RMS, standard deviation, quantiles, and the
/// median with its interval) and the figures of tables and plots.
Expected<std::string> FormatSummary(const Experiment& experiment, const RowFileReader& reader,
                                    const ReportData& data);

/// Writes all rows as CSV with the columns experiment, condition, axes, subject, trial, index,
/// metrics. NaN is written as an empty field. Memory does not grow with the number of rows.
Expected<void> WriteRowsCsv(const Experiment& experiment, const RowFileReader& reader,
                            const std::filesystem::path& path);

/// The condition's values on all axes but one, such as "pairs = 20, outliers = 0.3": what the
/// conditions of one table or line have in common.
std::string PlaceWithout(const Experiment& experiment, const Condition& condition,
                         const std::string& axis);

/// "kabsch", or "kabsch #3" for a step of a sequence.
std::string SubjectText(const Condition& condition, const CellKey& cell);

}  // namespace sextant
