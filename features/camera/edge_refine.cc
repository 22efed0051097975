// SPDX-License-Identifier: Apache-2.0
#include "features/camera/edge_refine.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <vector>

#include "features/camera/blurred_pattern.h"
#include "features/camera/edge_pixels.h"

namespace sextant {
namespace {

// Unknowns: 8 of the homography, the logarithm of the blur, then light: gain and offset, each
// constant, by x and by y.
constexpr int kBlur = 8;
constexpr int kGain = 9;
constexpr int kOffset = 12;
constexpr int kUnknowns = 15;
using Row = Eigen::Matrix<double, kUnknowns, 1>;
using Normal = Eigen::Matrix<double, kUnknowns, kUnknowns>;

constexpr double kHuber = 2.5;
constexpr double kFirstBlur_px = 1.0;   ///< Wide, so that a start far off still feels the edges.
constexpr double kLeastBlur_px = 0.25;  ///< A pixel alone blurs by 0.29.
constexpr double kMostBlur_px = 6.0;
constexpr double kLeastContrast = 5.0;
constexpr double kLastStep = 5e-5;  ///< Of the homography, in half sides of the tag.
constexpr double kStalledStep =
    1e-4;  ///< Of a minimum that only rounding and the blur's derivative hide.
constexpr double kPixelsStillFit_px = 0.7;
constexpr int kLeastPixelsAnEdge = 6;

// The tag's square is [-1, 1]^2 here, which keeps the normal matrix well scaled.
struct State {
  Eigen::Matrix3d tag_from_straight;
  double blur_px = kFirstBlur_px;
  Eigen::Vector3d gain = Eigen::Vector3d::Zero();
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
};

constexpr double kSquareX[] = {-1.0, 1.0, 1.0, -1.0};
constexpr double kSquareY[] = {-1.0, -1.0, 1.0, 1.0};

// Derivative of the point that (I + D) moves, D = [a b c; d e f; g h 0].
Eigen::Matrix<double, 2, 8> ByHomography(const Eigen::Vector2d& point) {
  const double x = point.x();
  const double y = point.y();
  Eigen::Matrix<double, 2, 8> derivative;
  derivative << x, y, 1.0, 0.0, 0.0, 0.0, -x * x, -x * y,  //
      0.0, 0.0, 0.0, x, y, 1.0, -x * y, -y * y;
  return derivative;
}

// Derivative of hnormalized(matrix * (point, 1)) by the point.
Eigen::Matrix2d ByPoint(const Eigen::Matrix3d& matrix, const Eigen::Vector2d& point) {
  const Eigen::Vector3d image = matrix * point.homogeneous();
  const Eigen::Vector2d normalised = image.hnormalized();
  return (matrix.topLeftCorner<2, 2>() - normalised * matrix.block<1, 2>(2, 0)) / image.z();
}

class Fit {
 public:
  Fit(const TagPattern& pattern, const std::vector<EdgePixel>& pixels, State start)
      : pattern_(pattern), pixels_(pixels), state_(std::move(start)) {}

  // Residual and derivative of one pixel. Everything is linear in the light.
  double Residual(const State& state, const EdgePixel& pixel, Row* row) const {
    const Eigen::Vector2d tag =
        (state.tag_from_straight * pixel.straight_px.homogeneous()).hnormalized();
    const Eigen::Matrix2d tag_by_pixel =
        ByPoint(state.tag_from_straight, pixel.straight_px) * pixel.straight_by_pixel;
    const double cells_a_unit = 0.5 * pattern_.edge_cells;
    const Eigen::Vector2d cells =
        (tag.array() + 1.0) * cells_a_unit + static_cast<double>(pattern_.edge_first);
    const Eigen::Vector2d blur_cells = state.blur_px * cells_a_unit * tag_by_pixel.rowwise().norm();
    const double correlation =
        tag_by_pixel.row(0).normalized().dot(tag_by_pixel.row(1).normalized());
    const BlurredCell cell = BlurAt(pattern_, cells, blur_cells, correlation);
    const Eigen::Vector3d place(1.0, tag.x(), tag.y());
    const double gain = state.gain.dot(place);
    if (row != nullptr) {
      const Eigen::Vector2d by_tag = gain * cells_a_unit * cell.by_point;
      row->head<8>() = ByHomography(tag).transpose() * by_tag;
      (*row)[kBlur] = gain * cell.by_relative_blur;
      row->segment<3>(kGain) = cell.white * place;
      row->segment<3>(kOffset) = place;
    }
    return pixel.grey - (gain * cell.white + state.offset.dot(place));
  }

