// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"

namespace sextant {

/// How a claim is tested against our trials. Each of our figures has a 95 percent interval; P is
/// the printed value.
enum class ClaimRule {
  kDraw,      ///< P is one measurement: reproduced if within the central 95 % of our trials.
  kAbout,     ///< P is an average: reproduced if our interval overlaps [P/factor, P factor].
  kAtMost,    ///< Reproduced if our whole interval is at most P, refuted if it is above.
  kAtLeast,   ///< Reproduced if our whole interval is at least P, refuted if it is below.
  kLess,      ///< Compares two of our figures: the direction holds if the intervals are disjoint.
  kSimilar,   ///< Compares two of our figures: the intervals overlap after widening by the factor.
  kUntested,  ///< Cannot be tested here; `why` gives the reason.
};

/// A figure of an experiment that a claim is about.
struct ClaimFigure {
  std::string experiment{};  ///< File name in experiments/ without .yaml.
  std::string condition{};
  std::string subject{};
  int index = 0;  ///< Step of a sequence.
  std::string statistic{};
};

/// One claim of the paper.
struct Claim {
  std::string id{};
  std::string where{};    ///< Table, figure or section of the paper.
  std::string text{};     ///< The claim in one sentence.
  std::string printed{};  ///< As the paper prints it, with its unit.
  ClaimRule rule = ClaimRule::kUntested;
  /// P, the printed value in the statistic's unit; unused by rules that have `than`.
  double value = 0.0;
  double factor = 2.0;
  /// With kDraw: possible error of the truth itself, the paper's tape measure.
  double slack = 0.0;
  std::optional<ClaimFigure> ours{};
  std::optional<ClaimFigure> than{};  ///< Second figure of kLess (the larger one) and kSimilar.
  std::string unit{};
  std::string why{};  ///< A remark, or the reason why it cannot be tested.
};

/// A mistake in the paper.
struct Erratum {
  std::string where{};
  std::string printed{};
  std::string is{};
};

struct ClaimsFile {
  std::string paper{};
  /// In the order of the page; may include some without claims.
  std::vector<std::string> experiments{};
  std::vector<Claim> claims{};
  std::vector<Erratum> errata{};
};

/// paper/claims.yaml. Errors: kIo; kParse with file, line and key.
/// Time and memory are those of ParseYaml (io/text/yaml_node.h).
Expected<ClaimsFile> ReadClaims(const std::filesystem::path& path);
Expected<ClaimsFile> ParseClaims(std::string_view text, const std::string& file);

}  // namespace sextant
