// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/reproduction/reproduce.h"

#include <fmt/core.h>

#include <filesystem>
#include <system_error>

#include "cli/commands/commands.h"
#include "cli/output.h"
#include "cli/progress.h"
#include "eval/experiment/definition/trials.h"
#include "eval/statistics/text_table.h"
#include "io/output/standard_output.h"
#include "solvers/all/all_solvers.h"

namespace sextant::cli {
namespace {

struct ReproduceOptions {
  std::string experiments = "experiments";
  std::string claims = "paper/claims.yaml";
  std::string out{};  ///< Empty: paper, or build/paper-quick.
  int threads = 0;    ///< 0: all.
  bool quick = false;
};

void Declare(ReproduceOptions& options, Arguments& arguments) {
  arguments.Add("--quick", options.quick, "Few trials: a minute instead of ten or more");
  arguments.Add("--out", options.out,
                "Folder to write; default: paper, or build/paper-quick with --quick. A run that\n"
                "was stopped continues where it was",
                {.writes = Writes::kFolder});
  arguments.Add("--experiments", options.experiments, "Folder of the experiment files",
                {.shows_default = true});
  arguments.Add("--claims", options.claims, "The paper's claims, and the rule for each",
                {.shows_default = true});
  arguments.Add("--threads", options.threads, "0: as many as the machine has",
                {.shows_default = true, .range = {{0, 1024}}});
}

// The defaults are those of the project's folder.
Expected<void> CheckInputs(const ReproduceOptions& options) {
  std::error_code ignored;
  for (const std::string& path : {options.claims, options.experiments}) {
    if (std::filesystem::exists(path, ignored)) continue;
    return MakeError(ErrorCode::kIo,
                     fmt::format("there is no '{}': run it in the project's folder, which has "
                                 "experiments/ and paper/claims.yaml, or name them with "
                                 "--experiments and --claims",
                                 path));
  }
  return {};
}

int Run(const ReproduceOptions& options) {
  if (const Expected<void> ok = CheckInputs(options); !ok) return Refuse("reproduce", ok.error());
  Progress progress;
  ReproduceSettings settings{.experiments = options.experiments,
                             .claims = options.claims,
                             .out = options.out,
                             .quick = options.quick,
                             .threads = options.threads};
  if (settings.out.empty()) settings.out = options.quick ? "build/paper-quick" : "paper";
  settings.progress = progress.Callback();
  const Expected<Reproduction> reproduction = Reproduce(settings, BuiltinKinds(), AllSolvers());
  if (!reproduction) return Refuse("reproduce", reproduction.error());
  TextTable table({"claim", "printed", "ours [95 %]", "verdict"}, TextTable::Columns::kWords);
  for (const JudgedClaim& judged : reproduction->claims) {
    table.AddRow({judged.claim.id, judged.claim.printed, judged.ours.empty() ? "-" : judged.ours,
                  std::string(ToString(judged.verdict))});
  }
  for (const std::string& why : reproduction->skipped) {
    PrintError("sextant reproduce: not run: {}\n", why);
  }
  Print("{}\n{}", table.Plain(),
        WroteLine(settings.out / "REPRODUCTION.md",
                  fmt::format("the verdicts on {} claims, after {:.0f} s",
                              reproduction->claims.size(), reproduction->seconds)));
  return kAnswered;
}

}  // namespace

Command ReproduceCommand() {
  constexpr const char* kFooter =
      "Run it in the project's folder. Real logs are searched for in SEXTANT_DATA, else in\n"
      "../shared/data; without them, claims that need them are not testable.\n"
      "Examples:\n"
      "  sextant reproduce --quick\n"
      "  sextant reproduce";
  return MakeCommand<ReproduceOptions>(
      "reproduce", "The paper's experiments repeated with known truth, and a verdict on each claim",
      kFooter, Declare, Run);
}

}  // namespace sextant::cli
