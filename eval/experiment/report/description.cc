// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/report/description.h"

#include <cmath>
#include <vector>

namespace sextant {

void Description::Add(double value) {
  const bool is_missing = std::isnan(value);
  if (pass_ == 0) {
    missing_ += is_missing ? 1U : 0U;
    count_ += is_missing ? 0U : 1U;
    sum_ += is_missing ? 0.0 : value;
    return;
  }
  if (is_missing) return;
  if (pass_ == 1) {
    const double from_mean = value - mean();
    squares_ += value * value;
    deviations_ += from_mean * from_mean;
  }
  quantiles_->Add(value);
}

void Description::EndPass() {
  if (pass_++ > 0) {
    if (quantiles_) quantiles_->EndPass();
    return;
  }
  if (count_ == 0) return;
  std::vector<QuantileGatherer::Wanted> wanted;
  for (const double q : kQuantiles) wanted.push_back({q, q == 0.5});
  quantiles_.emplace(count_, wanted);
}

double Description::mean() const { return sum_ / static_cast<double>(count_); }

double Description::sd() const { return std::sqrt(deviations_ / static_cast<double>(count_)); }

double Description::rms() const { return std::sqrt(squares_ / static_cast<double>(count_)); }

}  // namespace sextant
