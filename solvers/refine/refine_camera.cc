// SPDX-License-Identifier: Apache-2.0
#include "solvers/refine/refine_camera.h"

#include <ceres/ceres.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "geometry/intrinsics.h"
#include "geometry/symmetric.h"
#include "solvers/refine/ceres_parts.h"
#include "solvers/refine/pair_cost.h"

namespace sextant {
namespace {

// Share of the focal length, or of the distorted radius, above which a parameter counts as
// unobservable: its sigma is then far outside the linear range from which it was computed.
constexpr double kLargestSigma = 0.25;

/// The residual of a pixel as a function of the pose and the intrinsics.
class CameraCost final : public ceres::SizedCostFunction<2, 4, 3, kIntrinsicCount> {
 public:
  CameraCost(const PixelTerm& term, const Camera& given) : term_(term), given_(given) {}

  bool Evaluate(double const* const* parameters, double* residuals,
                double** jacobians) const override {
    const Eigen::Map<const Eigen::Quaterniond> rotation(parameters[0]);
    const Eigen::Map<const Eigen::Vector3d> translation(parameters[1]);
    const Camera camera = WithIntrinsics(given_, Eigen::Map<const IntrinsicVector>(parameters[2]));
    if (!(camera.fx_px > 0.0 && camera.fy_px > 0.0)) return false;
    TermDerivatives<2> at;
    if (!Differentiate(term_, &camera, rotation.toRotationMatrix(), translation, at)) return false;
    if (!WritePoseCost(at, parameters[0], residuals, jacobians)) return false;
    if (jacobians == nullptr || jacobians[2] == nullptr) return true;
    const auto pixel_by = PixelByIntrinsics(camera, at.arm + translation);
    if (!pixel_by) return false;
    Eigen::Map<Eigen::Matrix<double, 2, kIntrinsicCount, Eigen::RowMajor>> by_camera(jacobians[2]);
    by_camera = -term_.inverse_sigma * *pixel_by;
    return by_camera.allFinite();
  }

