// SPDX-License-Identifier: Apache-2.0
#include "calibrate/advise/advise.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "base/units.h"
#include "calibrate/trust/information.h"
#include "geometry/symmetric.h"
#include "solvers/core/board_view_check.h"
#include "solvers/joint/board_view_information.h"

namespace sextant {
namespace {

struct Candidate {
  std::size_t board = 0;
  Rigid3d cam_from_board;
};

// Faces the camera, rotated by 45 degrees in its plane, then tilted and turned.
Eigen::Quaterniond Orientation(double turn_deg, double lean_deg) {
  constexpr double kInPlane_deg = 45.0;
  const auto about = [](double deg, const Eigen::Vector3d& axis) {
    return Eigen::Quaterniond(Eigen::AngleAxisd(deg * kRadPerDeg, axis));
  };
  return about(turn_deg, Eigen::Vector3d::UnitY()) * about(lean_deg, Eigen::Vector3d::UnitX()) *
         about(kInPlane_deg, Eigen::Vector3d::UnitZ());
}

std::vector<Candidate> GridOf(const std::vector<Board>& boards, const Camera& camera) {
  std::vector<Candidate> grid;
  for (std::size_t board = 0; board < boards.size(); ++board) {
    for (const double across : {0.15, 0.325, 0.5, 0.675, 0.85}) {
      for (const double down : {0.2, 0.35, 0.5, 0.65, 0.8}) {
        const auto ray = Unproject(camera, {across * camera.width_px, down * camera.height_px});
        if (!ray) continue;
        for (const double range : {1.2, 1.5, 1.8, 2.2, 2.7, 3.3, 4.0, 5.0}) {
          for (const double turn : {-40.0, -20.0, 0.0, 20.0, 40.0}) {
            for (const double lean : {-40.0, -20.0, 0.0, 20.0, 40.0}) {
              grid.push_back({board, {Orientation(turn, lean), range * *ray}});
            }
          }
        }
      }
    }
  }
  return grid;
}

std::optional<Matrix6d> InformationAt(const SensorPair& sensors, const Board& board,
                                      const Rigid3d& cam_from_board) {
  const std::optional<BoardView> view = PredictView(sensors, board, cam_from_board);
  if (!view) return std::nullopt;
  const Expected<Matrix6d> information =
      InformationOfView(*view, board, sensors.camera, sensors.cam_from_lidar, cam_from_board);
  if (!information) return std::nullopt;
  return *information;
}

// Log of the determinant; minus infinity for a singular matrix.
double LogDeterminant(const Matrix6d& information) {
  const SymmetricEigen<6> eigen = EigenOf(information);
  if (!(eigen.values[0] > 0.0)) return -std::numeric_limits<double>::infinity();
  return eigen.values.array().log().sum();
}

// From the image, or else from the scan and the answer.
std::vector<Rigid3d> BoardPosesOf(const CalibrationResult& result) {
  std::vector<Rigid3d> poses;
  for (const ResultView& view : result.views) {
    if (!view.kept) continue;
    for (const ResultBoardView& board : view.boards) {
      if (board.cam_from_board) {
        poses.push_back(*board.cam_from_board);
      } else if (board.lidar_from_board) {
        poses.push_back(result.cam_from_lidar * *board.lidar_from_board);
      }
    }
  }
  return poses;
}

// A view contributes as much less than its noise allows as those of the result do.
double ShareOfPredicted(const CalibrationResult& result) {
  const double excess =
      result.trust && result.trust->stated_over_solver ? *result.trust->stated_over_solver : 1.0;
  return 1.0 / (excess * excess);
}

std::optional<Matrix6d> InformationOf(const ResultView& view, const CalibrationResult& result,
                                      const SensorPair& sensors) {
  if (view.information) return view.information;
  const double share = ShareOfPredicted(result);
  std::optional<Matrix6d> sum;
  for (const ResultBoardView& seen : view.boards) {
    const Board* board = FindBoard(result.boards, seen.board);
    if (board == nullptr || !seen.cam_from_board) continue;
    const auto information = InformationAt(sensors, *board, *seen.cam_from_board);
    if (information) sum = sum.value_or(Matrix6d::Zero()) + share * *information;
  }
  return sum;
}

Expected<void> Check(const CalibrationResult& result, const SensorPair& sensors) {
  if (result.boards.empty()) {
    return MakeError(ErrorCode::kMissingData, "the result has no boards to propose a place for");
  }
  if (sensors.camera.width_px < 1 || sensors.camera.height_px < 1) {
    return MakeError(ErrorCode::kMissingData,
                     "the camera's image size is not known; expected width_px and height_px");
  }
  if (sensors.lidar.elevations_rad.empty() || !(sensors.lidar.azimuth_step_rad > 0.0) ||
      !(sensors.lidar.range_sigma_m > 0.0)) {
    return MakeError(ErrorCode::kMissingData,
                     "the LiDAR's rings, azimuth step and range noise are not known");
  }
  return {};
}

int RingsOn(const BoardView& view) {
  std::set<long> elevations;
  for (const Eigen::Vector3d& point : view.face_in_lidar) {
    elevations.insert(std::lround(1e5 * std::atan2(point.z(), point.head<2>().norm())));
  }
  return static_cast<int>(elevations.size());
}

// The information of all kept views; the covariance after each goes into the advice.
Matrix6d SumOfViews(const CalibrationResult& result, const SensorPair& sensors, Advice& advice) {
  Matrix6d known = Matrix6d::Zero();
  for (const ResultView& view : result.views) {
    if (!view.kept) continue;
    const std::optional<Matrix6d> information = InformationOf(view, result, sensors);
    if (!information) continue;
    known += *information;
    ++advice.views;
    advice.covariance = CovarianceOf(known);
    if (advice.covariance) advice.after.push_back({view.view, *advice.covariance});
  }
  return known;
}

std::optional<std::size_t> BestOf(const std::vector<Candidate>& grid,
                                  const CalibrationResult& result, const SensorPair& sensors,
                                  const Matrix6d& known, int& considered) {
  const double share = ShareOfPredicted(result);
  std::vector<std::optional<double>> gains(grid.size());
  tbb::parallel_for(std::size_t{0}, grid.size(), [&](std::size_t i) {
    const auto information =
        InformationAt(sensors, result.boards[grid[i].board], grid[i].cam_from_board);
    if (information) gains[i] = LogDeterminant(known + share * *information);
  });
  std::optional<std::size_t> best;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (!gains[i]) continue;
    ++considered;
    if (!best || *gains[i] > *gains[*best]) best = i;
  }
  return best;
}

}  // namespace

