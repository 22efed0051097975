// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "geometry/calibration_problem.h"
#include "solvers/kernels/pixel_terms.h"

namespace sextant {

/// The kind of a problem's pairs that a solver works on.
enum class PairKind { k3d3d, k2d3d };

/// Residuals of one pair: 3 coordinates or 2.
inline constexpr int ResidualsPerPair(PairKind kind) { return kind == PairKind::k3d3d ? 3 : 2; }

/// A whitened 3D-3D pair: r = whitener * (in_cam - R in_lidar - t), the residual of residuals.h
/// with unit variance on each axis.
struct PointTerm {
  Eigen::Vector3d in_cam;
  Eigen::Vector3d in_lidar;
  Eigen::Matrix3d whitener;
};

/// A view of whitened pairs, the argument of the kernels.
struct TermsView {
  std::span<const PointTerm> points;
  PixelTermsView pixels;
  const Camera* camera = nullptr;  ///< Needed where there are pixels.
};

/// The whitened pairs of a problem; pairs that state no noise keep their unit, m or px.
struct PairTerms {
  std::vector<PointTerm> points;
  PixelTerms pixels;
  Camera camera;
  bool noise_known = true;  ///< False where a pair states no noise.

  TermsView View() const { return {points, pixels.View(), &camera}; }
  std::size_t size() const { return points.size() + pixels.size(); }

  void Add(std::span<const Pair3d3d> pairs);
  void Add(std::span<const Pair2d3d> pairs, const Camera& of_pairs);

  /// Replaces the content by the terms of `all` (one kind) at `indices`. Allocates nothing once
  /// it has held as many terms.
  void AssignSubset(const PairTerms& all, std::span<const int> indices);
};

/// The terms of all pairs of one kind.
PairTerms MakeTerms(const CalibrationProblem& problem, PairKind kind);

}  // namespace sextant
