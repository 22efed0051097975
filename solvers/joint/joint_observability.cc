// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/joint_observability.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "geometry/symmetric.h"
#include "solvers/core/board_view_check.h"

namespace sextant {
namespace {

constexpr double kUsefulBias_m = 0.05;
constexpr double kUsefulShare = 0.05;
constexpr double kPriorWidth = 1e3;
constexpr int kPose = 6;

// Largest shift of a printed point's pixel by one unit of an intrinsic.
double LeverOf(const std::vector<JointView>& views, const JointState& state, int intrinsic) {
  if (intrinsic < kFirstDistortion) return 1.0;
  double lever = 0.0;
  for (std::size_t i = 0; i < views.size(); ++i) {
    for (const PrintedTerm& term : views[i].terms.printed) {
      for (const Eigen::Vector2d& point : term.in_board_m) {
        const auto by = PixelByIntrinsics(
            state.camera, state.cam_from_board[i] * Eigen::Vector3d(point.x(), point.y(), 0.0));
        if (by) lever = std::max(lever, by->col(intrinsic).norm());
      }
    }
  }
  return lever;
}

// Intrinsics that are freed together share a kind.
int KindOf(int intrinsic) { return intrinsic < kFirstDistortion ? intrinsic / 2 : intrinsic; }

bool IsSize(const JointUnknowns& unknowns, int unknown) {
  return unknown >= unknowns.Size() && unknown < unknowns.Intrinsic();
}

}  // namespace

Eigen::VectorXd UsefulSigmas(const std::vector<JointView>& views, const JointUnknowns& unknowns,
                             const JointState& state, std::span<const Board> boards) {
  Eigen::VectorXd useful(unknowns.Count() - kPose);
  if (unknowns.range_bias) useful[unknowns.Bias() - kPose] = kUsefulBias_m;
  const int first_size = unknowns.Size() - kPose;
  if (unknowns.board_size == JointBoardSize::kScale) useful[first_size] = kUsefulShare;
  for (std::size_t i = 0; i < unknowns.sized_boards.size(); ++i) {
    const Board* board = FindBoard(boards, unknowns.sized_boards[i]);
    const int at = first_size + 2 * static_cast<int>(i);
    useful[at] = kUsefulShare * board->top_right_m;
    useful[at + 1] = kUsefulShare * board->right_bottom_m;
  }
  for (std::size_t k = 0; k < unknowns.intrinsics.size(); ++k) {
    const double lever = LeverOf(views, state, unknowns.intrinsics[k]);
    useful[unknowns.Intrinsic() - kPose + static_cast<int>(k)] =
        kUsefulShare * state.camera.fx_px / std::max(lever, 1e-12);
  }
  return useful;
}

std::optional<UnobservableParameter> FindUnobservable(const Eigen::MatrixXd& information,
                                                      const Eigen::VectorXd& useful) {
  if (useful.size() == 0) return std::nullopt;
  Eigen::MatrixXd with_prior = information;
  with_prior.diagonal().tail(useful.size()) += (kPriorWidth * useful).cwiseAbs2().cwiseInverse();
  const auto covariance = InvertSymmetric(with_prior);
  if (!covariance) return std::nullopt;
  const Eigen::VectorXd sigma = covariance->diagonal().tail(useful.size()).cwiseSqrt();
  Eigen::Index worst = 0;
  const double ratio = sigma.cwiseQuotient(useful).maxCoeff(&worst);
  if (ratio <= 1.0) return std::nullopt;
  return UnobservableParameter{kPose + static_cast<int>(worst), sigma[worst], useful[worst]};
}

void FixParameter(int unknown, const CalibrationProblem& problem, JointUnknowns& unknowns,
                  std::vector<JointView>& views, JointState& state) {
  if (unknowns.range_bias && unknown == unknowns.Bias()) {
    unknowns.range_bias = false;
    state.range_bias_m = 0.0;
  } else if (IsSize(unknowns, unknown) && unknowns.board_size == JointBoardSize::kScale) {
    unknowns.board_size = JointBoardSize::kGiven;
    state.size.resize(0);
  } else if (IsSize(unknowns, unknown)) {
    const int board = (unknown - unknowns.Size()) / 2;
    unknowns.sized_boards.erase(unknowns.sized_boards.begin() + board);
    for (JointView& view : views) {
      if (view.sized_board == board) view.sized_board = -1;
      if (view.sized_board > board) --view.sized_board;
    }
    state.size.setZero(unknowns.SizeCount());
  } else {
    // Both focal lengths, or both coordinates of the centre, as each pair is freed together.
    const auto at = static_cast<std::size_t>(unknown - unknowns.Intrinsic());
    const int kind = KindOf(unknowns.intrinsics[at]);
    std::erase_if(unknowns.intrinsics, [kind](int other) { return KindOf(other) == kind; });
    state.camera = *problem.camera;
  }
}

std::string NameOf(const JointUnknowns& unknowns, const Camera& camera, int unknown) {
  if (unknowns.range_bias && unknown == unknowns.Bias()) return "range_bias_m";
  if (IsSize(unknowns, unknown)) {
    if (unknowns.board_size == JointBoardSize::kScale) return "board_scale";
    const int at = unknown - unknowns.Size();
    return fmt::format("board_{}_{}", unknowns.sized_boards[static_cast<std::size_t>(at / 2)],
                       at % 2 == 0 ? "top_right_m" : "right_bottom_m");
  }
  const auto index = static_cast<std::size_t>(unknown - unknowns.Intrinsic());
  return std::string(IntrinsicName(camera.model, unknowns.intrinsics[index]));
}

std::string DescribeUnobservable(const UnobservableParameter& unobservable,
                                 const JointUnknowns& unknowns, const Camera& camera) {
  return fmt::format(
      "{} was fixed at its given value: the views determine it only to {:.2g}, and above {:.2g} it "
      "counts as unobservable; hold the board at more distances and tilts",
      NameOf(unknowns, camera, unobservable.index), unobservable.sigma, unobservable.useful);
}

}  // namespace sextant