  // Gain and offset alone, by linear least squares.
  void FitLight() {
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Identity() * 1e-6;
    Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
    State dark = state_;
    dark.gain.setZero();
    dark.offset.setZero();
    Row row;
    for (const EdgePixel& pixel : pixels_) {
      const double grey = Residual(dark, pixel, &row);
      normal += row.tail<6>() * row.tail<6>().transpose();
      right += row.tail<6>() * grey;
    }
    const Eigen::Matrix<double, 6, 1> light = normal.ldlt().solve(right);
    state_.gain = light.head<3>();
    state_.offset = light.tail<3>();
  }

  // True once no step is left to take.
  bool Minimise(int max_iterations) {
    double damping = 1e-4;
    Evaluate(state_, residuals_, rows_);
    for (int iteration = 0; iteration < max_iterations; ++iteration) {
      const double scale = Scale();
      Linearise(scale);
      const double before = Cost(residuals_, scale);
      double size = 0.0;
      bool fell = false;
      for (; damping < 1e8 && !fell; damping *= fell ? 0.1 : 10.0) {
        Normal damped = normal_;
        damped.diagonal() *= 1.0 + damping;
        const Row step = damped.ldlt().solve(right_);
        if (!step.allFinite()) return false;
        size = step.head<8>().cwiseAbs().maxCoeff();
        const State next = Moved(state_, step);
        Evaluate(next, next_residuals_, next_rows_);
        fell = Cost(next_residuals_, scale) < before;
        if (fell) {
          state_ = next;
          residuals_.swap(next_residuals_);
          rows_.swap(next_rows_);
        }
        if (size < kLastStep) return true;
      }
      if (!fell) return size < kStalledStep;
      damping = std::max(damping, 1e-9);
    }
    return false;
  }

  // Of the homography's 8, all else estimated too; to be called at the minimum.
  Matrix8d Covariance(double* noise) {
    const double scale = Scale();
    Linearise(scale);
    const double squares = residuals_.cwiseAbs().cwiseMin(kHuber * scale).squaredNorm();
    const double variance = squares / static_cast<double>(residuals_.size() - kUnknowns);
    *noise = std::sqrt(variance);
    return variance * normal_.ldlt().solve(Normal::Identity()).eval().topLeftCorner<8, 8>();
  }

  const State& state() const { return state_; }

 private:
  using Rows = Eigen::Matrix<double, kUnknowns, Eigen::Dynamic>;

  void Evaluate(const State& state, Eigen::VectorXd& residuals, Rows& rows) const {
    residuals.resize(std::ssize(pixels_));
    rows.resize(Eigen::NoChange, std::ssize(pixels_));
    Row row;
    for (Eigen::Index i = 0; i < residuals.size(); ++i) {
      residuals[i] = Residual(state, pixels_[static_cast<std::size_t>(i)], &row);
      rows.col(i) = row;
    }
  }

  static double Cost(const Eigen::VectorXd& residuals, double scale) {
    const Eigen::ArrayXd size = residuals.array().abs() / scale;
    return (size < kHuber).select(0.5 * size.square(), kHuber * (size - 0.5 * kHuber)).sum();
  }

  // Robust standard deviation of the residuals.
  double Scale() const {
    Eigen::VectorXd sizes = residuals_.cwiseAbs();
    const auto middle = sizes.begin() + sizes.size() / 2;
    std::nth_element(sizes.begin(), middle, sizes.end());
    constexpr double kLeast = 0.3;  // Rounding to whole grey levels alone.
    return std::max(1.4826 * *middle, kLeast);
  }

  void Linearise(double scale) {
    const Eigen::VectorXd weights = (kHuber * scale / residuals_.array().abs().max(1e-12)).min(1.0);
    weighted_ = rows_ * weights.asDiagonal();
    normal_.noalias() = weighted_ * rows_.transpose();
    right_.noalias() = weighted_ * residuals_;
  }

  static State Moved(const State& state, const Row& step) {
    Eigen::Matrix3d change = Eigen::Matrix3d::Identity();
    change.row(0) += step.segment<3>(0).transpose();
    change.row(1) += step.segment<3>(3).transpose();
    change.block<1, 2>(2, 0) += step.segment<2>(6).transpose();
    State moved = state;
    moved.tag_from_straight = change * state.tag_from_straight;
    moved.blur_px = std::clamp(state.blur_px * std::exp(std::clamp(step[kBlur], -0.5, 0.5)),
                               kLeastBlur_px, kMostBlur_px);
    moved.gain += step.segment<3>(kGain);
    moved.offset += step.segment<3>(kOffset);
    return moved;
  }

