// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sextant {

/// How a claim is held against the trials. Each figure of ours has a 95 percent interval.
enum class ClaimRule {
  kDraw,      ///< Printed is one measurement: reproduced within the middle 95 % of our trials.
  kAbout,     ///< Printed is an average: reproduced where the interval meets [P/factor, P factor].
  kAtMost,    ///< Reproduced where the whole interval is at most P, refuted where it is above.
  kAtLeast,   ///< The same the other way round.
  kLess,      ///< Of two figures of ours: the direction holds where their intervals are apart.
  kSimilar,   ///< Of two figures of ours: the intervals meet when one is widened by the factor.
  kUntested,  ///< Cannot be tested here; `why` says why.
};

/// A figure of an experiment that a claim is about.
struct ClaimFigure {
  std::string experiment{};  ///< Name of the file in experiments/, without .yaml.
  std::string condition{};
  std::string subject{};
  int index = 0;  ///< Step of a sequence.
  std::string statistic{};
};

/// One thing that the paper says.
struct Claim {
  std::string id{};
  std::string where{};    ///< Table, figure or section of the paper.
  std::string text{};     ///< In a sentence.
  std::string printed{};  ///< As the paper prints it, with its unit.
  ClaimRule rule = ClaimRule::kUntested;
  /// P: what is printed, in the statistic's unit; unused by those that have `than`.
  double value = 0.0;
  double factor = 2.0;
  double slack = 0.0;  ///< Of kDraw: what our truth, the paper's tape, may itself be off by.
  std::optional<ClaimFigure> ours{};
  std::optional<ClaimFigure> than{};  ///< Of kLess (the larger one) and kSimilar.
  std::string unit{};
  std::string why{};  ///< A remark, or why it cannot be tested.
};

/// A mistake in the paper.
struct Erratum {
  std::string where{};
  std::string printed{};
  std::string is{};
};

struct ClaimsFile {
  std::string paper{};
  std::vector<std::string> experiments{};  ///< In the order of the page; the claims' and others.
  std::vector<Claim> claims{};
  std::vector<Erratum> errata{};
};

/// paper/claims.yaml. Errors: kIo; kParse with file, line and key.
Expected<ClaimsFile> ReadClaims(const std::filesystem::path& path);
Expected<ClaimsFile> ParseClaims(std::string_view text, const std::string& file);

}  // namespace sextant
