// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "eval/experiment/definition/experiment.h"
#include "eval/experiment/definition/timing.h"

namespace sextant {

struct ReportSettings {
  bool csv = true;  ///< If not, an older rows.csv that sextant wrote is removed.
  bool plots = true;
  std::vector<TimingRow> timing{};  ///< For plots against time; those without it are left out.
};

/// Claims the files that WriteReport may write into the folder, and those named `more` there,
/// before the trials. If the folder's report.md is of this experiment, all are replaced that nobody
/// has changed, in a copy or a fresh clone too. Errors: those of ClaimOutput.
Expected<void> ClaimReportFiles(const Experiment& experiment, const std::filesystem::path& folder,
                                const ReportSettings& settings,
                                const std::vector<std::string>& more = {});

/// Reads the finished rows of the experiment and writes into the folder: rows.csv, summary.json,
/// report.md, tables.tex, and NAME.svg, NAME.png and NAME.pdf for
/// every plot. Returns the tables as plain
/// text. The bytes of all files except the PNGs depend only on the rows. Errors: kIo, kParse,
/// kInvalidInput (rows of another configuration); those of OutputFile.
Expected<std::string> WriteReport(const Experiment& experiment,
                                  const std::filesystem::path& rows_path,
                                  const std::filesystem::path& folder,
                                  const ReportSettings& settings);

}  // namespace sextant
