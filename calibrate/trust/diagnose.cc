// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/diagnose.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "calibrate/trust/measured_boards.h"
#include "geometry/pair_noise.h"
#include "geometry/so3.h"
#include "geometry/symmetric.h"

namespace sextant {
namespace {

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

constexpr double kMinExcess = 0.01;  // Relative to a distance.
constexpr double kSigmas = 4.0;
constexpr double kNoticeableExcess = 0.006;
constexpr double kSignificantSigmas = 3.0;
constexpr double kPoorPrint_px = 1.0;  // RMS; a good lens model leaves a third of it.
constexpr double kPoorPrint = 3.0;     // RMS over the stated noise.
constexpr double kSamePlace_m = 0.05;
constexpr double kSameTurn_rad = 5.0 * std::numbers::pi / 180.0;

// The centre of each board in the camera frame, by (view, board).
std::map<std::pair<int, int>, Eigen::Vector3d> CentersInCam(const CalibrationProblem& problem) {
  std::map<std::pair<int, int>, Eigen::Vector3d> centers;
  for (const BoardView& view : problem.board_views) {
    centers[{view.view, view.board}] = view.cam_from_board.translation;
  }
  return centers;
}

// `share` maps the centre of a board to its displacement per unit of the estimated share.
template <class Share>
std::optional<ScaleFit> FitScale(const CalibrationProblem& problem, const Rigid3d& pose,
                                 const std::map<std::pair<int, int>, Eigen::Vector3d>& centers,
                                 Share share) {
  Matrix7d normal = Matrix7d::Zero();
  Vector7d gradient = Vector7d::Zero();
  double squares = 0.0;
  int boards = 0;
  for (const Pair3d3d& pair : problem.pairs_3d3d) {
    const auto center = centers.find({pair.id.view, pair.id.board});
    if (center == centers.end()) continue;
    const Eigen::Vector3d turned = pose.rotation * pair.point_in_lidar;
    Eigen::Matrix<double, 3, 7> jacobian;
    jacobian << -Hat(turned), Eigen::Matrix3d::Identity(), share(center->second);
    const Eigen::Vector3d residual = pair.point_in_cam - turned - pose.translation;
    const double weight = IsotropicWeight(pair);
    normal += weight * jacobian.transpose() * jacobian;
    gradient += weight * jacobian.transpose() * residual;
    squares += weight * residual.squaredNorm();
    boards += pair.id.corner == 0 ? 1 : 0;
  }
  const std::optional<Eigen::MatrixXd> inverse = InvertSymmetric<Eigen::Dynamic>(normal);
  if (boards < 2 || !inverse) return std::nullopt;
  const Vector7d step = *inverse * gradient;
  ScaleFit fit{.excess = step(6), .sum_squares = squares - step.dot(gradient)};
  // The four corners of a board share its pose, so only six of their twelve numbers are
  // independent.
  const double variance = 2.0 * fit.sum_squares / (12.0 * boards - 7.0);
  fit.sigma = std::sqrt(variance * (*inverse)(6, 6));
  fit.shift =
      fit.excess * SolveSymmetric<6>(normal.topLeftCorner<6, 6>(), normal.topRightCorner<6, 1>());
  return fit;
}

void DiagnoseScale(const CalibrationProblem& problem, const Rigid3d& pose,
                   std::vector<std::string>& lines) {
  const std::optional<ScaleFits> fits = FitScales(problem, pose);
  if (!fits) return;
  const bool is_print = fits->IsPrint();
  const ScaleFit& fit = fits->Better();
  if (std::abs(fit.excess) < std::max(kMinExcess, kSigmas * fit.sigma)) return;
  const double percent = 100.0 * std::abs(fit.excess);
  const char* sign = fit.excess > 0.0 ? "longer" : "shorter";
  // A print of 0.9 times its stated size appears 1 / 0.9 times as far away.
  const char* size = fit.excess > 0.0 ? "smaller" : "larger";
  const char* focal = fit.excess > 0.0 ? "long" : "short";
  lines.push_back(
      is_print
          ? fmt::format("board file: distances in the images are {:.1f} percent {} than in the "
                        "scans, in all directions (1 sigma {:.1f}): the print is {} than the "
                        "board file says, or the focal length is wrong; measure the print",
                        percent, sign, 100.0 * fit.sigma, size)
          : fmt::format("intrinsics: boards are {:.1f} percent {} away in the images than in the "
                        "scans, in depth only (1 sigma {:.1f}): the focal length is too {}, or the "
                        "print does not have the size in the board file",
                        percent, fit.excess > 0.0 ? "further" : "less far", 100.0 * fit.sigma,
                        focal));
}

void DiagnosePrints(std::span<const SessionView> views, const Assembly& assembly,
                    std::vector<std::string>& lines) {
  const std::optional<PrintFit> fit = MeasurePrints(views, assembly);
  if (!fit || fit->rms_px < kPoorPrint_px || fit->over_noise < kPoorPrint) return;
  lines.push_back(
      fmt::format("intrinsics: the prints fit the camera model only to {:.1f} px, {:.0f} times "
                  "their noise: the intrinsics do not describe the lens, or a print is not flat",
                  fit->rms_px, fit->over_noise));
}

void DiagnoseSession(const Assembly& assembly, std::vector<std::string>& lines) {
  const std::vector<BoardView>& boards = assembly.problem.board_views;
  std::set<int> views;
  for (const BoardView& board : boards) views.insert(board.view);
  if (views.size() == 1) {
    lines.emplace_back(
        "one view only: it cannot be compared with another, so an error in it would not be "
        "noticed");
    return;
  }
  std::map<int, const BoardView*> first;
  for (const BoardView& board : boards) {
    const auto [entry, is_first] = first.try_emplace(board.board, &board);
    if (is_first) continue;
    const PoseDistance moved = DistanceBetween(entry->second->cam_from_board, board.cam_from_board);
    if (moved.translation_m > kSamePlace_m || moved.rotation_rad > kSameTurn_rad) return;
  }
  lines.push_back(
      fmt::format("all {} views are the same: every board stays within {:.0f} cm and {:.0f} deg of "
                  "one place; together they contribute little more than one view. Move the boards",
                  views.size(), 100.0 * kSamePlace_m, kSameTurn_rad * 180.0 / std::numbers::pi));
}

// "3, 4 and 2 more", by the views' names.
std::string NamesOf(std::span<const SessionView> views, const std::vector<int>& indices) {
  constexpr std::size_t kMaxNamed = 6;
  std::string text;
  for (std::size_t i = 0; i < std::min(indices.size(), kMaxNamed); ++i) {
    const std::string& name = views[static_cast<std::size_t>(indices[i])].name;
    text +=
        fmt::format("{}{}", i == 0 ? "" : ", ", name.empty() ? std::to_string(indices[i]) : name);
  }
  if (indices.size() <= kMaxNamed) return text;
  return text + fmt::format(" and {} more", indices.size() - kMaxNamed);
}

void DiagnoseRepeats(std::span<const SessionView> views, const Assembly& assembly,
                     std::vector<std::string>& lines) {
  std::vector<int> copies;
  for (const BoardRow& row : assembly.rows) {
    if (row.fate == BoardStatus::kCopy) copies.push_back(static_cast<int>(row.view));
  }
  if (!copies.empty()) {
    lines.push_back(
        fmt::format("copies: view{} {} left out, because image and scan are those of an earlier "
                    "view; a copy adds nothing",
                    copies.size() == 1 ? "" : "s",
                    NamesOf(views, copies) + (copies.size() == 1 ? " is" : " are")));
  }
  for (const RepeatedPlacement& placement : assembly.repeated) {
    lines.push_back(fmt::format(
        "repeated: views {} show board {} in one place; they share its errors, so that they count "
        "as one view in the covariance. Move the board between views",
        NamesOf(views, placement.views),
        assembly.problem.boards[static_cast<std::size_t>(placement.board)].id));
  }
}

}  // namespace

std::optional<ScaleFits> FitScales(const CalibrationProblem& problem,
                                   const Rigid3d& cam_from_lidar) {
  const auto centers = CentersInCam(problem);
  const auto print = FitScale(problem, cam_from_lidar, centers,
                              [](const Eigen::Vector3d& center) { return center; });
  const auto focal = FitScale(problem, cam_from_lidar, centers, [](const Eigen::Vector3d& center) {
    return Eigen::Vector3d(0.0, 0.0, center.z());
  });
  if (!print || !focal) return std::nullopt;
  return ScaleFits{.print = *print, .focal = *focal};
}

bool ScaleFit::IsSignificant() const {
  return std::abs(excess) >= std::max(kNoticeableExcess, kSignificantSigmas * sigma);
}

Matrix6d WithRangeDisagreement(const Matrix6d& covariance, const CalibrationProblem& problem,
                               const Rigid3d& cam_from_lidar) {
  const std::optional<ScaleFits> fits = FitScales(problem, cam_from_lidar);
  if (!fits || !fits->Better().IsSignificant()) return covariance;
  const Vector6d& shift = fits->Better().shift;
  return covariance + shift * shift.transpose();
}

std::vector<std::string> Diagnose(std::span<const SessionView> views, const Assembly& assembly,
                                  const Rigid3d& cam_from_lidar) {
  std::vector<std::string> lines;
  DiagnoseSession(assembly, lines);
  DiagnoseRepeats(views, assembly, lines);
  for (std::string& line : DescribeEdges(MeasureEdges(views, assembly), assembly)) {
    lines.push_back(std::move(line));
  }
  DiagnoseScale(assembly.problem, cam_from_lidar, lines);
  DiagnosePrints(views, assembly, lines);
  return lines;
}

}  // namespace sextant
