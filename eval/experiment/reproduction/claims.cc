// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/reproduction/claims.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "base/nearest_name.h"
#include "io/text/text_file.h"
#include "io/text/yaml_fields.h"

namespace sextant {
namespace {

using Keys = std::vector<std::string>;

const Keys& RuleNames() {
  static const Keys names = {"draw", "about", "at_most", "at_least", "less", "similar", "untested"};
  return names;
}

std::string Optional(YamlFields& in, const YamlNode& node, std::string_view key) {
  return in.ok() && node.Find(key) != nullptr ? in.TextAt(node, key) : std::string();
}

ClaimFigure ReadFigure(YamlFields& in, const YamlNode& node,
                       const std::vector<std::string>& known) {
  static const Keys kKeys = {"experiment", "condition", "subject", "index", "statistic"};
  constexpr int kMaxSteps = 1'000'000;
  ClaimFigure figure;
  if (!in.IsMap(node, "figure", kKeys)) return figure;
  figure.experiment = in.TextAt(node, "experiment");
  figure.condition = Optional(in, node, "condition");
  figure.subject = in.TextAt(node, "subject");
  figure.index = in.IntegerAt(node, "index", 0, kMaxSteps, 0);
  figure.statistic = in.TextAt(node, "statistic");
  if (in.ok() && std::ranges::find(known, figure.experiment) == known.end()) {
    in.Fail(node.line, "experiment",
            fmt::format("{} is not in the list of experiments; {}", figure.experiment,
                        SuggestName(figure.experiment, known)));
  }
  return figure;
}

Claim ReadClaim(YamlFields& in, const YamlNode& node, const std::vector<std::string>& experiments) {
  static const Keys kKeys = {"id",     "where", "text", "printed", "rule", "value",
                             "factor", "slack", "ours", "than",    "unit", "why"};
  Claim claim;
  if (!in.IsMap(node, "claim", kKeys)) return claim;
  claim.id = in.TextAt(node, "id");
  claim.where = in.TextAt(node, "where");
  claim.text = in.TextAt(node, "text");
  claim.printed = in.TextAt(node, "printed");
  claim.unit = Optional(in, node, "unit");
  claim.why = Optional(in, node, "why");
  const std::string rule = in.TextAt(node, "rule");
  const auto found = std::ranges::find(RuleNames(), rule);
  if (in.ok() && found == RuleNames().end()) {
    in.Fail(node.line, "rule",
            fmt::format("unknown rule {}; {}", rule, SuggestName(rule, RuleNames())));
    return claim;
  }
  claim.rule = static_cast<ClaimRule>(found - RuleNames().begin());
  if (claim.rule == ClaimRule::kUntested) {
    if (in.ok() && claim.why.empty()) in.Fail(node.line, "why", "expected the reason");
    return claim;
  }
  claim.ours = ReadFigure(in, in.Require(node, "ours"), experiments);
  if (claim.rule == ClaimRule::kLess || claim.rule == ClaimRule::kSimilar) {
    claim.than = ReadFigure(in, in.Require(node, "than"), experiments);
  } else {
    claim.value = in.RealAt(node, "value");
  }
  claim.factor = in.RealAt(node, "factor", claim.factor);
  claim.slack = in.NonNegativeAt(node, "slack", claim.slack);
  if (in.ok() && !(claim.factor >= 1.0)) in.Fail(node.line, "factor", "expected 1 or more");
  return claim;
}

Erratum ReadErratum(YamlFields& in, const YamlNode& node) {
  static const Keys kKeys = {"where", "printed", "is"};
  if (!in.IsMap(node, "erratum", kKeys)) return {};
  Erratum erratum;
  erratum.where = in.TextAt(node, "where");
  erratum.printed = in.TextAt(node, "printed");
  erratum.is = in.TextAt(node, "is");
  return erratum;
}

}  // namespace

Expected<ClaimsFile> ReadClaims(const std::filesystem::path& path) {
  return ReadWith(path, ParseClaims);
}

Expected<ClaimsFile> ParseClaims(std::string_view text, const std::string& file) {
  static const Keys kKeys = {"paper", "experiments", "claims", "errata"};
  SEXTANT_ASSIGN_OR_RETURN(const YamlNode root, ParseYaml(text, file));
  YamlFields in(file);
  ClaimsFile claims;
  in.IsMap(root, "claims file", kKeys);
  claims.paper = in.TextAt(root, "paper");
  if (const YamlNode& list = in.Require(root, "experiments"); in.IsSequence(list, "experiments")) {
    for (const YamlNode& item : list.items) {
      claims.experiments.push_back(in.FileName(item, "experiments"));
    }
  }
  if (const YamlNode& list = in.Require(root, "claims"); in.IsSequence(list, "claims")) {
    for (const YamlNode& item : list.items) {
      claims.claims.push_back(ReadClaim(in, item, claims.experiments));
    }
  }
  if (const YamlNode* list = root.Find("errata");
      list != nullptr && in.IsSequence(*list, "errata")) {
    for (const YamlNode& item : list->items) claims.errata.push_back(ReadErratum(in, item));
  }
  if (!in.ok()) return in.TakeError();
  return claims;
}

}  // namespace sextant
