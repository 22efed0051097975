// SPDX-License-Identifier: Apache-2.0
#include "features/camera/edge_refine.h"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "base/median.h"
#include "features/camera/edge_pixels.h"
#include "features/camera/tag_model.h"
#include "geometry/symmetric.h"
#include "solvers/least_squares/levenberg_marquardt.h"

namespace sextant {
namespace {

constexpr double kHuber = 2.5;
constexpr double kFirstBlur_px = 1.0;  ///< Wide, so that a distant start still reaches the edges.
constexpr double kMinBlur_px = 0.25;   ///< A pixel alone blurs by 0.29.
constexpr double kMaxBlur_px = 6.0;
constexpr double kMinContrast = 5.0;
constexpr double kLastStep = 5e-5;     ///< Step of the homography, in half sides of the tag.
constexpr double kStalledStep = 1e-4;  ///< Converged if only rounding prevents a lower cost.
constexpr double kCoarseStep = 2e-3;   ///< Enough to decide whether the chosen pixels fit.
constexpr double kPixelsStillFit_px = 0.7;
constexpr int kMinPixelsAnEdge = 6;

constexpr double kSquareX[] = {-1.0, 1.0, 1.0, -1.0};
constexpr double kSquareY[] = {-1.0, -1.0, 1.0, 1.0};

// Derivative of the point moved by (I + D), D = [a b c; d e f; g h 0].
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
  Fit(const TagPattern& pattern, const EdgePixels& pixels, TagState start)
      : model_(pattern, pixels), next_(model_), state_(std::move(start)) {}

  // Estimates gain and offset alone, by linear least squares.
  void FitLight() {
    state_.gain.setZero();
    state_.offset.setZero();
    model_.Evaluate(state_);
    model_.Linearise(HUGE_VAL, normal_, right_);
    normal_.diagonal().array() += 1e-6;
    const Eigen::Matrix<double, 6, 1> light =
        SolveSymmetric<6>(normal_.bottomRightCorner<6, 6>(), right_.tail<6>());
    state_.gain = light.head<3>();
    state_.offset = light.tail<3>();
  }

  // Returns whether it converged: the step became smaller than last_step.
  bool Minimise(int max_iterations, double last_step) {
    last_step_ = last_step;
    size_ = HUGE_VAL;
    model_.Evaluate(state_);
    Linearise();
    const MinimiserOutcome outcome =
        LevenbergMarquardt(*this, max_iterations, {.first = 1e-4, .max = 1e8}).outcome;
    return outcome == MinimiserOutcome::kConverged ||
           (outcome == MinimiserOutcome::kStalled && size_ < kStalledStep);
  }

  // The two steps that LevenbergMarquardt takes.
  bool Solve(double damping) {
    TagNormal damped = normal_;
    damped.diagonal() *= 1.0 + damping;
    step_ = damped.ldlt().solve(right_);
    return step_.allFinite();
  }
  Trial Try(double /*damping*/) {
    size_ = step_.head<8>().cwiseAbs().maxCoeff();
    const TagState moved = Moved(state_, step_);
    next_.Evaluate(moved);
    const bool falls = Cost(next_.residuals(), scale_) < cost_;
    if (falls) {
      state_ = moved;
      std::swap(model_, next_);
    }
    if (size_ < last_step_) return Trial::kConverged;
    if (!falls) return Trial::kRejected;
    Linearise();
    return Trial::kTaken;
  }

  // Marginal covariance of the homography's 8 parameters; to be called at the minimum.
  Matrix8d Covariance(double* noise) {
    Linearise();
    const Eigen::VectorXd& residuals = model_.residuals();
    const double squares = residuals.cwiseAbs().cwiseMin(kHuber * scale_).squaredNorm();
    const double variance = squares / static_cast<double>(residuals.size() - kTagUnknowns);
    *noise = std::sqrt(variance);
    return variance * normal_.ldlt().solve(TagNormal::Identity()).eval().topLeftCorner<8, 8>();
  }

  const TagState& state() const { return state_; }

 private:
  // Normal equations at the state, with the weights and the cost of its own scale.
  void Linearise() {
    scale_ = Scale();
    model_.Linearise(kHuber * scale_, normal_, right_);
    cost_ = Cost(model_.residuals(), scale_);
  }

  static double Cost(const Eigen::VectorXd& residuals, double scale) {
    const Eigen::ArrayXd size = residuals.array().abs() / scale;
    return (size < kHuber).select(0.5 * size.square(), kHuber * (size - 0.5 * kHuber)).sum();
  }

  // Robust standard deviation of the residuals.
  double Scale() {
    sizes_ = model_.residuals().cwiseAbs();
    constexpr double kMin = 0.3;  // Rounding to whole grey levels alone.
    return std::max(1.4826 * UpperMedian({sizes_.data(), static_cast<std::size_t>(sizes_.size())}),
                    kMin);
  }

  static TagState Moved(const TagState& state, const TagRow& step) {
    Eigen::Matrix3d change = Eigen::Matrix3d::Identity();
    change.row(0) += step.segment<3>(0).transpose();
    change.row(1) += step.segment<3>(3).transpose();
    change.block<1, 2>(2, 0) += step.segment<2>(6).transpose();
    TagState moved = state;
    moved.tag_from_straight = change * state.tag_from_straight;
    moved.blur_px = std::clamp(state.blur_px * std::exp(std::clamp(step[kTagBlur], -0.5, 0.5)),
                               kMinBlur_px, kMaxBlur_px);
    moved.gain += step.segment<3>(kTagGain);
    moved.offset += step.segment<3>(kTagOffset);
    return moved;
  }

