// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/board_contradiction.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "eval/diagnostics/complete_boards.h"
#include "eval/diagnostics/f_test.h"
#include "eval/diagnostics/spread_over.h"
#include "solvers/core/rivals.h"
#include "solvers/matching/correspondence_model.h"
#include "solvers/matching/point_order.h"

namespace sextant {
namespace {

constexpr double kOfAlone = 3.0;
constexpr double kOfEdge = 0.1;
constexpr double kOfEdgeIfUndecided = 0.05;
constexpr double kOfSpacing = 0.03;
constexpr double kChanceOfContradiction = 0.002;
// No noise of a camera leaves so many pixels, so that less evidence is needed.
constexpr double kLargeMisfit_px = 4.0;
constexpr double kChanceOfLargeMisfit = 0.04;
constexpr double kUndecided = 6.0;  // Errors that the pairs of a board share are hardly larger.
constexpr std::size_t kMaxCompared = 16;

using Members = std::vector<int>;

std::vector<Members> BoardsOfPoints(const std::vector<Pair3d3d>& pairs) {
  std::vector<Members> boards;
  for (const BoardPairs& group : CompleteBoards(pairs)) {
    boards.emplace_back(group.pairs.begin(), group.pairs.end());
  }
  return boards;
}

std::vector<Members> BoardsOfPixels(const std::vector<Pair2d3d>& pairs) {
  std::map<std::pair<int, int>, Members> by_board;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    by_board[{pairs[i].id.view, pairs[i].id.board}].push_back(static_cast<int>(i));
  }
  std::vector<Members> boards;
  for (auto& [board, members] : by_board) {
    if (members.size() >= kCornersPerBoard) boards.push_back(std::move(members));
  }
  return SpreadOver(boards, kMaxCompared);
}

struct BoardFit {
  Members members{};
  Rigid3d cam_from_lidar{};
  double sum_squares = 0.0;
};

class BoardComparison {
 public:
  BoardComparison(const CalibrationProblem& problem, bool in_pixels)
      : problem_(problem), in_pixels_(in_pixels), dimension_(in_pixels ? 2.0 : 3.0) {
    const std::vector<Members> boards =
        in_pixels ? BoardsOfPixels(problem.pairs_2d3d) : BoardsOfPoints(problem.pairs_3d3d);
    for (const Members& members : boards) {
      const std::optional<BoardFit> alone = Fit(members);
      if (!alone) continue;
      alone_.push_back(*alone);
      all_.insert(all_.end(), members.begin(), members.end());
      squares_alone_ += alone->sum_squares;
      spacing_ += SpacingOf(members);
    }
    spacing_ /= std::max(1.0, static_cast<double>(alone_.size()));
  }

  std::optional<BoardContradiction> Find() const {
    if (alone_.size() < 2) return std::nullopt;
    const std::optional<BoardFit> together = Fit(all_);
    if (!together) return std::nullopt;
    const auto boards = static_cast<double>(alone_.size());
    if (!Contradict(together->sum_squares, squares_alone_, all_.size(), boards)) {
      return std::nullopt;
    }
    if (in_pixels_ && FewPairsExplain(*together)) return std::nullopt;
    const auto points = static_cast<double>(all_.size());
    BoardContradiction found{.in_pixels = in_pixels_,
                             .rmse_together = std::sqrt(together->sum_squares / points),
                             .rmse_alone = std::sqrt(squares_alone_ / points),
                             .apart_m = in_pixels_ ? 0.0 : LargestDistance()};
    const double least = (in_pixels_ ? kOfAlone : kUndecided) * found.rmse_alone;
    found.is_undecided = found.rmse_together > least && NoneOutnumbers();
    if (in_pixels_ && !found.is_undecided) return std::nullopt;
    return found;
  }

