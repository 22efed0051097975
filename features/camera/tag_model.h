// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

#include "features/camera/edge_pixels.h"
#include "features/camera/tags/tag_pattern.h"

namespace sextant {

/// The parameters of the image of a tag. The tag's square is [-1, 1]^2 here, which keeps the normal
/// matrix well scaled.
struct TagState {
  Eigen::Matrix3d tag_from_straight = Eigen::Matrix3d::Identity();
  double blur_px = 1.0;
  Eigen::Vector3d gain = Eigen::Vector3d::Zero();    ///< Constant and derivatives by x and y.
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

/// Predicts the grey levels of pixels near a tag's edges, vectorised over eight pixels.
///
/// I = g w + o: w is the pattern with a white surrounding through a Gaussian blur that is isotropic
/// in the image and thus skewed in the cells of a tag seen obliquely; g and o are planes. w is the
/// sum over cells of the normal distribution's mass in the cell, the bivariate one by the
/// tetrachoric series (Pearson 1900) Phi(h) Phi(k) + phi(h) phi(k) sum rho^(n+1) / (n+1)! He_n(h)
/// He_n(k) up to rho^3. Exact along edges; the derivative by the blur neglects the series. Phi is
/// accurate to 7.5e-8 (Zelen and Severo 1964).
class TagModel {
 public:
  /// The pixels must outlive this.
  TagModel(const TagPattern& pattern, const EdgePixels& pixels);

  /// Computes the residuals, grey - I, and derivatives at a state.
  void Evaluate(const TagState& state);
  const Eigen::VectorXd& residuals() const { return residuals_; }

  /// Normal equations of the last Evaluate with Huber's weights, min(1, threshold / |r|).
  void Linearise(double threshold, TagNormal& normal, TagRow& right) const;

  struct Cells {
    double first = 0.0;   ///< First cell of the tag's square within the pattern.
    double a_unit = 0.0;  ///< Cells per unit of the square: half the cells along its side.
    int side = 0;
    std::vector<double> black;  ///< 1 or 0, with a border of one cell.
  };
  /// Values of all pixels as a structure of arrays.
  struct Modelled {
    std::vector<double> x, y;  ///< Positions in the tag's square.
    std::vector<double> white;
    std::vector<double> by_x, by_y;  ///< Derivatives of the grey level by the position.
    std::vector<double> by_blur;     ///< Derivatives by the logarithm of the blur.
    std::vector<double> residual;
  };

 private:
  const EdgePixels* pixels_;
  Cells cells_;
  Modelled modelled_;
  Eigen::VectorXd residuals_;
};

}  // namespace sextant
