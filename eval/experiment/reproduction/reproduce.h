// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/progress.h"
#include "eval/experiment/definition/trials.h"
#include "eval/experiment/reproduction/judge_claim.h"
#include "solvers/core/registry.h"

namespace sextant {

struct ReproduceSettings {
  std::filesystem::path experiments{"experiments"};
  std::filesystem::path claims{"paper/claims.yaml"};
  std::filesystem::path out{"paper"};
  bool quick = false;
  int threads = 0;  ///< 0: one per hardware thread.
  /// A stage for each experiment, with its trials as steps.
  ProgressCallback progress = [](std::string_view, std::size_t, std::size_t) {};
};

struct Reproduction {
  std::vector<JudgedClaim> claims{};
  std::vector<std::string> skipped{};  ///< Experiments whose real data is absent, with the reason.
  double seconds = 0.0;                ///< Duration of trials and reports; not written to any file.
};

/// Runs every experiment that the claims name, writes each one's report to out/NAME and the page of
/// all claims to out/REPRODUCTION.md. Rows are stored in out/NAME/rows.sxtrows, so an interrupted
/// run can be continued. Except for plots, the bytes do not depend on the number of threads.
/// Errors: those of reading and running experiments and of judging claims; kIo.
Expected<Reproduction> Reproduce(const ReproduceSettings& settings,
                                 const std::vector<TrialKind>& kinds,
                                 const SolverRegistry& registry);

/// The page in Markdown. `command` is the command that wrote it.
std::string FormatReproduction(const ClaimsFile& file, const std::vector<JudgedClaim>& claims,
                               const std::vector<std::string>& skipped, const std::string& command);

}  // namespace sextant