 private:
  std::optional<BoardFit> Fit(const Members& members) const {
    const std::unique_ptr<CorrespondenceModel> model = ModelOfPairs(members);
    const std::optional<PointOrder> fit = FitGivenOrder(*model);
    if (!fit) return std::nullopt;
    return BoardFit{members, fit->cam_from_lidar,
                    fit->rmse * fit->rmse * static_cast<double>(members.size())};
  }

  std::unique_ptr<CorrespondenceModel> ModelOfPairs(const Members& members) const {
    std::vector<Pair3d3d> points;
    std::vector<Pair2d3d> pixels;
    for (const int i : members) {
      const auto index = static_cast<std::size_t>(i);
      if (in_pixels_) {
        pixels.push_back(problem_.pairs_2d3d[index]);
      } else {
        points.push_back(problem_.pairs_3d3d[index]);
      }
    }
    return in_pixels_ ? ModelOf(pixels, *problem_.camera) : ModelOf(points);
  }

  // The mean edge of a board of corners in turn, or distance to the nearest neighbour.
  double SpacingOf(const Members& members) const {
    const std::unique_ptr<CorrespondenceModel> model = ModelOfPairs(members);
    const std::vector<Eigen::Vector3d>& observed = model->observed();
    double sum = 0.0;
    for (std::size_t i = 0; i < observed.size(); ++i) {
      double nearest = (observed[(i + 1) % observed.size()] - observed[i]).norm();
      for (std::size_t j = 0; in_pixels_ && j < observed.size(); ++j) {
        if (j != i) nearest = std::min(nearest, (observed[j] - observed[i]).norm());
      }
      sum += nearest;
    }
    return sum / static_cast<double>(observed.size());
  }

  // Numbers that remain when every board has a pose of its own.
  double FreedomAlone() const {
    return dimension_ * static_cast<double>(all_.size()) - 6.0 * static_cast<double>(alone_.size());
  }

  // Whether boards do not fit under one pose, with the noise of all boards alone.
  bool Contradict(double together, double alone, std::size_t pairs, double boards) const {
    const double rmse = std::sqrt(together / static_cast<double>(pairs));
    const double rmse_alone = std::sqrt(squares_alone_ / static_cast<double>(all_.size()));
    if (!in_pixels_) {
      return rmse >= std::max(kOfAlone * rmse_alone, kOfEdge * spacing_) ||
             rmse >= std::max(kUndecided * rmse_alone, kOfEdgeIfUndecided * spacing_);
    }
    const double freedom = FreedomAlone();
    if (rmse < kOfSpacing * spacing_ || freedom < 2.0) return false;
    const double poses = 6.0 * (boards - 1.0);
    const double f = (together - alone) / poses / std::max(1e-300, squares_alone_ / freedom);
    if (!(f > 0.0)) return false;
    const double chance = TailOfF(f, poses, freedom);
    const bool is_large = rmse > std::max(kLargeMisfit_px, kOfAlone * rmse_alone);
    return chance < (is_large ? kChanceOfLargeMisfit : kChanceOfContradiction);
  }

  // Whether the rest fits to about the noise of single boards without a few pairs, the worst first.
  bool FewPairsExplain(const BoardFit& together) const {
    constexpr std::size_t kOf = 5;
    constexpr double kOfNoise = 1.5;
    const std::unique_ptr<CorrespondenceModel> model = ModelOfPairs(all_);
    std::vector<Correspondence> kept;
    for (int i = 0; i < static_cast<int>(all_.size()); ++i) kept.push_back({i, i});
    Rigid3d pose = together.cam_from_lidar;
    const double noise = kOfNoise * std::sqrt(squares_alone_ / FreedomAlone());
    for (std::size_t removed = 0; removed < std::max<std::size_t>(1, all_.size() / kOf);
         ++removed) {
      std::optional<CorrespondenceFit> best;
      std::size_t worst = 0;
      for (std::size_t k = 0; k < kept.size(); ++k) {
        std::vector<Correspondence> rest = kept;
        rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(k));
        const std::optional<CorrespondenceFit> fit = model->Fit(rest, pose);
        if (!fit || (best && fit->sum_squares >= best->sum_squares)) continue;
        best = fit;
        worst = k;
      }
      if (!best) return false;
      kept.erase(kept.begin() + static_cast<std::ptrdiff_t>(worst));
      pose = best->cam_from_lidar;
      const double freedom = std::max(1.0, 2.0 * static_cast<double>(kept.size()) - 6.0);
      if (std::sqrt(best->sum_squares / freedom) < noise) return true;
    }
    return false;
  }

