// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/reproduction/reproduce.h"

#include <fmt/core.h>

#include <chrono>
#include <map>
#include <memory>

#include "eval/experiment/report/write_report.h"
#include "eval/experiment/run/run_trials.h"
#include "io/output/output_file.h"
#include "io/output/output_folder.h"

namespace sextant {
namespace {

namespace fs = std::filesystem;

// A finished experiment with its rows.
struct Done {
  Experiment experiment;
  RowFileReader reader;
  bool is_recording;
};

Expected<std::unique_ptr<Done>> RunOne(const ReproduceSettings& settings, const std::string& name,
                                       const std::vector<TrialKind>& kinds,
                                       const SolverRegistry& registry) {
  SEXTANT_ASSIGN_OR_RETURN(
      Experiment experiment,
      ReadExperiment(settings.experiments / (name + ".yaml"), kinds, registry));
  const bool is_recording = experiment.trials == 1;
  if (settings.quick) experiment.trials = experiment.quick_trials;
  const fs::path folder = settings.out / name;
  SEXTANT_RETURN_IF_ERROR(MakeSubfolder(folder));
  SEXTANT_ASSIGN_OR_RETURN(const OutputFolder locked, OutputFolder::Open(folder));
  const ReportSettings report{.csv = false, .plots = true, .timing = {}};
  SEXTANT_RETURN_IF_ERROR(ClaimReportFiles(experiment, folder, report));
  const fs::path rows = folder / "rows.sxtrows";
  SEXTANT_RETURN_IF_ERROR(
      RunTrials(experiment, {.rows_path = rows,
                             .threads = settings.threads,
                             .after_block = [&](std::uint64_t done, std::uint64_t all) {
                               settings.progress(name, done, all);
                             }}));
  SEXTANT_RETURN_IF_ERROR(WriteReport(experiment, rows, folder, report));
  SEXTANT_ASSIGN_OR_RETURN(RowFileReader reader, RowFileReader::Open(rows));
  return std::make_unique<Done>(Done{std::move(experiment), std::move(reader), is_recording});
}

}  // namespace

Expected<Reproduction> Reproduce(const ReproduceSettings& settings,
                                 const std::vector<TrialKind>& kinds,
                                 const SolverRegistry& registry) {
  const auto start = std::chrono::steady_clock::now();
  SEXTANT_ASSIGN_OR_RETURN(const ClaimsFile file, ReadClaims(settings.claims));
  SEXTANT_ASSIGN_OR_RETURN(const OutputFolder locked, OutputFolder::Open(settings.out));
  const fs::path page = settings.out / "REPRODUCTION.md";
  SEXTANT_RETURN_IF_ERROR(
      ClaimOutput(page, {.is_recognised = IsPageOf(page, "Written by `sextant reproduce")}));
  Reproduction reproduction;
  std::map<std::string, std::unique_ptr<Done>> done;
  std::map<std::string, RowsOf> rows;
  for (const std::string& name : file.experiments) {
    Expected<std::unique_ptr<Done>> one = RunOne(settings, name, kinds, registry);
    if (!one && one.error().code == ErrorCode::kMissingData) {
      reproduction.skipped.push_back(name + ": " + one.error().message);
      continue;
    }
    if (!one) return tl::unexpected<Error>(one.error());
    rows[name] = {&(*one)->experiment, &(*one)->reader, (*one)->is_recording};
    done[name] = std::move(*one);
  }
  for (const Claim& claim : file.claims) {
    SEXTANT_ASSIGN_OR_RETURN(JudgedClaim judged, JudgeClaim(claim, rows));
    reproduction.claims.push_back(std::move(judged));
  }
  const std::string command = fmt::format("sextant reproduce{}", settings.quick ? " --quick" : "");
  SEXTANT_RETURN_IF_ERROR(WriteFileAtomically(
      page, FormatReproduction(file, reproduction.claims, reproduction.skipped, command)));
  reproduction.seconds =
      std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return reproduction;
}

}  // namespace sextant
