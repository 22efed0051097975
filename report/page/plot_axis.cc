// SPDX-License-Identifier: Apache-2.0
#include "report/page/plot_axis.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "eval/statistics/text_table.h"

namespace sextant {

PlotAxis::PlotAxis(const std::vector<double>& values, bool is_log) : is_log_(is_log) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  if (is_log) {
    MakeLogarithmic(*low, *high);
  } else {
    MakeLinear(*low, *high);
  }
}

double PlotAxis::Share(double value) const {
  if (is_log_) return std::log(value / low_) / std::log(high_ / low_);
  return (value - low_) / (high_ - low_);
}

std::string PlotAxis::Text(double tick) const {
  return is_log_ ? fmt::format("{:g}", tick) : Fixed(tick, decimals_);
}

// Steps of 1, 2 or 5 times a power of ten, about five of them; from zero where that is not far.
void PlotAxis::MakeLinear(double low, double high) {
  if (low > 0.0 && low < 0.6 * high) low = 0.0;
  if (!(high - low > 1e-9 * std::max(std::abs(low), std::abs(high)))) {
    const double half = std::max(0.5, 0.1 * std::abs(high));
    low -= low == 0.0 ? 0.0 : half;
    high += half;
  }
  const double rough = (high - low) / 5.0;
  const double power = std::pow(10.0, std::floor(std::log10(rough)));
  const double digit = rough / power;
  const double step = power * (digit < 1.5 ? 1.0 : digit < 3.5 ? 2.0 : digit < 7.5 ? 5.0 : 10.0);
  const double first = std::floor(low / step + 1e-9);
  const double last = std::ceil(high / step - 1e-9);
  for (double k = first; k <= last; k += 1.0) ticks_.push_back(k * step);
  low_ = first * step;
  high_ = last * step;
  decimals_ = std::clamp(static_cast<int>(std::ceil(-std::log10(step) - 1e-9)), 0, 9);
}

// Ends and ticks at 1, 2 or 5 times a power of ten; over more than two decades, at powers of ten.
void PlotAxis::MakeLogarithmic(double low, double high) {
  std::vector<double> round;
  const bool is_wide = high > 200.0 * low;
  const auto from = static_cast<int>(std::floor(std::log10(low)));
  const auto to = static_cast<int>(std::ceil(std::log10(high))) + 1;
  for (int exponent = from; exponent <= to; ++exponent) {
    for (const double digit : {1.0, 2.0, 5.0}) {
      if (is_wide && digit > 1.0) continue;
      round.push_back(digit * std::pow(10.0, exponent));
    }
  }
  const auto above = std::upper_bound(round.begin(), round.end(), low * (1.0 + 1e-9));
  const auto first = above == round.begin() ? above : above - 1;
  auto last = std::lower_bound(first, round.end() - 1, high * (1.0 - 1e-9));
  if (last == first) ++last;
  ticks_.assign(first, last + 1);
  low_ = ticks_.front();
  high_ = ticks_.back();
}

}  // namespace sextant
