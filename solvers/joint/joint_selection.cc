// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/joint_selection.h"

#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

// Upper limit, relative to its mean sqrt(size), of the norm of `size` whitened normal variables at
// `sigmas`: its standard deviation is 1/sqrt(2) (Fisher 1922).
double NormLimit(double size, double sigmas) { return 1.0 + sigmas * std::sqrt(0.5 / size); }

// Degrees of freedom of what differs from print to print: blur, light and flatness change the
// residuals of all its points together, so that they count as those of one point.
constexpr double kPrintFreedom = 2.0;

bool AnyOf(const std::vector<bool>& chosen) {
  return std::find(chosen.begin(), chosen.end(), true) != chosen.end();
}

std::vector<bool> WithinLimit(const std::vector<double>& residuals, double limit) {
  std::vector<bool> within;
  within.reserve(residuals.size());
  for (const double value : residuals) within.push_back(std::abs(value) < limit);
  return within;
}

// Root of rho'(s) at s = residual^2; Huber and Cauchy.
double RootSlope(const RobustLoss& loss, double limit, double residual) {
  const double ratio = std::abs(residual) / limit;
  if (loss.kind == LossKind::kHuber) return ratio > 1.0 ? std::sqrt(1.0 / ratio) : 1.0;
  if (loss.kind == LossKind::kCauchy) return 1.0 / std::sqrt(1.0 + ratio * ratio);
  return 1.0;
}

std::vector<double> RayWeights(const std::vector<double>& residuals,
                               const std::vector<bool>& chosen, double noise,
                               const RobustLoss& loss) {
  std::vector<double> weights(residuals.size(), 0.0);
  for (std::size_t k = 0; k < residuals.size(); ++k) {
    if (chosen[k]) weights[k] = RootSlope(loss, loss.scale * noise, residuals[k]) / noise;
  }
  return weights;
}

Vector6d LinkScale(const JointNoise& noise) {
  Vector6d scale;
  for (int i = 0; i < 6; ++i) {
    scale[i] = 1.0 / (kLinkIsOutOfPlane[i] ? noise.out_of_plane_m : noise.in_plane_m);
  }
  return scale;
}

}  // namespace

bool JointViewSelection::IsUsed() const { return AnyOf(printed) && (AnyOf(face) || AnyOf(edges)); }

void JointViewSelection::Clear() {
  for (std::vector<bool>* kind : {&printed, &face, &edges}) kind->assign(kind->size(), false);
}

JointSelection SelectWithin(const std::vector<BoardViewResiduals>& residuals,
                            const JointNoise& noise, double sigmas) {
  JointSelection selection;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const BoardViewResiduals& of = residuals[i];
    JointViewSelection chosen{
        {}, WithinLimit(of.face, sigmas * noise.face), WithinLimit(of.edges, sigmas * noise.edges)};
    for (std::size_t k = 0; k < of.printed.size(); ++k) {
      chosen.printed.push_back(of.printed[k] < NormLimit(kPrintFreedom, sigmas) * noise.printed);
    }
    if (!chosen.IsUsed()) chosen.Clear();
    selection.push_back(std::move(chosen));
  }
  return selection;
}

std::vector<JointWeights> WeightsOf(const JointModel& model, const JointState& state,
                                    const std::vector<BoardViewResiduals>& residuals,
                                    const JointSelection& selection, const JointNoise& noise,
                                    const JointLosses& losses) {
  const Vector6d scale = LinkScale(noise);
  std::vector<JointWeights> weights;
  for (std::size_t i = 0; i < residuals.size(); ++i) {
    const BoardViewResiduals& of = residuals[i];
    JointWeights own{{},
                     RayWeights(of.face, selection[i].face, noise.face, losses.face),
                     RayWeights(of.edges, selection[i].edges, noise.edges, losses.edges),
                     Vector6d::Zero(),
                     0.0};
    for (std::size_t k = 0; k < of.printed.size(); ++k) {
      const double limit = noise.printed * NormLimit(kPrintFreedom, losses.printed.scale);
      own.printed.push_back(selection[i].printed[k]
                                ? RootSlope(losses.printed, limit, of.printed[k]) / noise.printed
                                : 0.0);
    }
    if (selection[i].IsUsed()) {
      const double norm =
          scale.cwiseProduct(LinkError(state, i, model.views[i].lever_m)).norm() / std::sqrt(6.0);
      own.link_factor = RootSlope(losses.link, NormLimit(6.0, losses.link.scale), norm);
      own.link = own.link_factor * scale;
    }
    weights.push_back(std::move(own));
  }
  return weights;
}

}  // namespace sextant
