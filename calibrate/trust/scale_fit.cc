// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/scale_fit.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "geometry/pair_noise.h"
#include "geometry/so3.h"
#include "geometry/symmetric.h"

namespace sextant {
namespace {

using Vector7d = Eigen::Matrix<double, 7, 1>;
using Matrix7d = Eigen::Matrix<double, 7, 7>;

constexpr double kNoticeableExcess = 0.006;
constexpr double kSignificantSigmas = 3.0;

using ViewAndBoardId = std::pair<int, int>;

// The normal equations of one board's corners for (dphi, dt, excess).
struct NormalEquations {
  Matrix7d matrix = Matrix7d::Zero();
  Vector7d right = Vector7d::Zero();
  double squares = 0.0;

  void Add(const NormalEquations& other, double factor = 1.0) {
    matrix += factor * other.matrix;
    right += factor * other.right;
    squares += factor * other.squares;
  }
  std::optional<Matrix7d> Inverse() const {
    const auto inverse = InvertSymmetric<Eigen::Dynamic>(matrix);
    if (!inverse) return std::nullopt;
    return Matrix7d(*inverse);
  }
};

// The centre of each board in the camera frame.
std::map<ViewAndBoardId, Eigen::Vector3d> CentersInCam(const CalibrationProblem& problem) {
  std::map<ViewAndBoardId, Eigen::Vector3d> centers;
  for (const BoardView& view : problem.board_views) {
    centers[{view.view, view.board}] = view.cam_from_board.translation;
  }
  return centers;
}

// Scans of a board that stays in its place repeat its errors: they count as one, their mean.
struct Placement {
  int board = 0;
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  NormalEquations sum{};
  int count = 0;
};

std::vector<NormalEquations> MeanByPlacement(
    const std::map<ViewAndBoardId, NormalEquations>& boards,
    const std::map<ViewAndBoardId, Eigen::Vector3d>& centers) {
  constexpr double kSamePlacement_m = 0.05;
  std::vector<Placement> placements;
  for (const auto& [id, equations] : boards) {
    const int number = id.second;
    const Eigen::Vector3d& center = centers.at(id);
    auto at = std::find_if(placements.begin(), placements.end(), [&](const Placement& placement) {
      return placement.board == number && (placement.center - center).norm() < kSamePlacement_m;
    });
    if (at == placements.end()) at = placements.insert(at, {number, center});
    at->sum.Add(equations);
    ++at->count;
  }
  std::vector<NormalEquations> means(placements.size());
  for (std::size_t i = 0; i < placements.size(); ++i) {
    means[i].Add(placements[i].sum, 1.0 / placements[i].count);
  }
  return means;
}

// `share` maps the centre of a board to its displacement per unit of the excess.
template <class Share>
std::vector<NormalEquations> EquationsOf(const CalibrationProblem& problem, const Rigid3d& pose,
                                         Share share) {
  const auto centers = CentersInCam(problem);
  std::map<ViewAndBoardId, NormalEquations> boards;
  for (const Pair3d3d& pair : problem.pairs_3d3d) {
    const auto center = centers.find({pair.id.view, pair.id.board});
    if (center == centers.end()) continue;
    const Eigen::Vector3d turned = pose.rotation * pair.point_in_lidar;
    Eigen::Matrix<double, 3, 7> jacobian;
    jacobian << -Hat(turned), Eigen::Matrix3d::Identity(), share(center->second);
    const Eigen::Vector3d residual = pair.point_in_cam - turned - pose.translation;
    const double weight = IsotropicWeight(pair);
    NormalEquations& board = boards[center->first];
    board.matrix += weight * jacobian.transpose() * jacobian;
    board.right += weight * jacobian.transpose() * residual;
    board.squares += weight * residual.squaredNorm();
  }
  return MeanByPlacement(boards, centers);
}

// The variance of the excess by the jackknife over boards; 0 where leaving one out leaves too few.
double JackknifeVariance(const NormalEquations& all, const std::vector<NormalEquations>& boards) {
  std::vector<double> without;
  double mean = 0.0;
  for (const NormalEquations& board : boards) {
    NormalEquations rest = all;
    rest.Add(board, -1.0);
    const auto inverse = rest.Inverse();
    if (!inverse) return 0.0;
    without.push_back((*inverse * rest.right)(6));
    mean += without.back() / static_cast<double>(boards.size());
  }
  double squares = 0.0;
  for (const double excess : without) squares += (excess - mean) * (excess - mean);
  const auto n = static_cast<double>(boards.size());
  return (n - 1.0) / n * squares;
}

std::optional<ScaleFit> FitScale(const std::vector<NormalEquations>& boards) {
  NormalEquations all;
  for (const NormalEquations& board : boards) all.Add(board);
  const std::optional<Matrix7d> inverse = all.Inverse();
  if (boards.size() < 2 || !inverse) return std::nullopt;
  const Vector7d step = *inverse * all.right;
  ScaleFit fit{.excess = step(6), .sum_squares = all.squares - step.dot(all.right)};
  // The four corners of a board share its pose, so only six of their twelve numbers are
  // independent.
  const double variance = 2.0 * fit.sum_squares / (12.0 * static_cast<double>(boards.size()) - 7.0);
  fit.sigma = std::sqrt(std::max(variance * (*inverse)(6, 6), JackknifeVariance(all, boards)));
  fit.shift = fit.excess * SolveSymmetric<6>(all.matrix.topLeftCorner<6, 6>(),
                                             all.matrix.topRightCorner<6, 1>());
  return fit;
}

}  // namespace

std::optional<ScaleFits> FitScales(const CalibrationProblem& problem,
                                   const Rigid3d& cam_from_lidar) {
  const auto print = FitScale(
      EquationsOf(problem, cam_from_lidar, [](const Eigen::Vector3d& center) { return center; }));
  const auto focal =
      FitScale(EquationsOf(problem, cam_from_lidar, [](const Eigen::Vector3d& center) {
        return Eigen::Vector3d(0.0, 0.0, center.z());
      }));
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

}  // namespace sextant
