// SPDX-License-Identifier: Apache-2.0
#include "solvers/core/board_view_check.h"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <utility>

namespace sextant {
namespace {

constexpr double kUnit = 1e-6;

bool IsPositive(double value) { return value > 0.0 && std::isfinite(value); }

bool IsSymmetricPositive(const Eigen::MatrixXd& m) {
  return m.isApprox(m.transpose(), 1e-9) && Eigen::LLT<Eigen::MatrixXd>(m).info() == Eigen::Success;
}

class ViewCheck {
 public:
  ViewCheck(const BoardView& view, const Board& board) : view_(view), board_(board) {}

  Expected<void> Run() const {
    for (const Rigid3d* pose : {&view_.cam_from_board, &view_.lidar_from_board}) {
      if (!pose->IsFinite()) return NonFinite("a pose");
      if (std::abs(pose->rotation.norm() - 1.0) > kUnit) {
        return Invalid("a rotation that is not a unit quaternion");
      }
    }
    for (const BoardPoints& points : view_.printed) {
      SEXTANT_RETURN_IF_ERROR(CheckPrinted(points));
    }
    SEXTANT_RETURN_IF_ERROR(CheckFace());
    for (const EdgeRay& ray : view_.edges) {
      SEXTANT_RETURN_IF_ERROR(CheckRay(ray));
    }
    return {};
  }

 private:
  tl::unexpected<Error> NonFinite(const char* what) const {
    return MakeError(ErrorCode::kNonFinite, fmt::format("board {} of view {}: {} has a NaN or "
                                                        "infinite number",
                                                        view_.board, view_.view, what));
  }

  tl::unexpected<Error> Invalid(const std::string& what) const {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("board {} of view {} has {}", view_.board, view_.view, what));
  }

  Expected<void> CheckPrinted(const BoardPoints& points) const {
    const std::size_t count = points.pixels.size();
    if (count == 0 || points.in_board_m.size() != count) {
      return Invalid(fmt::format("{} printed points and {} pixels, expected equally many",
                                 points.in_board_m.size(), count));
    }
    const auto finite = [](const Eigen::Vector2d& v) { return v.allFinite(); };
    if (!std::all_of(points.pixels.begin(), points.pixels.end(), finite) ||
        !std::all_of(points.in_board_m.begin(), points.in_board_m.end(), finite) ||
        !points.covariance_px2.allFinite()) {
      return NonFinite("a printed point");
    }
    const auto size = static_cast<Eigen::Index>(2 * count);
    if (points.covariance_px2.rows() != size || points.covariance_px2.cols() != size) {
      return Invalid(fmt::format("a covariance of {} x {} for {} pixels, expected {} x {}",
                                 points.covariance_px2.rows(), points.covariance_px2.cols(), count,
                                 size, size));
    }
    if (!IsSymmetricPositive(points.covariance_px2)) {
      return Invalid("a covariance of pixels that is not symmetric positive definite");
    }
    return {};
  }

  Expected<void> CheckFace() const {
    for (const Eigen::Vector3d& point : view_.face_in_lidar) {
      if (!point.allFinite()) return NonFinite("a face return");
      if (!(point.norm() > 0.0)) return Invalid("a face return at the LiDAR itself");
    }
    if (!view_.face_in_lidar.empty() && !IsPositive(view_.range_sigma_m)) {
      return Invalid(
          fmt::format("a range sigma of {} m, expected more than 0", view_.range_sigma_m));
    }
    if (!view_.face_rings.empty() && view_.face_rings.size() != view_.face_in_lidar.size()) {
      return Invalid(fmt::format("{} ring numbers for {} face returns, expected one for each",
                                 view_.face_rings.size(), view_.face_in_lidar.size()));
    }
    return {};
  }

  Expected<void> CheckRay(const EdgeRay& ray) const {
    if (!ray.direction.allFinite() || !std::isfinite(ray.sigma_m)) return NonFinite("an edge ray");
    if (std::abs(ray.direction.norm() - 1.0) > kUnit) {
      return Invalid("an edge ray whose direction is not a unit vector");
    }
    if (!board_.HasSide(ray.side)) {
      return Invalid(
          fmt::format("an edge ray of side {}, which board {} does not have: expected 0 "
                      "to 3, 4 to 7 for its hole, 8 and more for its round holes",
                      ray.side, board_.id));
    }
    if (!IsPositive(ray.sigma_m)) {
      return Invalid(fmt::format("an edge ray of sigma {} m, expected more than 0", ray.sigma_m));
    }
    return {};
  }

  const BoardView& view_;
  const Board& board_;
};

}  // namespace

const Board* FindBoard(std::span<const Board> boards, int id) {
  const auto at = std::find_if(boards.begin(), boards.end(),
                               [id](const Board& board) { return board.id == id; });
  return at == boards.end() ? nullptr : &*at;
}

Expected<void> CheckBoardView(const BoardView& view, std::span<const Board> boards) {
  const Board* board = FindBoard(boards, view.board);
  if (board == nullptr) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("view {} names board {}, which is not among the {} boards of the "
                                 "problem",
                                 view.view, view.board, boards.size()));
  }
  if (!IsPositive(board->top_right_m) || !IsPositive(board->right_bottom_m)) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("board {} is {} x {} m, expected sides of more than 0", board->id,
                                 board->top_right_m, board->right_bottom_m));
  }
  return ViewCheck(view, *board).Run();
}

Expected<void> CheckBoardViews(std::span<const BoardView> views, std::span<const Board> boards) {
  std::set<std::pair<int, int>> seen;
  for (const BoardView& view : views) {
    if (!seen.emplace(view.view, view.board).second) {
      return MakeError(ErrorCode::kInvalidInput,
                       fmt::format("board {} is in view {} twice, expected at most once",
                                   view.board, view.view));
    }
    SEXTANT_RETURN_IF_ERROR(CheckBoardView(view, boards));
  }
  return {};
}

}  // namespace sextant
