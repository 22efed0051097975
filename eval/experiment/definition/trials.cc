// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/definition/trials.h"

#include <limits>

namespace sextant {

MetricValues TrialRows::Add(int subject, int index) {
  keys_.push_back({trial_, static_cast<std::uint16_t>(subject), static_cast<std::uint32_t>(index)});
  const std::size_t begin = values_.size();
  values_.resize(begin + metrics_, std::numeric_limits<double>::quiet_NaN());
  return {wanted_, std::span<double>(values_).subspan(begin)};
}

}  // namespace sextant
