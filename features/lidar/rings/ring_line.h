// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "features/lidar/rings/ring_numbers.h"

namespace sextant {

/// How a return lies on its ring's cone. Returns of a beam that starts beside the origin lie on a
/// line in these two numbers, wherever on the axis or around it the beam starts.
struct ConePlace {
  double nearness = 0.0;  ///< 1 / distance from the axis z [1/m].
  double tangent = 0.0;   ///< Tangent of the elevation.

  static ConePlace Of(const UnsortedReturn& point) {
    const double level = std::fmax(std::hypot(point.direction.x(), point.direction.y()), 1e-6);
    return {1.0 / (point.range_m * level), point.direction.z() / level};
  }
};

/// The line through a ring's returns, extended by one return at a time. Its slope is the height at
/// which the beam starts, a few centimetres at most.
class RingLine {
 public:
  void Add(const ConePlace& place) {
    sum_ += 1.0;
    nearness_ += place.nearness;
    tangent_ += place.tangent;
    squares_ += place.nearness * place.nearness;
    products_ += place.nearness * place.tangent;
  }
  double TangentAt(double nearness) const {
    const double mean = nearness_ / sum_;
    return tangent_ / sum_ + Slope() * (nearness - mean);
  }
  double Slope() const {
    // The ratio of the variances of a tangent and of a height: 0.1 mrad and 5 cm.
    constexpr double kPrior = 4e-6;
    constexpr double kMaxSlope_m = 0.2;  // Several rings on a floor form a line, too, but steeper.
    const double slope = (products_ - nearness_ * tangent_ / sum_) /
                         (squares_ - nearness_ * nearness_ / sum_ + kPrior);
    return std::clamp(slope, -kMaxSlope_m, kMaxSlope_m);
  }

 private:
  double sum_ = 0.0;
  double nearness_ = 0.0;
  double tangent_ = 0.0;
  double squares_ = 0.0;
  double products_ = 0.0;
};

/// Whether nearly all returns are on rings whose lines are narrow compared with the distance to the
/// next ring. Rings with fewer than three returns do not count. False for fewer than four rings.
bool AreNarrow(std::span<const std::vector<ConePlace>> rings);

}  // namespace sextant
