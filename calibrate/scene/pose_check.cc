// SPDX-License-Identifier: Apache-2.0
#include "calibrate/scene/pose_check.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/units.h"
#include "geometry/symmetric.h"

namespace sextant {
namespace {

constexpr double kLimit = 2.33;       // Sigmas; 98 % of a normal distribution.
constexpr double kMinContrast = 5.0;  // Over what coincides by chance, in its sigmas.
// On scenes of known truth the pose itself had at least 0.8 of the contrast of the best one, where
// that was clear.
constexpr double kClearContrast = 9.0;
constexpr double kMinShare = 0.7;
constexpr double kMinHeldOut = 4.0;
constexpr double kIntrinsicsDistance = 16.27;  // 99.9 % of the chi-square distribution of 3.
constexpr int kMinEdges = 150;
constexpr int kMaxStatedMore = 100;

struct WorstSigma {
  double rotation_rad;
  double translation_m;
};

WorstSigma WorstOf(const Matrix6d& covariance) {
  const SquareMatrix<3> rotation = covariance.topLeftCorner<3, 3>();
  const SquareMatrix<3> translation = covariance.bottomRightCorner<3, 3>();
  return {std::sqrt(EigenOf<3>(rotation).values(2)), std::sqrt(EigenOf<3>(translation).values(2))};
}

// "0.90 +- 0.20 deg about the camera's y, 31 +- 12 mm along x", of the largest components.
std::string DescribeChange(const Vector6d& change, const Matrix6d& covariance) {
  Eigen::Index about = 0;
  Eigen::Index along = 0;
  change.head<3>().cwiseAbs().maxCoeff(&about);
  change.tail<3>().cwiseAbs().maxCoeff(&along);
  constexpr const char* kAxes = "xyz";
  return fmt::format("{:.2f} +- {:.2f} deg about the camera's {}, {:.0f} +- {:.0f} mm along {}",
                     change(about) / kRadPerDeg, std::sqrt(covariance(about, about)) / kRadPerDeg,
                     kAxes[about], 1e3 * change(3 + along),
                     1e3 * std::sqrt(covariance(3 + along, 3 + along)), kAxes[along]);
}

bool IsSmaller(const Vector6d& change, const WorstSigma& worst, const CheckLimits& limits) {
  return change.head<3>().norm() + kLimit * worst.rotation_rad < limits.rotation_rad &&
         change.tail<3>().norm() + kLimit * worst.translation_m < limits.translation_m;
}

PoseCheck CertainChange(const Vector6d& change, const Matrix6d& covariance,
                        const CheckLimits& limits) {
  PoseCheck check{.state = PoseState::kMoved,
                  .is_certain = true,
                  .reason = DescribeChange(change, covariance),
                  .change = change,
                  .covariance = covariance};
  if (!IsSmaller(change, WorstOf(covariance), limits)) return check;
  check.state = PoseState::kValid;
  check.reason = fmt::format(
      "within the {:.0f} mm and {:.2f} deg of --detect, but it has changed by {}, which is certain",
      1e3 * limits.translation_m, limits.rotation_rad / kRadPerDeg, check.reason);
  return check;
}

// A covariance from few tiles is uncertain itself (Hotelling's distribution, approximated).
double FewTilesFactor(const SceneFit& fit) { return 1.0 + 9.0 / std::max(2.0, fit.tiles - 6.0); }

// "focal length +3.0 +- 0.2 %, principal point 5 +- 1 px right and -2 +- 1 px down".
std::string DescribeIntrinsics(const Eigen::Vector3d& intrinsics, const Eigen::Vector3d& sigma,
                               double focal_px) {
  return fmt::format(
      "focal length {:+.1f} +- {:.1f} %, principal point {:.0f} +- {:.0f} px right and {:.0f} +- "
      "{:.0f} px down",
      100.0 * std::expm1(intrinsics(0)), 100.0 * sigma(0), focal_px * intrinsics(1),
      focal_px * sigma(1), focal_px * intrinsics(2), focal_px * sigma(2));
}

double ContrastOf(const SceneFit& fit) { return (fit.score - fit.chance_mean) / fit.chance_sigma; }

std::string MoreNeeded(double ratio, int samples, std::string_view what) {
  const double more = std::ceil(samples * (ratio * ratio - 1.0));
  if (more > kMaxStatedMore) return fmt::format("take {} with more structure, near and far", what);
  return fmt::format("about {:.0f} more {} are needed", std::max(1.0, more), what);
}

// Whether the pose has moved cannot be judged by wrong intrinsics, unless it has with all of them.
PoseCheck CheckWithFreeIntrinsics(const SceneFit& fit, const Rigid3d& given,
                                  const std::string& wrong) {
  const Matrix6d covariance = fit.free_covariance.topLeftCorner<6, 6>();
  PoseCheck check{.change = PoseDifference(fit.free.cam_from_lidar, given),
                  .covariance = covariance};
  const double distance = SquaredMahalanobis<6>(check.change, covariance);
  if (distance > kMovedDistance * FewTilesFactor(fit)) {
    check.reason = fmt::format(
        "the camera's intrinsics do not suit the images ({}), and with better ones the pose would "
        "be off by {}; check camera file, image size and distortion, then check the pose again",
        wrong, DescribeChange(check.change, covariance));
  } else {
    check.reason = fmt::format(
        "the camera's intrinsics do not suit the images ({}), and with better ones the pose may be "
        "the given one; check camera file, image size and distortion",
        wrong);
  }
  return check;
}

// What else explains a change as well.
std::string OtherCause(const SceneFit& fit) {
  if (fit.only_intrinsics_score < fit.score - fit.chance_sigma) return {};
  return fmt::format(
      "; other intrinsics explain it as well: focal length {:+.1f} %, principal "
      "point {:.0f} px right and {:.0f} px down",
      100.0 * std::expm1(fit.only_intrinsics(0)), fit.focal_px * fit.only_intrinsics(1),
      fit.focal_px * fit.only_intrinsics(2));
}

}  // namespace

std::string_view ToString(PoseState state) {
  switch (state) {
    case PoseState::kValid:
      return "still valid";
    case PoseState::kMoved:
      return "moved";
    case PoseState::kUnknown:
      break;
  }
  return "cannot tell";
}

PoseCheck JudgeChange(const Vector6d& change, const Matrix6d& covariance, const CheckLimits& limits,
                      int samples, std::string_view what) {
  PoseCheck check{.change = change, .covariance = covariance};
  const WorstSigma worst = WorstOf(covariance);
  const double ratio = kLimit * std::max(worst.rotation_rad / limits.rotation_rad,
                                         worst.translation_m / limits.translation_m);
  if (SquaredMahalanobis<6>(change, covariance) > kMovedDistance) {
    return CertainChange(change, covariance, limits);
  }
  if (ratio <= 1.0) {
    check.state = PoseState::kValid;
    check.reason =
        fmt::format("known to {:.2f} deg and {:.0f} mm in every direction (98 %); measured {}",
                    kLimit * worst.rotation_rad / kRadPerDeg, 1e3 * kLimit * worst.translation_m,
                    DescribeChange(change, covariance));
  } else {
    check.reason =
        fmt::format("known only to {:.2f} deg and {:.0f} mm (98 %) by these {} {}; {}",
                    kLimit * worst.rotation_rad / kRadPerDeg, 1e3 * kLimit * worst.translation_m,
                    samples, what, MoreNeeded(ratio, samples, what));
  }
  return check;
}

std::string WhyUnclear(const SceneFit& fit) {
  if (fit.edges < kMinEdges) {
    return fmt::format(
        "too little structure: {} depth edges in the images, expected {} or more; take scenes with "
        "objects near and far",
        fit.edges, kMinEdges);
  }
  constexpr const char* kCauses =
      "is the pose off by more than 2 deg or 10 cm, or are the pairs not of one moment?";
  if (ContrastOf(fit) < kMinContrast) {
    return fmt::format(
        "the edges of the scans and of the images coincide only {:.1f} sigmas better than by "
        "chance, expected {:.0f}; {}",
        ContrastOf(fit), kMinContrast, kCauses);
  }
  if (fit.held_out >= kMinHeldOut) return {};
  return fmt::format(
      "the halves of the scenes do not confirm each other: with the pose of one half the edges of "
      "the other coincide only {:.1f} sigmas better than by chance, expected {:.0f}; {}",
      fit.held_out, kMinHeldOut, kCauses);
}

bool EndedAtLimit(const SceneFit& fit, const Rigid3d& start) {
  const PoseDistance moved = DistanceBetween(fit.cam_from_lidar, start);
  return moved.rotation_rad > kSearchedRotation_rad || moved.translation_m > kSearchedTranslation_m;
}

double DistanceOfChange(const SceneFit& fit, const Rigid3d& given) {
  const Vector6d change = PoseDifference(fit.cam_from_lidar, given);
  return SquaredMahalanobis<6>(change, fit.own_covariance) / FewTilesFactor(fit);
}

std::string WrongIntrinsics(const SceneFit& fit) {
  const Eigen::Vector3d& off = fit.free.intrinsics;
  const SquareMatrix<3> covariance = fit.free_covariance.bottomRightCorner<3, 3>();
  const double distance = SquaredMahalanobis<3>(off, covariance);
  if (!(distance >= kIntrinsicsDistance * FewTilesFactor(fit))) return {};
  return DescribeIntrinsics(off, covariance.diagonal().cwiseSqrt(), fit.focal_px);
}

PoseCheck CheckScenes(const SceneFit& fit, const Rigid3d& given, const CheckLimits& limits) {
  PoseCheck check{.reason = WhyUnclear(fit),
                  .change = PoseDifference(fit.cam_from_lidar, given),
                  .covariance = fit.covariance};
  if (!check.reason.empty()) return check;
  if (const std::string wrong = WrongIntrinsics(fit); !wrong.empty()) {
    return CheckWithFreeIntrinsics(fit, given, wrong);
  }
  const bool is_far = DistanceOfChange(fit, given) > kMovedDistance;
  const double share = (fit.start_score - fit.chance_mean) / (fit.score - fit.chance_mean);
  const bool is_worse = ContrastOf(fit) > kClearContrast && share < kMinShare;
  if (is_far || is_worse) {
    check = CertainChange(check.change, fit.covariance, limits);
    if (check.state == PoseState::kValid) return check;
    check.reason += fmt::format(" (with the given pose the edges coincide {:.0f} % as well){}",
                                100.0 * std::max(0.0, share), OtherCause(fit));
    if (!EndedAtLimit(fit, given)) return check;
    check.covariance.setConstant(std::numeric_limits<double>::infinity());
    check.reason = fmt::format(
        "by more than {:.1f} m or {:.0f} deg, the limit of the search; by how much is not known, "
        "calibrate again, or give a pose that is nearer",
        kSearchedTranslation_m, kSearchedRotation_rad / kRadPerDeg);
    return check;
  }
  check = JudgeChange(check.change, FewTilesFactor(fit) * fit.covariance, limits, fit.scenes,
                      "different scenes");
  check.covariance = fit.covariance;
  return check;
}

}  // namespace sextant