Expected<Advice> Advise(const CalibrationResult& result, const SensorPair& sensors) {
  SEXTANT_RETURN_IF_ERROR(Check(result, sensors));
  Advice advice;
  const Matrix6d known = SumOfViews(result, sensors, advice);
  advice.warnings = DegenerateSets(BoardPosesOf(result));
  const std::vector<Candidate> grid = GridOf(result.boards, sensors.camera);
  const std::optional<std::size_t> best = BestOf(grid, result, sensors, known, advice.considered);
  if (!best) {
    return MakeError(ErrorCode::kDegenerate,
                     "nowhere from 1.2 to 5 m would both sensors see a board, with four rings on "
                     "it: do their fields of view overlap, and is it large enough?");
  }
  const Candidate& chosen = grid[*best];
  const Board& board = result.boards[chosen.board];
  const Matrix6d information =
      ShareOfPredicted(result) * *InformationAt(sensors, board, chosen.cam_from_board);
  const std::optional<Matrix6d> covariance = CovarianceOf(known + information);
  if (!covariance) {
    return MakeError(ErrorCode::kDegenerate, "no single view of the grid determines the pose");
  }
  advice.proposal = {.board = chosen.board,
                     .cam_from_board = chosen.cam_from_board,
                     .rings = RingsOn(*PredictView(sensors, board, chosen.cam_from_board)),
                     .information = information,
                     .covariance = *covariance,
                     .sentence = DescribePlacement(board, chosen.cam_from_board)};
  return advice;
}

}  // namespace sextant