  // Between a board's centres by its own pose and by that of the board before or after it: all
  // pairs of boards would be a quadratic number.
  double LargestDistance() const {
    double largest = 0.0;
    for (std::size_t i = 0; i < alone_.size(); ++i) {
      const BoardFit& other = alone_[i + 1 < alone_.size() ? i + 1 : i - 1];
      Eigen::Vector3d center = Eigen::Vector3d::Zero();
      for (const int k : alone_[i].members) {
        center += problem_.pairs_3d3d[static_cast<std::size_t>(k)].point_in_lidar /
                  static_cast<double>(alone_[i].members.size());
      }
      const Eigen::Vector3d apart =
          alone_[i].cam_from_lidar * center - other.cam_from_lidar * center;
      largest = std::max(largest, apart.norm());
    }
    return largest;
  }

  // For each of the boards the others that fit with it under one pose.
  std::vector<std::vector<bool>> Agreements(const std::vector<BoardFit>& boards) const {
    std::vector<std::vector<bool>> agree(boards.size(), std::vector<bool>(boards.size(), true));
    for (std::size_t i = 0; i < boards.size(); ++i) {
      for (std::size_t j = i + 1; j < boards.size(); ++j) {
        Members both = boards[i].members;
        both.insert(both.end(), boards[j].members.begin(), boards[j].members.end());
        const std::optional<BoardFit> fit = Fit(both);
        const double alone = boards[i].sum_squares + boards[j].sum_squares;
        const bool fits = fit && !Contradict(fit->sum_squares, alone, both.size(), 2.0);
        agree[i][j] = fits;
        agree[j][i] = fits;
      }
    }
    return agree;
  }

  // Whether the largest group of boards that agree with one of them has a rival.
  bool NoneOutnumbers() const {
    const std::vector<BoardFit> boards = SpreadOver(alone_, kMaxCompared);
    const std::vector<std::vector<bool>> agree = Agreements(boards);
    std::vector<bool> is_left(boards.size(), true);
    const auto take_largest = [&] {
      std::size_t largest = 0;
      std::size_t centre = 0;
      for (std::size_t i = 0; i < boards.size(); ++i) {
        std::size_t count = 0;
        for (std::size_t j = 0; j < boards.size(); ++j)
          count += agree[i][j] && is_left[j] ? 1U : 0U;
        if (!is_left[i] || count <= largest) continue;
        largest = count;
        centre = i;
      }
      for (std::size_t j = 0; j < boards.size(); ++j) is_left[j] = is_left[j] && !agree[centre][j];
      return static_cast<double>(largest);
    };
    const double first = take_largest();
    const double second = take_largest();
    // Errors that the pairs of a board share set each of many boards in pixels against the others.
    const bool is_scattered =
        in_pixels_ && boards.size() > 2 &&
        (second < 2.0 || first + second < kRivalShare * static_cast<double>(boards.size()));
    return !is_scattered && second >= kRivalShare * first;
  }

  const CalibrationProblem& problem_;
  bool in_pixels_;
  double dimension_;
  std::vector<BoardFit> alone_;
  Members all_;
  double squares_alone_ = 0.0;
  double spacing_ = 0.0;
};

}  // namespace

std::optional<BoardContradiction> FindContradiction(const CalibrationProblem& problem) {
  if (!problem.pairs_3d3d.empty()) return BoardComparison(problem, false).Find();
  if (problem.pairs_2d3d.empty() || !problem.camera) return std::nullopt;
  return BoardComparison(problem, true).Find();
}

}  // namespace sextant
