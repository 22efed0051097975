// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/report/write_report.h"

#include "eval/experiment/report/report.h"
#include "io/output/output_file.h"
#include "report/plot.h"

namespace sextant {
namespace {

Expected<void> DrawPlots(const Experiment& experiment, const ReportData& data,
                         const std::filesystem::path& folder) {
  for (const PlotSpec& plot : experiment.plots) {
    const std::string commands = PlotCommands(experiment, plot, data);
    if (commands.empty()) continue;
    for (const char* extension : {".svg", ".png"}) {
      SEXTANT_RETURN_IF_ERROR(DrawPlot(commands, folder / (plot.name + extension)));
    }
  }
  return {};
}

}  // namespace

std::vector<std::filesystem::path> ReportFiles(const Experiment& experiment,
                                               const std::filesystem::path& folder,
                                               const ReportSettings& settings) {
  std::vector<std::filesystem::path> files = {folder / "summary.json", folder / "report.md",
                                              folder / "tables.tex"};
  if (settings.csv) files.push_back(folder / "rows.csv");
  for (const PlotSpec& plot : experiment.plots) {
    for (const char* extension : {".svg", ".png"}) {
      if (settings.plots) files.push_back(folder / (plot.name + extension));
    }
  }
  return files;
}

Expected<std::string> WriteReport(const Experiment& experiment,
                                  const std::filesystem::path& rows_path,
                                  const std::filesystem::path& folder,
                                  const ReportSettings& settings) {
  SEXTANT_ASSIGN_OR_RETURN(const RowFileReader reader, RowFileReader::Open(rows_path));
  SEXTANT_ASSIGN_OR_RETURN(const ReportData data, ReportData::Compute(experiment, reader));
  SEXTANT_ASSIGN_OR_RETURN(const std::string summary, FormatSummary(experiment, reader, data));
  if (settings.csv) SEXTANT_RETURN_IF_ERROR(WriteRowsCsv(experiment, reader, folder / "rows.csv"));
  SEXTANT_RETURN_IF_ERROR(WriteFileAtomically(folder / "summary.json", summary));
  SEXTANT_RETURN_IF_ERROR(
      WriteFileAtomically(folder / "report.md", FormatMarkdown(experiment, data)));
  SEXTANT_RETURN_IF_ERROR(
      WriteFileAtomically(folder / "tables.tex", FormatLatex(experiment, data)));
  if (settings.plots) SEXTANT_RETURN_IF_ERROR(DrawPlots(experiment, data, folder));
  return FormatPlain(experiment, data);
}

}  // namespace sextant
