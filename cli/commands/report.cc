// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <filesystem>
#include <system_error>

#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/report_file.h"
#include "io/output/standard_output.h"

namespace sextant::cli {
namespace {

struct ReportCommandOptions {
  std::string result_path{};
  std::string out_path = "report.html";
};

void Declare(ReportCommandOptions& options, Arguments& arguments) {
  arguments.Add("RESULT", options.result_path,
                "result.yaml of sextant calibrate, its JSON, or a folder that contains result.yaml",
                {.required = true});
  arguments.Add("--out", options.out_path, "The report (HTML)",
                {.shows_default = true, .writes = Writes::kFile});
}

int Run(const ReportCommandOptions& options) {
  std::filesystem::path path = options.result_path;
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) path /= "result.yaml";
  const Expected<CalibrationResult> result = ReadCalibrationResult(path);
  if (!result) {
    return Refuse("report", {result.error().code,
                             fmt::format("{}; for a session, run sextant calibrate --report",
                                         result.error().message)});
  }
  const std::filesystem::path folder = path.parent_path();
  const Expected<void> written = WriteReport(
      {.result = *result, .frames = FramesOfFiles(folder), .folder = folder}, options.out_path);
  if (!written) return Refuse("report", written.error());
  Print("{}", WroteLine(options.out_path, kReportWords));
  return kAnswered;
}

}  // namespace

Command ReportCommand() {
  constexpr const char* kFooter =
      "One file that opens offline: verdict, transform, the views with their photos and scans in "
      "two\n"
      "and three dimensions, residuals, uncertainty, and where to hold the board next. It reads "
      "the\n"
      "photos and scans that the result names, from the working folder or beside the result. "
      "Noise\n"
      "and the comparison of solvers are in the report of sextant calibrate --report only.\n"
      "Example:\n  sextant report result.yaml --out report.html";
  return MakeCommand<ReportCommandOptions>(
      "report", "A calibration for people who did not run it: one file of HTML", kFooter, Declare,
      Run);
}

}  // namespace sextant::cli
