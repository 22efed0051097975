// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/report/rank_table.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "eval/statistics/statistics.h"

namespace sextant {
namespace {

double ErrorOrWorst(double error) {
  return std::isnan(error) ? std::numeric_limits<double>::infinity() : error;
}

// Adds the rank of each subject in one trial.
void AddRanks(std::span<const std::vector<double>> errors, std::size_t trial,
              std::vector<double>& sums) {
  for (std::size_t i = 0; i < errors.size(); ++i) {
    const double own = ErrorOrWorst(errors[i][trial]);
    double rank = 0.5;
    for (const std::vector<double>& of : errors) {
      const double other = ErrorOrWorst(of[trial]);
      rank += other < own ? 1.0 : other == own ? 0.5 : 0.0;
    }
    sums[i] += rank;
  }
}

struct Duel {
  std::uint64_t wins = 0;
  std::uint64_t losses = 0;
};

Duel DuelOf(const std::vector<double>& own, const std::vector<double>& first) {
  Duel duel;
  for (std::size_t trial = 0; trial < own.size(); ++trial) {
    const double a = ErrorOrWorst(own[trial]);
    const double b = ErrorOrWorst(first[trial]);
    duel.wins += a < b ? 1 : 0;
    duel.losses += a > b ? 1 : 0;
  }
  return duel;
}

std::string SignTestText(double p) { return p < 0.001 ? "< 0.001" : Fixed(p, 3); }

}  // namespace

TextTable RankTable(std::span<const std::string> names,
                    std::span<const std::vector<double>> errors) {
  TextTable table({"", "mean rank", "failed", "better than the first", "p (sign test)"});
  if (errors.empty() || errors.front().empty()) return table;
  const std::size_t trials = errors.front().size();
  std::vector<double> ranks(errors.size(), 0.0);
  for (std::size_t trial = 0; trial < trials; ++trial) AddRanks(errors, trial, ranks);
  std::vector<std::size_t> order(errors.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, {}, [&](std::size_t i) { return ranks[i]; });
  for (const std::size_t i : order) {
    const auto failed = std::ranges::count_if(errors[i], [](double e) { return std::isnan(e); });
    std::vector<std::string> row = {names[i], Fixed(ranks[i] / static_cast<double>(trials), 2),
                                    fmt::format("{}/{}", failed, trials)};
    const Duel duel = DuelOf(errors[i], errors[order.front()]);
    const std::uint64_t decided = duel.wins + duel.losses;
    if (decided == 0) {
      row.insert(row.end(), {"-", "-"});
    } else {
      const Interval interval = WilsonInterval(duel.wins, decided);
      const double share = static_cast<double>(duel.wins) / static_cast<double>(decided);
      row.push_back(fmt::format("{} % [{}, {}]", Fixed(100.0 * share, 1),
                                Fixed(100.0 * interval.low, 1), Fixed(100.0 * interval.high, 1)));
      row.push_back(SignTestText(SignTest(duel.wins, duel.losses)));
    }
    table.AddRow(std::move(row));
  }
  return table;
}

}  // namespace sextant
