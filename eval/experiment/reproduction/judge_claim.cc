// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/reproduction/judge_claim.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/nearest_name.h"
#include "eval/statistics/text_table.h"

namespace sextant {
namespace {

// The range of 39 trials contains a further one with a probability of 95 percent; with fewer
// trials, a value outside of their central 95 percent proves nothing.
constexpr std::uint64_t kMinDraws = 39;
// The bootstrap of fewer trials gives no interval.
constexpr std::uint64_t kMinTrials = 8;

// One of our figures.
struct OurFigure {
  double value = 0.0;
  Interval interval{};
  int decimals = 3;
  std::uint64_t trials = 0;
};

Expected<std::size_t> FindCondition(const Experiment& experiment, const std::string& name) {
  std::vector<std::string> known;
  for (std::size_t i = 0; i < experiment.conditions.size(); ++i) {
    if (experiment.conditions[i].name == name) return i;
    known.push_back(experiment.conditions[i].name);
  }
  return MakeError(
      ErrorCode::kUnknownName,
      fmt::format("{} has no condition '{}'; {}", experiment.name, name, SuggestName(name, known)));
}

Expected<std::size_t> FindCell(const Condition& condition, const ConditionRows& rows,
                               const ClaimFigure& figure) {
  const std::vector<std::string>& subjects = condition.trials->subjects();
  const auto subject = std::ranges::find(subjects, figure.subject);
  if (subject == subjects.end()) {
    return MakeError(ErrorCode::kUnknownName,
                     fmt::format("{} has no subject '{}'; {}", figure.experiment, figure.subject,
                                 SuggestName(figure.subject, subjects)));
  }
  const CellKey key{static_cast<int>(subject - subjects.begin()), figure.index};
  const auto cell = std::ranges::find(rows.cells(), key);
  if (cell != rows.cells().end()) return static_cast<std::size_t>(cell - rows.cells().begin());
  return MakeError(
      ErrorCode::kUnknownName,
      fmt::format("{}: '{}' has no step {}", figure.experiment, figure.subject, figure.index));
}

Expected<Figure> FigureOf(const Statistic& statistic, const ConditionRows& rows, std::size_t cell,
                          std::uint64_t seed) {
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<Figure> figures,
                           ComputeFigures(statistic, rows, seed));
  return figures[cell];
}

Expected<OurFigure> Compute(const ClaimFigure& figure, bool is_draw, const RowsOf& rows) {
  const Experiment& experiment = *rows.experiment;
  SEXTANT_ASSIGN_OR_RETURN(const std::size_t condition,
                           FindCondition(experiment, figure.condition));
  SEXTANT_ASSIGN_OR_RETURN(Statistic statistic,
                           ParseStatistic(figure.statistic, experiment.metrics));
  SEXTANT_ASSIGN_OR_RETURN(const ConditionRows of_condition,
                           ConditionRows::Open(experiment, *rows.reader, condition));
  SEXTANT_ASSIGN_OR_RETURN(const std::size_t cell,
                           FindCell(experiment.conditions[condition], of_condition, figure));
  SEXTANT_ASSIGN_OR_RETURN(const Figure middle,
                           FigureOf(statistic, of_condition, cell, experiment.seed));
  OurFigure ours{.value = middle.value,
                 .interval = middle.interval.value_or(Interval{middle.value, middle.value}),
                 .decimals = statistic.decimals,
                 .trials = middle.trials};
  if (!is_draw) return ours;
  // The interval of single trials.
  statistic.kind = Statistic::Kind::kQuantile;
  for (const auto& [q, end] :
       {std::pair{0.025, &ours.interval.low}, {0.975, &ours.interval.high}}) {
    statistic.quantile = q;
    SEXTANT_ASSIGN_OR_RETURN(const Figure quantile,
                             FigureOf(statistic, of_condition, cell, experiment.seed));
    *end = quantile.value;
  }
  return ours;
}

std::string TextOf(const OurFigure& figure, const std::string& unit) {
  return fmt::format("{} [{}, {}]{}{}", Fixed(figure.value, figure.decimals),
                     Fixed(figure.interval.low, figure.decimals),
                     Fixed(figure.interval.high, figure.decimals), unit.empty() ? "" : " ", unit);
}

}  // namespace

