// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace sextant {

/// A number that was estimated together with the pose.
struct EstimatedNumber {
  std::string name;  ///< Ends in the unit: "fx_px", "range_bias_m"; ratios have none.
  double value = 0.0;
  std::optional<double> sigma;  ///< None where there is no redundant data.
};

}  // namespace sextant
