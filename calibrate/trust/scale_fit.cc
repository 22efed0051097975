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

// The pose of each board in the camera frame.
std::map<ViewAndBoardId, Rigid3d> PosesInCam(const CalibrationProblem& problem) {
  std::map<ViewAndBoardId, Rigid3d> poses;
  for (const BoardView& view : problem.board_views) {
    poses[{view.view, view.board}] = view.cam_from_board;
  }
  return poses;
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
    const std::map<ViewAndBoardId, Rigid3d>& poses) {
  constexpr double kSamePlacement_m = 0.05;
  std::vector<Placement> placements;
  for (const auto& [id, equations] : boards) {
    const int number = id.second;
    const Eigen::Vector3d& center = poses.at(id).translation;
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

// `share` maps the id of a board and its pose in the camera frame to its displacement there per
// unit of the excess.
template <class Share>
std::vector<NormalEquations> EquationsOf(const CalibrationProblem& problem, const Rigid3d& pose,
                                         Share share) {
  const auto poses = PosesInCam(problem);
  std::map<ViewAndBoardId, NormalEquations> boards;
  for (const Pair3d3d& pair : problem.pairs_3d3d) {
    const auto board_pose = poses.find({pair.id.view, pair.id.board});
    if (board_pose == poses.end()) continue;
    const Eigen::Vector3d turned = pose.rotation * pair.point_in_lidar;
    Eigen::Matrix<double, 3, 7> jacobian;
    jacobian << -Hat(turned), Eigen::Matrix3d::Identity(),
        share(board_pose->first.second, board_pose->second);
    const Eigen::Vector3d residual = pair.point_in_cam - turned - pose.translation;
    const double weight = IsotropicWeight(pair);
    NormalEquations& board = boards[board_pose->first];
    board.matrix += weight * jacobian.transpose() * jacobian;
    board.right += weight * jacobian.transpose() * residual;
    board.squares += weight * residual.squaredNorm();
  }
  return MeanByPlacement(boards, poses);
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
  const auto print =
      FitScale(EquationsOf(problem, cam_from_lidar,
                           [](int /*board*/, const Rigid3d& pose) { return pose.translation; }));
  const auto focal =
      FitScale(EquationsOf(problem, cam_from_lidar, [](int /*board*/, const Rigid3d& pose) {
        return Eigen::Vector3d(0.0, 0.0, pose.translation.z());
      }));
  if (!print || !focal) return std::nullopt;
  return ScaleFits{.print = *print, .focal = *focal};
}

std::vector<PrintShift> FindPrintShifts(const CalibrationProblem& problem,
                                        const Rigid3d& cam_from_lidar) {
  constexpr double kMinShift_m = 0.008;
  constexpr double kMinSigmas = 4.0;
  std::vector<PrintShift> shifts;
  for (int board = 0; board < static_cast<int>(problem.boards.size()); ++board) {
    const int id = problem.boards[static_cast<std::size_t>(board)].id;
    for (int axis = 0; axis < 2; ++axis) {
      const auto fit =
          FitScale(EquationsOf(problem, cam_from_lidar, [id, axis](int of, const Rigid3d& pose) {
            const Eigen::Vector3d along = pose.rotation * Eigen::Vector3d::Unit(axis);
            return of == id ? along : Eigen::Vector3d(Eigen::Vector3d::Zero());
          }));
      if (!fit || std::abs(fit->excess) < std::max(kMinShift_m, kMinSigmas * fit->sigma)) continue;
      shifts.push_back(
          {.board = board, .axis = axis, .shift_m = fit->excess, .sigma_m = fit->sigma});
    }
  }
  return shifts;
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
