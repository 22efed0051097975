// SPDX-License-Identifier: Apache-2.0
#include "solvers/pixel_terms.h"

#include <algorithm>

namespace sextant {

void PixelTerms::push_back(const PixelTerm& term) {
  const std::size_t k = size_ % kLanes;
  if (k == 0) blocks_.emplace_back();
  PixelBlock& block = blocks_.back();
  const auto write = [k](double(&places)[kLanes], double value, double beyond) {
    if (k == 0) std::fill(places + 1, places + kLanes, beyond);
    places[k] = value;
  };
  write(block.x, term.in_lidar.x(), term.in_lidar.x());
  write(block.y, term.in_lidar.y(), term.in_lidar.y());
  write(block.z, term.in_lidar.z(), term.in_lidar.z());
  write(block.u, term.pixel.x(), term.pixel.x());
  write(block.v, term.pixel.y(), term.pixel.y());
  write(block.inverse_sigma, term.inverse_sigma, 0.0);
  ++size_;
}

}  // namespace sextant
