// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "geometry/calibration_problem.h"
#include "solvers/kernels/pixel_terms.h"

namespace sextant {

/// Which of a problem's pairs a combinator works on.
enum class PairKind { k3d3d, k2d3d };

/// Residuals of one pair: 3 coordinates or 2.
inline constexpr int ResidualsPerPair(PairKind kind) { return kind == PairKind::k3d3d ? 3 : 2; }

/// What is assumed of pairs that state no noise.
struct AssumedNoise {
  double sigma_m = 0.02;
  double sigma_px = 1.0;
};

/// A 3D-3D pair made ready: r = whitener * (in_cam - R in_lidar - t), the residual of residuals.h
/// with unit variance on each axis.
struct PointTerm {
  Eigen::Vector3d in_cam;
  Eigen::Vector3d in_lidar;
  Eigen::Matrix3d whitener;
};

/// Whitened residuals, not owned: what the kernels take.
struct TermsView {
  std::span<const PointTerm> points;
  PixelTermsView pixels;
  const Camera* camera = nullptr;  ///< Needed where there are pixels.
};

/// Pairs of a problem with their noise, ready for scoring and minimisation.
struct PairTerms {
  std::vector<PointTerm> points;
  PixelTerms pixels;
  Camera camera;
  bool noise_known = true;  ///< False where a pair's noise was assumed.

  TermsView View() const { return {points, pixels.View(), &camera}; }
  std::size_t size() const { return points.size() + pixels.size(); }

  void Add(std::span<const Pair3d3d> pairs, const AssumedNoise& assumed);
  void Add(std::span<const Pair2d3d> pairs, const Camera& of_pairs, const AssumedNoise& assumed);

  /// Replaces the content by the terms of `all` (one kind) at `indices`. Allocates nothing once
  /// it has held as many.
  void AssignSubset(const PairTerms& all, std::span<const int> indices);
};

/// All pairs of one kind.
PairTerms MakeTerms(const CalibrationProblem& problem, PairKind kind, const AssumedNoise& assumed);

}  // namespace sextant
