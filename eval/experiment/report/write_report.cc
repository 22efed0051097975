// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/report/write_report.h"

#include "eval/experiment/report/report.h"
#include "io/text/text_file.h"
#include "report/plot.h"

namespace sextant {
namespace {

Expected<void> DrawPlots(const Experiment& experiment, const ReportData& data,
                         const std::filesystem::path& folder) {
  for (const PlotSpec& plot : experiment.plots) {
    const std::string commands = PlotCommands(experiment, plot, data);
    if (commands.empty()) continue;
    for (const char* extension : {".svg", ".png"}) {
      if (Expected<void> ok = DrawPlot(commands, folder / (plot.name + extension)); !ok) return ok;
    }
  }
  return {};
}

}  // namespace

Expected<std::string> WriteReport(const Experiment& experiment,
                                  const std::filesystem::path& rows_path,
                                  const std::filesystem::path& folder,
                                  const ReportSettings& settings) {
  SEXTANT_ASSIGN_OR_RETURN(const RowFileReader reader, RowFileReader::Open(rows_path));
  SEXTANT_ASSIGN_OR_RETURN(const ReportData data, ReportData::Compute(experiment, reader));
  SEXTANT_ASSIGN_OR_RETURN(const std::string summary, FormatSummary(experiment, reader, data));
  Expected<void> ok;
  const auto write = [&](const char* name, const std::string& text) {
    if (ok) ok = WriteFileAtomically(folder / name, text);
  };
  if (settings.csv) ok = WriteRowsCsv(experiment, reader, folder / "rows.csv");
  write("summary.json", summary);
  write("report.md", FormatMarkdown(experiment, data));
  write("tables.tex", FormatLatex(experiment, data));
  if (ok && settings.plots) ok = DrawPlots(experiment, data, folder);
  if (!ok) return tl::unexpected<Error>(std::move(ok.error()));
  return FormatPlain(experiment, data);
}

}  // namespace sextant
