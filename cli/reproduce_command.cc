// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <memory>

#include "cli/catalogue.h"
#include "cli/commands.h"
#include "cli/load.h"
#include "cli/progress.h"
#include "eval/experiment/reproduction/reproduce.h"
#include "eval/statistics/text_table.h"

namespace sextant::cli {

int RunReproduce(const ReproduceOptions& options) {
  std::unique_ptr<Progress> progress;
  std::string running;
  ReproduceSettings settings{.experiments = options.experiments,
                             .claims = options.claims,
                             .out = options.out,
                             .quick = options.quick,
                             .threads = options.threads};
  if (settings.out.empty()) settings.out = options.quick ? "build/paper-quick" : "paper";
  settings.progress = [&](const std::string& name, std::uint64_t done, std::uint64_t all) {
    if (name != running) {
      progress = std::make_unique<Progress>(name, static_cast<long>(all));
      running = name;
    }
    if (done > 0) progress->Set(static_cast<long>(done));
  };
  const Expected<Reproduction> reproduction = Reproduce(settings, AllSolvers());
  progress.reset();
  if (!reproduction) return Refuse("reproduce", reproduction.error());
  TextTable table({"claim", "printed", "ours [95 %]", "verdict"}, TextTable::Columns::kWords);
  for (const JudgedClaim& judged : reproduction->claims) {
    table.AddRow({judged.claim.id, judged.claim.printed, judged.ours.empty() ? "-" : judged.ours,
                  std::string(ToString(judged.verdict))});
  }
  for (const std::string& why : reproduction->skipped) {
    fmt::print(stderr, "sextant reproduce: not run: {}\n", why);
  }
  fmt::print("{}\n{} claims in {:.0f} s; the page is {}\n", table.Plain(),
             reproduction->claims.size(), reproduction->seconds,
             (settings.out / "REPRODUCTION.md").string());
  return kAnswered;
}

}  // namespace sextant::cli
