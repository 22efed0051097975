// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "solvers/pnp/depth_kernel.h"

namespace sextant {

/// The candidate nearest to a solution, and the same candidate for slightly displaced moments: its
/// depths follow to first order, by perturbation of the first eigenvector or by a Newton step on
/// the length equations, depending on which of the two the candidate came from.
template <int kAxes>
class NearestDepths : private DepthKernel<kAxes> {
 public:
  NearestDepths(const Correspondences& data, const Rigid3d& near);

  const EpnpCandidate& candidate() const { return this->best(); }
  bool found() const { return found_; }
  std::optional<EpnpCandidate> At(const ImageMoments& moments) const;

 private:
  using Base = DepthKernel<kAxes>;
  using typename Base::Depths;
  using typename Base::Square;

  Square HessianOfLengths(const Depths& z) const;

  Rigid3d answer_;
  Depths depths_;
  bool found_ = false;
  bool is_scaled_eigenvector_ = false;
  Depths gradient_;
  Square inverse_hessian_;
};

}  // namespace sextant
