// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/pixel_terms.h"

#include <algorithm>

namespace sextant {

void PixelTerms::AddBlock(const PixelTerm& term) {
  PixelBlock& block = blocks_.emplace_back();
  std::fill_n(block.x, kLanes, term.in_lidar.x());
  std::fill_n(block.y, kLanes, term.in_lidar.y());
  std::fill_n(block.z, kLanes, term.in_lidar.z());
  std::fill_n(block.u, kLanes, term.pixel.x());
  std::fill_n(block.v, kLanes, term.pixel.y());
  std::fill_n(block.inverse_sigma, kLanes, 0.0);
}

}  // namespace sextant
