// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "features/camera/edge_pixels.h"
#include "features/camera/tag_pattern.h"

namespace sextant {

/// What a picture of a tag depends on. The tag's square is [-1, 1]^2 here, which keeps the normal
/// matrix well scaled.
struct TagState {
  Eigen::Matrix3d tag_from_straight = Eigen::Matrix3d::Identity();
  double blur_px = 1.0;
  Eigen::Vector3d gain = Eigen::Vector3d::Zero();    ///< Constant, by x and by y.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();  ///< Likewise.
};

/// Unknowns: 8 of a homography (I + D) tag_from_straight, D = [a b c; d e f; g h 0]; the logarithm
/// of the blur; gain and offset.
inline constexpr int kTagBlur = 8;
inline constexpr int kTagGain = 9;
inline constexpr int kTagOffset = 12;
inline constexpr int kTagUnknowns = 15;
using TagRow = Eigen::Matrix<double, kTagUnknowns, 1>;
using TagNormal = Eigen::Matrix<double, kTagUnknowns, kTagUnknowns>;

/// Grey levels that a state predicts for pixels near a tag's edges, eight pixels side by side.
///
/// I = g w + o: w the pattern, white all round, through a Gaussian blur that is round in the image
/// and skewed in the cells of a tag seen from the side; g and o planes. w is the sum over cells of
/// the normal distribution's mass in the cell, the bivariate one by the tetrachoric series (Pearson
/// 1900) Phi(h) Phi(k) + phi(h) phi(k) sum rho^(n+1) / (n+1)! He_n(h) He_n(k) up to rho^3. Exact
/// along edges; the derivative by the blur leaves the series out. Phi to 7.5e-8 by Zelen and Severo
/// (1964).
class TagModel {
 public:
  /// The pixels must outlive this.
  TagModel(const TagPattern& pattern, const EdgePixels& pixels);

  /// Residuals, grey - I, and derivatives at a state.
  void Evaluate(const TagState& state);
  const Eigen::VectorXd& residuals() const { return residuals_; }

  /// Normal equations of the last Evaluate with Huber's weights, min(1, most / |r|).
  void Linearise(double most, TagNormal& normal, TagRow& right) const;

  struct Cells {
    double first = 0.0;   ///< Of the pattern's cells, where the tag's square begins...
    double a_unit = 0.0;  ///< ...and half the cells along its side.
    int side = 0;
    std::vector<double> black;  ///< 1 or 0, with a border of a cell.
  };
  /// Of each pixel, structure of arrays.
  struct Modelled {
    std::vector<double> x, y;  ///< In the tag's square.
    std::vector<double> white;
    std::vector<double> by_x, by_y;  ///< Grey level by the place in the square.
    std::vector<double> by_blur;     ///< By the logarithm of the blur.
    std::vector<double> residual;
  };

 private:
  const EdgePixels* pixels_;
  Cells cells_;
  Modelled modelled_;
  Eigen::VectorXd residuals_;
};

}  // namespace sextant
