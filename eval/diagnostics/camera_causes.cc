// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "eval/diagnostics/causes.h"
#include "eval/diagnostics/outlying_pairs.h"
#include "eval/diagnostics/spread_over.h"
#include "geometry/intrinsics.h"
#include "solvers/core/evaluation.h"
#include "solvers/kernels/pair_terms.h"
#include "solvers/matching/point_order.h"
#include "solvers/refine/refine_camera.h"

namespace sextant {
namespace {

bool IsFlatModel(const Camera& camera) {
  return camera.model == CameraModel::kPinhole || camera.model == CameraModel::kBrownConrady;
}

void AddFieldOfView(const Camera& camera, std::vector<std::string>& causes) {
  constexpr double kMaxView_deg = 140.0;
  constexpr double kMinFocal_px = 20.0;
  if (camera.width_px > 0 && IsFlatModel(camera)) {
    const double view_deg = 2.0 * kDegPerRad * std::atan(0.5 * camera.width_px / camera.fx_px);
    if (view_deg > kMaxView_deg) {
      causes.push_back(fmt::format(
          "camera: a focal length of {:.4g} px and an image {} px wide mean a field of view of "
          "{:.0f} deg, which no camera without a fisheye model has; check that fx is in pixels and "
          "belongs to an image of this size",
          camera.fx_px, camera.width_px, view_deg));
      return;
    }
  }
  if (camera.fx_px >= kMinFocal_px) return;
  causes.push_back(fmt::format(
      "camera: a focal length of {:.4g} is not one in pixels; if it and the pixels are in "
      "millimetres or normalised, everything that is stated in px here is in that unit, else "
      "divide it by the size of a pixel in millimetres",
      camera.fx_px));
}

void AddShape(const Camera& camera, std::vector<std::string>& causes) {
  constexpr double kMaxAspect = 1.5;
  const double aspect = camera.fx_px / camera.fy_px;
  if (aspect > kMaxAspect || aspect < 1.0 / kMaxAspect) {
    causes.push_back(fmt::format(
        "camera: fx = {:.4g} px and fy = {:.4g} px differ by more than pixels that are not square "
        "explain; check the order of the numbers of the camera matrix",
        camera.fx_px, camera.fy_px));
  }
  if (camera.width_px == 0 || camera.height_px == 0) return;
  const bool is_inside = camera.cx_px > 0.0 && camera.cx_px < camera.width_px &&
                         camera.cy_px > 0.0 && camera.cy_px < camera.height_px;
  if (is_inside) return;
  causes.push_back(fmt::format(
      "camera: the principal point ({:.5g}, {:.5g}) is outside the image of {} x {} px; check the "
      "order of the numbers of the camera matrix and the size of the image",
      camera.cx_px, camera.cy_px, camera.width_px, camera.height_px));
}

// A corner may be found a little beyond the border, or be predicted there.
void AddPixelsOutside(const Camera& camera, std::span<const Pair2d3d> pairs,
                      std::vector<std::string>& causes) {
  constexpr double kMargin = 0.05;
  constexpr std::size_t kMaxListed = 5;
  if (camera.width_px == 0 || camera.height_px == 0) return;
  const Eigen::Array2d size(camera.width_px, camera.height_px);
  std::vector<std::size_t> outside;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Eigen::Array2d pixel = pairs[i].pixel.array();
    if ((pixel < -kMargin * size).any() || (pixel > (1.0 + kMargin) * size).any()) {
      outside.push_back(i + 1);
    }
  }
  if (outside.empty()) return;
  const Eigen::Vector2d& first = pairs[outside.front() - 1].pixel;
  const std::size_t listed = std::min(outside.size(), kMaxListed);
  causes.push_back(fmt::format(
      "camera: {} of {} pixels are outside its image of {} x {} px (pair {}{}; the first is at "
      "({:.5g}, {:.5g})); check that the intrinsics belong to images of this size",
      outside.size(), pairs.size(), camera.width_px, camera.height_px,
      fmt::join(outside.begin(), outside.begin() + static_cast<std::ptrdiff_t>(listed), ", "),
      outside.size() > listed ? ", ..." : "", first.x(), first.y()));
}

// Some of the pixels with their points about the centre of these, in pixels of unit weight.
CalibrationProblem SomePixels(const CalibrationProblem& problem) {
  constexpr std::size_t kMaxPairs = 200;
  CalibrationProblem some;
  some.camera = problem.camera;
  some.pairs_2d3d = SpreadOver(problem.pairs_2d3d, kMaxPairs);
  const Eigen::Vector3d first = some.pairs_2d3d.front().point_in_lidar;
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Pair2d3d& pair : some.pairs_2d3d) sum += pair.point_in_lidar - first;
  const Eigen::Vector3d centre = first + sum / static_cast<double>(some.pairs_2d3d.size());
  for (Pair2d3d& pair : some.pairs_2d3d) {
    pair.point_in_lidar -= centre;
    pair.sigma_px = 0.0;
  }
  return some;
}

