// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace sextant {

/// An axis of a plot: its ends are round numbers around the data.
class PlotAxis {
 public:
  /// The values must be finite and, for a logarithmic axis, positive; at least one.
  PlotAxis(const std::vector<double>& values, bool is_log);

  /// 0 at the lower end, 1 at the upper one.
  double Share(double value) const;
  const std::vector<double>& ticks() const { return ticks_; }
  std::string Text(double tick) const;

 private:
  void MakeLinear(double low, double high);
  void MakeLogarithmic(double low, double high);

  bool is_log_ = false;
  double low_ = 0.0;
  double high_ = 1.0;
  int decimals_ = 0;
  std::vector<double> ticks_;
};

}  // namespace sextant
