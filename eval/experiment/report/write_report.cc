// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/report/write_report.h"

#include "eval/experiment/report/report.h"
#include "io/output/output_file.h"
#include "io/output/remove_file.h"
#include "report/plot.h"

namespace sextant {
namespace {

Expected<void> DrawPlots(const Experiment& experiment, const ReportData& data,
                         const std::filesystem::path& folder) {
  for (const PlotSpec& plot : experiment.plots) {
    const std::string commands = PlotCommands(experiment, plot, data);
    if (commands.empty()) continue;
    for (const char* extension : {".svg", ".png", ".pdf"}) {
      SEXTANT_RETURN_IF_ERROR(DrawPlot(commands, folder / (plot.name + extension)));
    }
  }
  return {};
}

}  // namespace

Expected<void> ClaimReportFiles(const Experiment& experiment, const std::filesystem::path& folder,
                                const ReportSettings& settings,
                                const std::vector<std::string>& more) {
  std::vector<std::string> names = {"summary.json", "report.md", "tables.tex"};
  if (settings.csv) names.emplace_back("rows.csv");
  for (const PlotSpec& plot : experiment.plots) {
    for (const char* extension : {".svg", ".png", ".pdf"}) {
      if (settings.plots) names.push_back(plot.name + extension);
    }
  }
  names.insert(names.end(), more.begin(), more.end());
  const OutputUse use{.is_recognised = IsPageOf(folder / "report.md", ReportOrigin(experiment))};
  for (const std::string& name : names) SEXTANT_RETURN_IF_ERROR(ClaimOutput(folder / name, use));
  return {};
}

Expected<std::string> WriteReport(const Experiment& experiment,
                                  const std::filesystem::path& rows_path,
                                  const std::filesystem::path& folder,
                                  const ReportSettings& settings) {
  SEXTANT_ASSIGN_OR_RETURN(const RowFileReader reader, RowFileReader::Open(rows_path));
  SEXTANT_ASSIGN_OR_RETURN(ReportData data, ReportData::Compute(experiment, reader));
  data.SetTiming(settings.timing);
  SEXTANT_ASSIGN_OR_RETURN(const std::string summary, FormatSummary(experiment, reader, data));
  if (settings.csv) {
    SEXTANT_RETURN_IF_ERROR(WriteRowsCsv(experiment, reader, folder / "rows.csv"));
  } else {
    // Beside the new summary it would seem to be of these rows.
    RemoveOwnFile(folder / "rows.csv");
  }
  SEXTANT_RETURN_IF_ERROR(WriteFileAtomically(folder / "summary.json", summary));
  SEXTANT_RETURN_IF_ERROR(
      WriteFileAtomically(folder / "report.md", FormatMarkdown(experiment, data)));
  SEXTANT_RETURN_IF_ERROR(
      WriteFileAtomically(folder / "tables.tex", FormatLatex(experiment, data)));
  if (settings.plots) SEXTANT_RETURN_IF_ERROR(DrawPlots(experiment, data, folder));
  return FormatPlain(experiment, data);
}

}  // namespace sextant
