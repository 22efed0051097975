// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "base/text/escape.h"
#include "eval/experiment/reproduction/reproduce.h"

namespace sextant {
namespace {

std::string LinkTo(const Claim& claim) {
  if (!claim.ours) return "-";
  std::string text = fmt::format("[{0}]({0}/report.md)", claim.ours->experiment);
  if (!claim.ours->condition.empty()) text += ": " + MarkdownText(claim.ours->condition);
  text += ", " + MarkdownText(claim.ours->subject);
  if (claim.ours->index > 0) text += fmt::format(" #{}", claim.ours->index);
  return text;
}

std::string Tally(const std::vector<JudgedClaim>& claims) {
  std::string text;
  for (const Verdict verdict : {Verdict::kReproduced, Verdict::kDirection, Verdict::kRefuted,
                                Verdict::kUndecided, Verdict::kNotTestable}) {
    const auto count = std::ranges::count(claims, verdict, &JudgedClaim::verdict);
    if (count == 0) continue;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, ToString(verdict));
  }
  return text;
}

std::string Rows(const std::vector<JudgedClaim>& claims) {
  std::string text =
      "| where | claim | printed | ours [95 %] | verdict | experiment | remark |\n"
      "|:--|:--|:--|:--|:--|:--|:--|\n";
  for (const JudgedClaim& judged : claims) {
    text +=
        fmt::format("| {} | {} | {} | {} | **{}** | {} | {} |\n", MarkdownText(judged.claim.where),
                    MarkdownText(judged.claim.text), MarkdownText(judged.claim.printed),
                    judged.ours.empty() ? "-" : MarkdownText(judged.ours), ToString(judged.verdict),
                    LinkTo(judged.claim), MarkdownText(judged.remark));
  }
  return text;
}

}  // namespace

std::string FormatReproduction(const ClaimsFile& file, const std::vector<JudgedClaim>& claims,
                               const std::vector<std::string>& skipped,
                               const std::string& command) {
  std::string text = fmt::format(
      "# Reproduction of the paper\n\n{}\n\nWritten by `{}`; do not edit. The paper's raw data was "
      "never published, so its experiments are repeated in simulation with known truth: the same "
      "boards, sensors, poses and processing steps. The noise is taken from data sheets and real "
      "recordings, is stated in each file of `experiments/`, and was not tuned. Printed values, "
      "claims and rules are in `paper/claims.yaml`.\n\n{} claims: {}.\n\n",
      MarkdownText(file.paper), command, claims.size(), Tally(claims));
  text +=
      "Each verdict follows from a rule. A printed single measurement is *reproduced* if it lies "
      "in "
      "the central 95 % of our trials (given in brackets after the median). A printed average is "
      "reproduced if our 95 % interval comes within a factor of 2 of it (3.16 for an order of "
      "magnitude). A bound is reproduced if our whole interval satisfies it, and *refuted* if none "
      "of the interval does. A comparison without a number is *direction reproduced* if the two "
      "intervals are disjoint and in the order that the paper claims, and refuted if they are in "
      "the "
      "opposite order. Anything else is *undecided*. `sextant run experiments/NAME.yaml` runs one "
      "experiment alone.\n\n";
  text += Rows(claims);
  if (!skipped.empty()) {
    text += "\n## Experiments that were not run\n\n";
    for (const std::string& why : skipped) text += fmt::format("- {}\n", MarkdownText(why));
  }
  text += "\n## Errata of the paper\n\n| where | printed | correct |\n|:--|:--|:--|\n";
  for (const Erratum& erratum : file.errata) {
    text += fmt::format("| {} | {} | {} |\n", MarkdownText(erratum.where),
                        MarkdownText(erratum.printed), MarkdownText(erratum.is));
  }
  text += "\n## Experiments\n\n";
  for (const std::string& name : file.experiments) {
    text += fmt::format("- [{0}]({0}/report.md)\n", name);
  }
  return text;
}

}  // namespace sextant