double SumOfSquaredPixels(const CalibrationProblem& problem, const Rigid3d& pose) {
  double squares = 0.0;
  for (const double residual : Evaluate(problem, pose).per_pair_px) squares += residual * residual;
  return squares;
}

}  // namespace

std::optional<std::string> OtherIntrinsics(const CalibrationProblem& problem) {
  constexpr std::size_t kMinPairs = 10;
  constexpr double kMinRmse_px = 0.1;
  constexpr double kMinF = 15.0;
  constexpr double kMaxShare = 0.5;
  const bool are_pixels = problem.camera && problem.pairs_2d3d.size() >= kMinPairs;
  if (!are_pixels || !ValidateCamera(*problem.camera)) return std::nullopt;
  CalibrationProblem some = SomePixels(problem);
  const auto start = FitGivenOrder(*ModelOf(some.pairs_2d3d, *some.camera));
  if (!start) return std::nullopt;
  const double given = SumOfSquaredPixels(some, start->cam_from_lidar);
  const auto count = static_cast<double>(some.pairs_2d3d.size());
  if (!std::isfinite(given) || !(given > count * kMinRmse_px * kMinRmse_px)) return std::nullopt;
  const std::vector<double> residuals = Evaluate(some, start->cam_from_lidar).per_pair_px;
  if (!OutlyingResiduals(residuals, 2).empty()) return std::nullopt;
  const Expected<std::vector<int>> free = FreeIntrinsics(*some.camera, kFocal | kCenter);
  if (!free) return std::nullopt;
  const auto refined =
      RefinePoseAndCamera(MakeTerms(some, PairKind::k2d3d), start->cam_from_lidar, *free, {}, {});
  if (!refined) return std::nullopt;
  some.camera = refined->camera.camera;
  const double other = SumOfSquaredPixels(some, refined->cam_from_lidar);
  const auto freed = static_cast<double>(free->size());
  const double f = (given - other) / freed * (2.0 * count - 6.0 - freed) / other;
  if (!(f > kMinF) || other > kMaxShare * given) return std::nullopt;
  return fmt::format(
      "camera: with fx, fy = {:.4g}, {:.4g} px and the principal point ({:.4g}, {:.4g}), estimated "
      "along with the pose, the RMSE falls from {:.3g} to {:.3g} px: the intrinsics may not be "
      "those of these images (cropped, scaled, refocused, or with a distortion that is not "
      "stated), and the pose is then off; check them, or use refine(..., intrinsics=focal+center)",
      some.camera->fx_px, some.camera->fy_px, some.camera->cx_px, some.camera->cy_px,
      std::sqrt(given / count), std::sqrt(other / count));
}

std::vector<std::string> CausesInCamera(const CalibrationProblem& problem) {
  std::vector<std::string> causes;
  if (!problem.camera || problem.pairs_2d3d.empty() || !ValidateCamera(*problem.camera)) {
    return causes;
  }
  AddFieldOfView(*problem.camera, causes);
  AddShape(*problem.camera, causes);
  AddPixelsOutside(*problem.camera, problem.pairs_2d3d, causes);
  return causes;
}

}  // namespace sextant
