// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "solvers/pnp/depth_kernel.h"

namespace sextant {

/// The candidate nearest to an answer, and what it becomes where the moments are a little others:
/// its depths follow to first order, as the first eigenvector's perturbation or by a Newton step on
/// the length equations, whichever they were from.
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