 private:
  PixelTerm term_;
  Camera given_;
};

// A manifold on which all parameters except `free` are constant.
ceres::Manifold* NewIntrinsicManifold(const std::vector<int>& free) {
  std::vector<int> fixed;
  for (int i = 0; i < kIntrinsicCount; ++i) {
    if (!std::binary_search(free.begin(), free.end(), i)) fixed.push_back(i);
  }
  return new ceres::SubsetManifold(kIntrinsicCount, fixed);
}

/// Pose and intrinsics during the iteration, with the cost and the information there.
struct State {
  Rigid3d pose;
  IntrinsicVector numbers;
  double cost = 0.0;  // 1/2 sum rho
  LossVariance variance{};
  OutlierPull pull{6};
  Eigen::MatrixXd information{};  // Over (dphi, dt, free intrinsics), and LossVariance::Factor.
  Eigen::VectorXd levers{};  // Largest shift, in focal lengths, by one unit of each free intrinsic.
};

void AddPoint(const PointTerm& term, const ceres::LossFunction* loss, State& sum) {
  TermDerivatives<3> at;
  Differentiate(term, nullptr, sum.pose.rotation.toRotationMatrix(), sum.pose.translation, at);
  double rho[3] = {at.residual.squaredNorm(), 1.0, 0.0};
  if (loss != nullptr) loss->Evaluate(at.residual.squaredNorm(), rho);
  const Eigen::Matrix<double, 3, 6> jacobian = at.Jacobian();
  sum.information.topLeftCorner<6, 6>() += rho[1] * jacobian.transpose() * jacobian;
  sum.cost += 0.5 * rho[0];
  sum.variance.Add(at.residual.squaredNorm(), 3, rho);
  Eigen::Matrix<double, 3, Eigen::Dynamic> full =
      Eigen::Matrix<double, 3, Eigen::Dynamic>::Zero(3, sum.information.cols());
  full.leftCols<6>() = jacobian;
  sum.pull.Add(full, at.residual, rho[1]);
}

bool AddPixel(const PixelTerm& term, const Camera& camera, const std::vector<int>& free,
              const ceres::LossFunction* loss, State& sum) {
  TermDerivatives<2> at;
  const Eigen::Matrix3d r = sum.pose.rotation.toRotationMatrix();
  if (!Differentiate(term, &camera, r, sum.pose.translation, at)) return false;
  const auto pixel_by = PixelByIntrinsics(camera, at.arm + sum.pose.translation);
  if (!pixel_by) return false;
  double rho[3] = {at.residual.squaredNorm(), 1.0, 0.0};
  if (loss != nullptr) loss->Evaluate(at.residual.squaredNorm(), rho);
  const auto count = static_cast<Eigen::Index>(free.size());
  Eigen::Matrix<double, 2, Eigen::Dynamic> jacobian(2, 6 + count);
  jacobian.leftCols<6>() = at.Jacobian();
  for (Eigen::Index k = 0; k < count; ++k) {
    const int number = free[static_cast<std::size_t>(k)];
    jacobian.col(6 + k) = -term.inverse_sigma * pixel_by->col(number);
    // The shift by a focal length or the centre is relative to the focal length itself.
    const double lever = number < kFirstDistortion ? 1.0 : pixel_by->col(number).norm();
    sum.levers[k] = std::max(sum.levers[k], lever / camera.fx_px);
  }
  sum.information += rho[1] * jacobian.transpose() * jacobian;
  sum.cost += 0.5 * rho[0];
  sum.variance.Add(at.residual.squaredNorm(), 2, rho);
  sum.pull.Add(jacobian, at.residual, rho[1]);
  return true;
}

// Fills in all but pose and intrinsics; false where a point does not project.
bool SumUp(const PairTerms& terms, const std::vector<int>& free, const RobustLoss& loss,
           State& sum) {
  const std::unique_ptr<ceres::LossFunction> rho(NewLoss(loss));
  const auto count = static_cast<Eigen::Index>(free.size());
  sum.cost = 0.0;
  sum.variance = {};
  sum.pull = OutlierPull(static_cast<int>(6 + count));
  sum.information.setZero(6 + count, 6 + count);
  sum.levers.setZero(count);
  const Camera camera = WithIntrinsics(terms.camera, sum.numbers);
  for (const PointTerm& term : terms.points) AddPoint(term, rho.get(), sum);
  for (const PixelTerm term : terms.pixels) {
    if (!AddPixel(term, camera, free, rho.get(), sum)) return false;
  }
  if (rho) sum.information /= sum.variance.Factor(static_cast<double>(6 + count));
  return std::isfinite(sum.cost);
}

ceres::Solver::Summary Minimise(const PairTerms& terms, const std::vector<int>& free,
                                const RobustLoss& loss, const RefineLimits& limits, State& state) {
  ceres::Problem problem;
  double* rotation = state.pose.rotation.coeffs().data();
  double* translation = state.pose.translation.data();
  double* numbers = state.numbers.data();
  problem.AddParameterBlock(rotation, 4, new RotationManifold);
  problem.AddParameterBlock(translation, 3);
  problem.AddParameterBlock(numbers, kIntrinsicCount, NewIntrinsicManifold(free));
  for (const PointTerm& term : terms.points) {
    problem.AddResidualBlock(new PairCost<PointTerm, 3>(term, nullptr), NewLoss(loss), rotation,
                             translation);
  }
  for (const PixelTerm term : terms.pixels) {
    problem.AddResidualBlock(new CameraCost(term, terms.camera), NewLoss(loss), rotation,
                             translation, numbers);
  }
  ceres::Solver::Summary summary;
  ceres::Solve(CeresOptions(limits), &problem, &summary);
  return summary;
}

double Freedom(const PairTerms& terms, std::size_t free) {
  return 3.0 * static_cast<double>(terms.points.size()) +
         2.0 * static_cast<double>(terms.pixels.size()) - 6.0 - static_cast<double>(free);
}

// The inverse of the information, if every free intrinsic is observable.
Expected<Eigen::MatrixXd> ObservableCovariance(const PairTerms& terms, const std::vector<int>& free,
                                               const State& state) {
  std::optional<Eigen::MatrixXd> inverse = InvertSymmetric(state.information);
  if (!inverse) {
    return MakeError(ErrorCode::kDegenerate,
                     "the pairs leave a combination of pose and intrinsics undetermined; use "
                     "points at different depths, or free fewer intrinsics");
  }
  const double freedom = Freedom(terms, free.size());
  if (!terms.noise_known && freedom > 0.0) *inverse *= 2.0 * state.cost / freedom;
  for (std::size_t k = 0; k < free.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const double sigma = std::sqrt((*inverse)(6 + i, 6 + i));
    if (sigma * state.levers[i] <= kLargestSigma) continue;
    return MakeError(
        ErrorCode::kDegenerate,
        fmt::format("the pairs do not determine {}: {:.3g} with a sigma of {:.2g}; use points at "
                    "different depths, or free fewer intrinsics",
                    IntrinsicName(terms.camera.model, free[k]), state.numbers[free[k]], sigma));
  }
  return *std::move(inverse);
}

tl::unexpected<Error> NotConverged(const char* why) {
  return MakeError(ErrorCode::kNoConvergence,
                   fmt::format("pose and intrinsics: {}; give a better start, or free fewer "
                               "intrinsics",
                               why));
}

}  // namespace

Expected<std::vector<int>> FreeIntrinsics(const Camera& camera, unsigned kinds) {
  std::vector<int> free;
  if ((kinds & kFocal) != 0U) free.insert(free.end(), {0, 1});
  if ((kinds & kCenter) != 0U) free.insert(free.end(), {2, 3});
  if ((kinds & kDistortion) == 0U) return free;
  if (camera.model == CameraModel::kPinhole) {
    return MakeError(ErrorCode::kInvalidInput,
                     "intrinsics=distortion: the camera is a pinhole; expected the model "
                     "Brown-Conrady or equidistant, with its coefficients near what they are");
  }
  if (camera.model == CameraModel::kDoubleSphere) {
    return MakeError(ErrorCode::kInvalidInput,
                     "intrinsics=distortion: xi and alpha of a double-sphere camera are not "
                     "estimated; expected intrinsics=focal+center");
  }
  const int always = camera.model == CameraModel::kEquidistant ? 2 : 4;
  for (int i = 0; i < 8; ++i) {
    if (i < always || camera.distortion[static_cast<std::size_t>(i)] != 0.0) {
      free.push_back(kFirstDistortion + i);
    }
  }
  return free;
}

Expected<RefinedPoseAndCamera> RefinePoseAndCamera(const PairTerms& terms, const Rigid3d& start,
                                                   const std::vector<int>& free,
                                                   const RobustLoss& loss,
                                                   const RefineLimits& limits) {
  if (Freedom(terms, free.size()) < 0.0) {
    return MakeError(
        ErrorCode::kTooFewPairs,
        fmt::format("{} 3D-3D and {} 2D-3D pairs give fewer residuals than the {} "
                    "unknowns of the pose and {} intrinsics; give more pairs or free "
                    "fewer intrinsics",
                    terms.points.size(), terms.pixels.size(), 6 + free.size(), free.size()));
  }
  State state{.pose = start, .numbers = IntrinsicsOf(terms.camera)};
  if (!SumUp(terms, free, loss, state)) {
    return NotConverged("a point does not project at the start");
  }
  const ceres::Solver::Summary summary = Minimise(terms, free, loss, limits, state);
  if (!SumUp(terms, free, loss, state)) return NotConverged("a point left the image");
  // Checked before the outcome: unobservable parameters also prevent convergence.
  SEXTANT_ASSIGN_OR_RETURN(Eigen::MatrixXd covariance, ObservableCovariance(terms, free, state));
  const bool is_pulled = state.pull.Widen(covariance);
  const RefineOutcome outcome = OutcomeOf(summary.termination_type);
  if (outcome != RefineOutcome::kConverged) {
    return NotConverged(outcome == RefineOutcome::kMaxIterations
                            ? "no convergence within max_iterations"
                            : "no step lowers the cost");
  }
  RefinedPoseAndCamera refined;
  refined.cam_from_lidar = state.pose;
  refined.iterations = static_cast<int>(summary.iterations.size());
  refined.camera.camera = WithIntrinsics(terms.camera, state.numbers);
  if (!ValidateCamera(refined.camera.camera)) {
    return NotConverged("the distortion found folds the image");
  }
  const bool is_known = terms.noise_known || Freedom(terms, free.size()) > 0.0;
  if (is_known) refined.covariance = covariance.topLeftCorner<6, 6>();
  if (is_pulled) refined.warnings.push_back(state.pull.Describe());
  for (std::size_t k = 0; k < free.size(); ++k) {
    const auto i = 6 + static_cast<Eigen::Index>(k);
    EstimatedIntrinsic estimated{std::string(IntrinsicName(terms.camera.model, free[k])),
                                 state.numbers[free[k]], std::nullopt};
    if (is_known) estimated.sigma = std::sqrt((covariance)(i, i));
    refined.camera.estimated.push_back(std::move(estimated));
  }
  return refined;
}

}  // namespace sextant