  TagModel model_;
  TagModel next_;  // At the trial step.
  TagState state_;
  Eigen::VectorXd sizes_;
  TagNormal normal_ = TagNormal::Zero();
  TagRow right_ = TagRow::Zero();
  TagRow step_ = TagRow::Zero();
  double scale_ = 0.0;
  double cost_ = 0.0;
  double size_ = 0.0;  // The largest entry of the step of the homography.
  double last_step_ = 0.0;
};

std::optional<Eigen::Matrix3d> TagFromStraight(const Quad& corners_px,
                                               const Undistortion& undistortion) {
  Quad straight;
  for (std::size_t k = 0; k < 4; ++k) {
    const auto point = undistortion.Undistort(corners_px[k]);
    if (!point) return std::nullopt;
    straight[k] = point->straight_px;
  }
  const std::optional<Eigen::Matrix3d> straight_from_unit = UnitSquareToQuad(straight);
  if (!straight_from_unit) return std::nullopt;
  Eigen::Matrix3d unit_from_tag = 0.5 * Eigen::Matrix3d::Identity();
  unit_from_tag.col(2) << 0.5, 0.5, 1.0;
  return (*straight_from_unit * unit_from_tag).inverse();
}

// The corners of the tag's square in the image and their derivatives by the homography's 8
// parameters; false outside the lens model's domain.
bool CornersOf(const TagState& state, const Undistortion& undistortion, Quad& corners_px,
               Matrix8d& by_homography) {
  const Eigen::Matrix3d straight_from_tag = state.tag_from_straight.inverse();
  for (std::size_t k = 0; k < 4; ++k) {
    const Eigen::Vector2d tag(kSquareX[k], kSquareY[k]);
    const auto distorted =
        undistortion.Distort((straight_from_tag * tag.homogeneous()).hnormalized());
    if (!distorted) return false;
    corners_px[k] = distorted->pixel;
    by_homography.middleRows<2>(2 * static_cast<Eigen::Index>(k)) =
        -distorted->pixel_by_straight * ByPoint(straight_from_tag, tag) * ByHomography(tag);
  }
  return true;
}

Expected<void> CheckPixels(const EdgePixels& pixels) {
  for (std::size_t edge = 0; edge < 4; ++edge) {
    if (pixels.on_edge[edge] < kMinPixelsAnEdge) {
      return MakeError(ErrorCode::kDegenerate,
                       fmt::format("edge {} of the tag has {} usable pixels, expected {} or more: "
                                   "the tag is too small, or cut by the image's border",
                                   edge, pixels.on_edge[edge], kMinPixelsAnEdge));
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
  TagState state{.blur_px = kFirstBlur_px};
  // Pixels chosen by an inaccurate start are inaccurate too, so they are chosen once more.
  for (const bool is_last : {false, true}) {
    const auto homography = TagFromStraight(refined.corners_px, undistortion);
    if (!homography) {
      return MakeError(ErrorCode::kDegenerate,
                       "the tag's corners do not form a convex quadrilateral within the domain of "
                       "the lens model");
    }
    const EdgePixels pixels =
        CollectEdgePixels(grey, refined.corners_px, pattern, undistortion, options);
    SEXTANT_RETURN_IF_ERROR(CheckPixels(pixels));
    state.tag_from_straight = *homography;
    const Quad before = refined.corners_px;
    Fit fit(pattern, pixels, state);
    fit.FitLight();
    bool converged = fit.Minimise(options.max_iterations, is_last ? kLastStep : kCoarseStep);
    bool is_in_domain = CornersOf(fit.state(), undistortion, refined.corners_px, by_homography);
    if (!is_last && LargestMove(refined.corners_px, before) < kPixelsStillFit_px) {
      converged = fit.Minimise(options.max_iterations, kLastStep);
      is_in_domain = CornersOf(fit.state(), undistortion, refined.corners_px, by_homography);
    }
    state = fit.state();
    if (!is_in_domain || LargestMove(refined.corners_px, start) > options.max_move_px ||
        (is_last && !converged)) {
      return MakeError(ErrorCode::kNoConvergence,
                       fmt::format("no edges within {} px of the tag's corners fit its pattern",
                                   options.max_move_px));
    }
    if (!is_last && (!converged || LargestMove(refined.corners_px, before) > kPixelsStillFit_px)) {
      continue;
    }
    refined.covariance_px2 =
        by_homography * fit.Covariance(&refined.noise_grey) * by_homography.transpose();
    break;
  }
  refined.blur_px = state.blur_px;
  refined.contrast_grey = state.gain.x();
  if (refined.contrast_grey < kMinContrast) {
    return MakeError(ErrorCode::kNoConvergence,
                     fmt::format("the tag's white is {:.1f} grey levels above its black, expected "
                                 "at least {}",
                                 refined.contrast_grey, kMinContrast));
  }
  return refined;
}

}  // namespace sextant