std::string_view ToString(Verdict verdict) {
  switch (verdict) {
    case Verdict::kReproduced:
      return "reproduced";
    case Verdict::kDirection:
      return "direction reproduced";
    case Verdict::kRefuted:
      return "refuted";
    case Verdict::kUndecided:
      return "undecided with this number of trials";
    case Verdict::kNotTestable:
      return "not testable";
  }
  return "";
}

Verdict VerdictOf(const Claim& claim, const Interval& ours, const std::optional<Interval>& than) {
  const double printed = claim.value;
  switch (claim.rule) {
    case ClaimRule::kDraw:
      return ours.low - claim.slack <= printed && printed <= ours.high + claim.slack
                 ? Verdict::kReproduced
                 : Verdict::kRefuted;
    case ClaimRule::kAbout: {
      const bool meets = ours.high >= printed / claim.factor && ours.low <= printed * claim.factor;
      return meets ? Verdict::kReproduced : Verdict::kRefuted;
    }
    case ClaimRule::kAtMost:
      if (ours.high <= printed) return Verdict::kReproduced;
      return ours.low > printed ? Verdict::kRefuted : Verdict::kUndecided;
    case ClaimRule::kAtLeast:
      if (ours.low >= printed) return Verdict::kReproduced;
      return ours.high < printed ? Verdict::kRefuted : Verdict::kUndecided;
    case ClaimRule::kLess:
      if (ours.high < than->low) return Verdict::kDirection;
      return ours.low > than->high ? Verdict::kRefuted : Verdict::kUndecided;
    case ClaimRule::kSimilar: {
      const bool meets =
          ours.high >= than->low / claim.factor && ours.low <= than->high * claim.factor;
      return meets ? Verdict::kReproduced : Verdict::kRefuted;
    }
    case ClaimRule::kUntested:
      break;
  }
  return Verdict::kNotTestable;
}

Expected<JudgedClaim> JudgeClaim(const Claim& claim, const std::map<std::string, RowsOf>& rows) {
  JudgedClaim judged{.claim = claim, .remark = claim.why};
  if (!claim.ours) return judged;
  const auto find = [&](const ClaimFigure& figure) { return rows.find(figure.experiment); };
  if (find(*claim.ours) == rows.end() || (claim.than && find(*claim.than) == rows.end())) {
    judged.remark = "the data of the experiment is missing; " + claim.why;
    return judged;
  }
  const Expected<OurFigure> ours =
      Compute(*claim.ours, claim.rule == ClaimRule::kDraw, find(*claim.ours)->second);
  if (!ours) return MakeError(ours.error().code, claim.id + ": " + ours.error().message);
  judged.ours = TextOf(*ours, claim.unit);
  std::optional<Interval> than;
  bool are_enough = ours->trials >= kMinTrials || find(*claim.ours)->second.is_recording;
  if (claim.than) {
    const Expected<OurFigure> larger = Compute(*claim.than, false, find(*claim.than)->second);
    if (!larger) return MakeError(larger.error().code, claim.id + ": " + larger.error().message);
    judged.ours += " against " + TextOf(*larger, claim.unit);
    than = larger->interval;
    are_enough =
        are_enough && (larger->trials >= kMinTrials || find(*claim.than)->second.is_recording);
  }
  if (!std::isfinite(ours->value)) {
    judged.remark = "no trial gave a figure; " + claim.why;
    return judged;
  }
  judged.verdict = VerdictOf(claim, ours->interval, than);
  const bool is_tail = claim.rule == ClaimRule::kDraw && judged.verdict == Verdict::kRefuted &&
                       ours->trials < kMinDraws;
  if (is_tail || !are_enough) judged.verdict = Verdict::kUndecided;
  return judged;
}

}  // namespace sextant
