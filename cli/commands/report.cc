// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <system_error>

#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/report_file.h"
#include "io/output/standard_output.h"
#include "io/results/check_result.h"
#include "io/results/rig_result.h"
#include "io/text/text_file.h"
#include "report/collect/check_page.h"
#include "report/collect/rig_page.h"

namespace sextant::cli {
namespace {

struct ReportCommandOptions {
  std::string result_path{};
  std::string out_path = "report.html";
};

void Declare(ReportCommandOptions& options, Arguments& arguments) {
  arguments.Add(
      "RESULT", options.result_path,
      "result.yaml of sextant calibrate, its JSON, or a folder that contains result.yaml;\n"
      "rig.json of sextant rig; or the JSON of sextant check",
      {.required = true});
  arguments.Add("--out", options.out_path, "The report (HTML)",
                {.shows_default = true, .writes = Writes::kFile});
}

// A calibration's own photos are worth a line, as a page without any of them shows little.
std::string PhotosText(const ReportPage& page) {
  const auto shown = std::ranges::count_if(
      page.views, [](const PageView& view) { return view.photo.has_value(); });
  if (shown == std::ssize(page.views)) return {};
  const auto why = std::ranges::find_if(
      page.views, [](const PageView& view) { return !view.photo && !view.no_photo.empty(); });
  return fmt::format(
      "warning: {} of {} views have their photo and scan in the report; view {}: {}\n",
      shown == 0 ? std::string("none") : std::to_string(shown), page.views.size(), why->name,
      why->no_photo);
}

Expected<ReportPage> PageOfResult(const std::filesystem::path& path) {
  const std::filesystem::path folder = path.parent_path();
  const auto with_advice = [](const Error& error) {
    return MakeError(error.code, error.message + "; for a session, run sextant calibrate --report");
  };
  const Expected<std::string> read = ReadTextFile(path);
  if (!read) return with_advice(read.error());
  const std::string& text = *read;
  if (IsRigResult(text)) {
    SEXTANT_ASSIGN_OR_RETURN(const RigResult rig, ParseRigResult(text, path.string()));
    return CollectRigPage(rig);
  }
  if (IsCheckResult(text)) {
    SEXTANT_ASSIGN_OR_RETURN(const CheckResult check, ParseCheckResult(text, path.string()));
    return CollectCheckPage(check, folder);
  }
  const Expected<CalibrationResult> result = ParseCalibrationResult(text, path.string());
  if (!result) return with_advice(result.error());
  return CollectWithProgress(
      {.result = *result, .frames = FramesOfFiles(folder), .folder = folder});
}

int Run(const ReportCommandOptions& options) {
  std::filesystem::path path = options.result_path;
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) path /= "result.yaml";
  const Expected<ReportPage> page = PageOfResult(path);
  if (!page) return Refuse("report", page.error());
  const Expected<void> written = WritePage(*page, options.out_path);
  if (!written) return Refuse("report", written.error());
  PrintError("{}", PhotosText(*page));
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
      "Examples:\n"
      "  sextant report result.yaml --out report.html\n"
      "  sextant report rig.json --out rig.html\n"
      "  sextant check result.yaml --image a.png --cloud a.pcd --json check.json; sextant report "
      "check.json";
  return MakeCommand<ReportCommandOptions>(
      "report", "A calibration for people who did not run it: one file of HTML", kFooter, Declare,
      Run);
}

}  // namespace sextant::cli
