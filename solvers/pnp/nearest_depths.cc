// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/nearest_depths.h"

#include <Eigen/LU>

namespace sextant {

template <int kAxes>
NearestDepths<kAxes>::NearestDepths(const Correspondences& data, const Rigid3d& near)
    : Base(data, nullptr), answer_(near) {
  this->near_ = &answer_;
  const Depths scaled = this->Scaled(this->eigenvectors_.col(0));
  const Depths refined = this->Refined(this->DepthsOf(near));
  const auto consider = [this](const Depths& z) {
    if (!z.allFinite()) return false;
    const std::optional<EpnpCandidate> candidate = this->PoseOf(z, /*mirrored=*/false);
    if (!candidate || !candidate->IsBetterThan(this->best_)) return false;
    this->best_ = *candidate;
    depths_ = z;
    found_ = true;
    return true;
  };
  is_scaled_eigenvector_ = consider(scaled);
  if (consider(refined)) is_scaled_eigenvector_ = false;
  if (!found_ || is_scaled_eigenvector_) return;
  inverse_hessian_ = HessianOfLengths(depths_).inverse();
  Square normal;
  this->SumLengthEquations(depths_, gradient_, normal);
  found_ = inverse_hessian_.allFinite();
}

/// The Hessian of half the sum of squares of the length equations.
template <int kAxes>
auto NearestDepths<kAxes>::HessianOfLengths(const Depths& z) const -> Square {
  Depths gradient;
  Square hessian;
  this->SumLengthEquations(z, gradient, hessian);
  const typename Base::Columns d = this->InCamera(z);
  for (int j = 1; j < Base::kDepths; ++j) {
    for (int k = j; k < Base::kDepths; ++k) {
      const double deviation = this->deviation_(j - 1);
      const double wanted = j == k ? deviation * deviation : 0.0;
      const double residual = d.col(j).dot(d.col(k)) - wanted;
      Square curvature = this->x_by_depth_.col(j) * this->x_by_depth_.col(k).transpose() +
                         this->y_by_depth_.col(j) * this->y_by_depth_.col(k).transpose();
      curvature(j, k) += 1.0;
      hessian += residual * (curvature + curvature.transpose());
    }
  }
  return hessian;
}

template <int kAxes>
std::optional<EpnpCandidate> NearestDepths<kAxes>::At(const ImageMoments& moments) const {
  NearestDepths displaced = *this;
  displaced.near_ = &displaced.answer_;
  displaced.SetMoments(moments);
  Depths z = depths_;
  if (is_scaled_eigenvector_) {
    const Depths first = this->eigenvectors_.col(0);
    const Depths moved =
        this->eigenvectors_.transpose() * ((displaced.reduced_ - this->reduced_) * first);
    Depths eigenvector = first;
    for (int k = 1; k < Base::kDepths; ++k) {
      const double gap = this->eigenvalues_(0) - this->eigenvalues_(k);
      eigenvector += moved(k) / gap * this->eigenvectors_.col(k);
    }
    z = displaced.Scaled(eigenvector);
  } else {
    Depths gradient;
    Square normal;
    displaced.SumLengthEquations(depths_, gradient, normal);
    z -= inverse_hessian_ * (gradient - gradient_);
  }
  if (!z.allFinite()) return std::nullopt;
  return displaced.PoseOf(z, /*mirrored=*/false);
}

template class NearestDepths<2>;
template class NearestDepths<3>;

}  // namespace sextant
