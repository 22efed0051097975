// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/joint_contradiction.h"

#include <algorithm>
#include <cstddef>

#include "base/median.h"
#include "solvers/joint/normal_of_f.h"

namespace sextant {
namespace {

// A view's contribution to the degrees of freedom of the scale. Six normal differences would give
// 3.8; those of real views have heavier tails.
constexpr double kFreedomOfView = 2.0;
constexpr double kAlike = 0.5;
constexpr double kReturns = 0.7;

double ViewsCompared(const std::vector<ViewSums>& sums) {
  return static_cast<double>(
      std::ranges::count_if(sums, [](const ViewSums& of) { return of.freedom > 0; }));
}

}  // namespace

double ContradictionScale(const std::vector<ViewSums>& sums) {
  constexpr double kMedianOfSix = 5.348 / 6.0;  // Chi-square of 6 degrees, over its mean.
  std::vector<double> ratios;
  for (const ViewSums& of : sums) {
    if (of.freedom > 0) ratios.push_back(of.contradiction / (kMedianOfSix * of.freedom));
  }
  return ratios.empty() ? 1.0 : Median(ratios);
}

std::vector<double> Disagreements(const std::vector<ViewSums>& sums) {
  const double scale = std::max(ContradictionScale(sums), 1.0);
  const double freedom_of_scale = kFreedomOfView * ViewsCompared(sums);
  std::vector<double> sigmas;
  for (const ViewSums& of : sums) {
    const double quotient = of.contradiction / (scale * std::max(of.freedom, 1));
    sigmas.push_back(of.freedom == 0 ? 0.0 : NormalOfF(quotient, of.freedom, freedom_of_scale));
  }
  return sigmas;
}

std::vector<bool> ContradictingViews(const std::vector<ViewSums>& sums,
                                     const std::vector<bool>& before, double sigmas) {
  const double scale = std::max(ContradictionScale(sums), 1e-6);
  const double seen = ViewsCompared(sums);
  std::vector<double> beyond(sums.size(), 0.0);
  double worst = 0.0;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    if (sums[i].freedom == 0) continue;
    const double quotient = sums[i].contradiction / (scale * sums[i].freedom);
    if (NormalOfF(quotient, sums[i].freedom, kFreedomOfView * seen) >
        (before[i] ? kReturns : 1.0) * sigmas) {
      beyond[i] = quotient;
    }
    if (!before[i]) worst = std::max(worst, beyond[i]);
  }
  std::vector<bool> contradicts;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    contradicts.push_back(beyond[i] > 0.0 && (before[i] || beyond[i] >= kAlike * worst));
  }
  const auto count = static_cast<double>(std::ranges::count(contradicts, true));
  if (2.0 * count >= seen) contradicts.assign(sums.size(), false);
  return contradicts;
}

}  // namespace sextant
