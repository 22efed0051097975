// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/pixel_terms.h"

#include <algorithm>

namespace sextant {

void PixelTerms::AddBlock(const PixelTerm& term) {
  PixelBlock& block = blocks_.emplace_back();
  std::fill_n(block.x, kSimdWidth, term.in_lidar.x());
  std::fill_n(block.y, kSimdWidth, term.in_lidar.y());
  std::fill_n(block.z, kSimdWidth, term.in_lidar.z());
  std::fill_n(block.u, kSimdWidth, term.pixel.x());
  std::fill_n(block.v, kSimdWidth, term.pixel.y());
  std::fill_n(block.inverse_sigma, kSimdWidth, 0.0);
}

}  // namespace sextant
