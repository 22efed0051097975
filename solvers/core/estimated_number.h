// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

namespace sextant {

/// A number that was estimated along with the pose.
struct EstimatedNumber {
  std::string name;  ///< Ends in its unit: "fx_px", "range_bias_m"; none where it is a ratio.
  double value = 0.0;
  std::optional<double> sigma;  ///< None where the data leaves no residual to judge by.
};

}  // namespace sextant