  const TagPattern& pattern_;
  const std::vector<EdgePixel>& pixels_;
  State state_;
  Eigen::VectorXd residuals_;
  Eigen::VectorXd next_residuals_;
  Rows rows_;
  Rows next_rows_;
  Rows weighted_;
  Normal normal_ = Normal::Zero();
  Row right_ = Row::Zero();
};

std::optional<Eigen::Matrix3d> TagFromStraight(const Quad& corners_px,
                                               const Undistortion& undistortion) {
  Quad straight;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto point = undistortion.Straighten(corners_px[k]);
    if (!point) return std::nullopt;
    straight[k] = point->straight_px;
  }
  const std::optional<Eigen::Matrix3d> straight_from_unit = UnitSquareToQuad(straight);
  if (!straight_from_unit) return std::nullopt;
  Eigen::Matrix3d unit_from_tag = 0.5 * Eigen::Matrix3d::Identity();
  unit_from_tag.col(2) << 0.5, 0.5, 1.0;
  return (*straight_from_unit * unit_from_tag).inverse();
}

// The corners of the tag's square in the image, and their derivative by the homography's 8.
bool CornersOf(const State& state, const Undistortion& undistortion, Quad& corners_px,
               Matrix8d& by_homography) {
  const Eigen::Matrix3d straight_from_tag = state.tag_from_straight.inverse();
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector2d tag(kSquareX[k], kSquareY[k]);
    const auto bent = undistortion.Bend((straight_from_tag * tag.homogeneous()).hnormalized());
    if (!bent) return false;
    corners_px[k] = bent->pixel;
    by_homography.middleRows<2>(2 * static_cast<Eigen::Index>(k)) =
        -bent->pixel_by_straight * ByPoint(straight_from_tag, tag) * ByHomography(tag);
  }
  return true;
}

Expected<void> CheckPixels(const std::vector<EdgePixel>& pixels) {
  std::array<int, 4> on_edge{};
  for (const EdgePixel& pixel : pixels) ++on_edge[static_cast<std::size_t>(pixel.edge)];
  for (std::size_t edge = 0; edge < 4; ++edge) {
    if (on_edge[edge] < kLeastPixelsAnEdge) {
      return MakeError(ErrorCode::kDegenerate,
                       fmt::format("edge {} of the tag has {} pixels to look at, expected {} or "
                                   "more: it is too small, or cut by the image's border",
                                   edge, on_edge[edge], kLeastPixelsAnEdge));
    }
  }
  return {};
}

double LargestMove(const Quad& a, const Quad& b) {
  double largest = 0.0;
  for (std::size_t k = 0; k < 4; ++k) largest = std::max(largest, (a[k] - b[k]).norm());
  return largest;
}

}  // namespace

Expected<RefinedTag> RefineTag(const cv::Mat& grey, const Quad& start, const TagPattern& pattern,
                               const Undistortion& undistortion, const EdgeRefineOptions& options) {
  RefinedTag refined{.corners_px = start};
  Matrix8d by_homography;
  State state;
  // A start that was off chose pixels that are off too: these are chosen again, once.
  for (int pass = 0; pass < 2; ++pass) {
    const auto homography = TagFromStraight(refined.corners_px, undistortion);
    if (!homography) {
      return MakeError(ErrorCode::kDegenerate,
                       "the tag's corners are no convex quadrilateral within the lens model");
    }
    const std::vector<EdgePixel> pixels =
        CollectEdgePixels(grey, refined.corners_px, pattern, undistortion, options);
    if (Expected<void> ok = CheckPixels(pixels); !ok) return tl::unexpected<Error>(ok.error());
    state.tag_from_straight = *homography;
    Fit fit(pattern, pixels, state);
    fit.FitLight();
    const bool converged = fit.Minimise(options.max_iterations);
    state = fit.state();
    const Quad before = refined.corners_px;
    if (!CornersOf(state, undistortion, refined.corners_px, by_homography) ||
        LargestMove(refined.corners_px, start) > options.max_move_px || (pass == 1 && !converged)) {
      return MakeError(ErrorCode::kNoConvergence,
                       fmt::format("no edges within {} px of the tag's corners fit its pattern",
                                   options.max_move_px));
    }
    refined.covariance_px2 =
        by_homography * fit.Covariance(&refined.noise_grey) * by_homography.transpose();
    if (converged && LargestMove(refined.corners_px, before) < kPixelsStillFit_px) break;
  }
  refined.blur_px = state.blur_px;
  refined.contrast_grey = state.gain.x();
  if (refined.contrast_grey < kLeastContrast) {
    return MakeError(ErrorCode::kNoConvergence,
                     fmt::format("the tag's white is {:.1f} grey levels above its black, expected "
                                 "at least {}",
                                 refined.contrast_grey, kLeastContrast));
  }
  return refined;
}

}  // namespace sextant
