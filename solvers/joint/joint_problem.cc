// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/joint_problem.h"

#include <cmath>

namespace sextant {
namespace {

/// Sums of one sensor's residuals over the pose of the board in its frame.
struct PoseSums {
  Matrix6d normal = Matrix6d::Zero();
  Vector6d gradient = Vector6d::Zero();
};

struct LidarSums {
  PoseSums pose;
  Eigen::Matrix<double, 6, kLidarExtras> mixed = Eigen::Matrix<double, 6, kLidarExtras>::Zero();
  Eigen::Matrix3d extras = Eigen::Matrix3d::Zero();
  Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
};

/// Adds the normal equations of one view at a state.
class ViewLineariser {
 public:
  ViewLineariser(const JointView& view, const JointUnknowns& unknowns, const JointLosses& losses,
                 const JointState& state)
      : view_(view),
        unknowns_(unknowns),
        losses_(losses),
        state_(state),
        model_(view, unknowns, state) {}

  bool AddTo(JointSystem& system, std::size_t index) {
    const Rigid3d& cam_from_board = state_.cam_from_board[index];
    JointViewSystem& own = system.views[index];
    own.bs.setZero(6, unknowns_.Count());
    if (!AddPrinted(cam_from_board, own, system)) return false;
    if (!SumRays(cam_from_board)) return false;
    AddLidar(RelativePoseByPoses(state_.cam_from_lidar, cam_from_board), own, system);
    system.cost += cost_;
    return true;
  }

 private:
  bool AddPrinted(const Rigid3d& cam_from_board, JointViewSystem& own, JointSystem& system) {
    PrintedResidual at;
    for (const PrintedTerm& term : view_.terms.printed) {
      if (!Differentiate(term, state_.camera, cam_from_board, at)) return false;
      const double limit = PrintedLimit(term.pixels.size(), losses_.printed.scale);
      const LossValue loss = ApplyLoss(losses_.printed.kind, limit, at.value.squaredNorm());
      cost_ += 0.5 * loss.rho;
      own.bb.noalias() += loss.slope * at.by_pose.transpose() * at.by_pose;
      own.b.noalias() += loss.slope * at.by_pose.transpose() * at.value;
      if (!unknowns_.intrinsics.empty() && !AddIntrinsics(term, at, loss.slope, own, system)) {
        return false;
      }
    }
    return true;
  }

  bool AddIntrinsics(const PrintedTerm& term, const PrintedResidual& at, double weight,
                     JointViewSystem& own, JointSystem& system) const {
    const auto count = static_cast<Eigen::Index>(unknowns_.intrinsics.size());
    Eigen::MatrixXd by(at.value.size(), count);
    for (std::size_t i = 0; i < at.in_cam.size(); ++i) {
      const auto pixel_by = PixelByIntrinsics(state_.camera, at.in_cam[i]);
      if (!pixel_by) return false;
      for (Eigen::Index k = 0; k < count; ++k) {
        by.block<2, 1>(2 * static_cast<Eigen::Index>(i), k) =
            -pixel_by->col(unknowns_.intrinsics[static_cast<std::size_t>(k)]);
      }
    }
    by = (term.whitener.triangularView<Eigen::Lower>() * by).eval();
    const int first = unknowns_.Intrinsic();
    own.bs.middleCols(first, count) += weight * at.by_pose.transpose() * by;
    system.ss.block(first, first, count, count) += weight * by.transpose() * by;
    system.s.segment(first, count) += weight * by.transpose() * at.value;
    return true;
  }

  bool SumRays(const Rigid3d& cam_from_board) {
    const BoardPlane plane(state_.cam_from_lidar.Inverse() * cam_from_board);
    return AddRays(view_.terms.face, plane, losses_.face) &&
           AddRays(view_.terms.edges, plane, losses_.edges);
  }

  template <class Term>
  bool AddRays(const std::vector<Term>& terms, const BoardPlane& plane, const RobustLoss& robust) {
    JointRay at;
    for (const Term& term : terms) {
      if (!model_.Differentiate(term, plane, at)) return false;
      AddRay(at, robust);
    }
    return true;
  }

  void AddRay(const JointRay& at, const RobustLoss& robust) {
    const double value = at.residual.value;
    const LossValue loss = ApplyLoss(robust.kind, robust.scale, value * value);
    cost_ += 0.5 * loss.rho;
    const Eigen::Matrix<double, 1, 6> weighted = loss.slope * at.residual.by_pose;
    lidar_.pose.normal.noalias() += weighted.transpose() * at.residual.by_pose;
    lidar_.pose.gradient.noalias() += weighted.transpose() * value;
    if (unknowns_.Intrinsic() == 6) return;
    lidar_.mixed.noalias() += weighted.transpose() * at.by_extras;
    lidar_.extras.noalias() += loss.slope * at.by_extras.transpose() * at.by_extras;
    lidar_.gradient.noalias() += loss.slope * value * at.by_extras.transpose();
  }

  void AddLidar(const Eigen::Matrix<double, 6, 12>& chain, JointViewSystem& own,
                JointSystem& system) const {
    const Matrix6d by_extrinsic = chain.leftCols<6>();
    const Matrix6d by_board = chain.rightCols<6>();
    const Matrix6d half = lidar_.pose.normal * by_extrinsic;
    own.bb.noalias() += by_board.transpose() * lidar_.pose.normal * by_board;
    own.b.noalias() += by_board.transpose() * lidar_.pose.gradient;
    own.bs.leftCols<6>().noalias() += by_board.transpose() * half;
    system.ss.topLeftCorner<6, 6>().noalias() += by_extrinsic.transpose() * half;
    system.s.head<6>().noalias() += by_extrinsic.transpose() * lidar_.pose.gradient;
    for (int i = 0; i < kLidarExtras; ++i) {
      const int row = model_.IndexOf(i);
      if (row < 0) continue;
      const Vector6d shared = by_extrinsic.transpose() * lidar_.mixed.col(i);
      own.bs.col(row) += by_board.transpose() * lidar_.mixed.col(i);
      system.ss.block<6, 1>(0, row) += shared;
      system.ss.block<1, 6>(row, 0) += shared.transpose();
      system.s[row] += lidar_.gradient[i];
      for (int j = 0; j < kLidarExtras; ++j) {
        if (model_.IndexOf(j) >= 0) system.ss(row, model_.IndexOf(j)) += lidar_.extras(i, j);
      }
    }
  }

  const JointView& view_;
  const JointUnknowns& unknowns_;
  const JointLosses& losses_;
  const JointState& state_;
  JointRayModel model_;
  LidarSums lidar_;
  double cost_ = 0.0;
};

}  // namespace

int JointUnknowns::SizeCount() const {
  if (board_size == JointBoardSize::kScale) return 1;
  return 2 * static_cast<int>(sized_boards.size());
}

bool JointRayModel::Differentiate(const FaceTerm& term, const BoardPlane& plane,
                                  JointRay& out) const {
  if (!sextant::Differentiate(term, plane, out.residual)) return false;
  out.residual.value -= term.inverse_sigma * state_.range_bias_m;
  out.by_extras << -term.inverse_sigma, 0.0, 0.0;
  return true;
}

bool JointRayModel::Differentiate(const EdgeTerm& term, const BoardPlane& plane,
                                  JointRay& out) const {
  if (!sextant::Differentiate(term, plane, out.residual)) return false;
  out.by_extras.setZero();
  if (unknowns_.board_size == JointBoardSize::kScale) {
    out.by_extras[1] = term.inverse_sigma * term.side.offset_m;
    out.residual.value += out.by_extras[1] * state_.size[0];
  } else if (view_.sized_board >= 0) {
    out.by_extras.tail<2>() = term.inverse_sigma * term.side.offset_by_size.transpose();
    out.residual.value +=
        out.by_extras.tail<2>().dot(state_.size.segment<2>(2L * view_.sized_board));
  }
  return true;
}

int JointRayModel::IndexOf(int lidar_extra) const {
  if (lidar_extra == 0) return unknowns_.range_bias ? unknowns_.Bias() : -1;
  if (unknowns_.board_size == JointBoardSize::kScale) {
    return lidar_extra == 1 ? unknowns_.Size() : -1;
  }
  if (view_.sized_board < 0) return -1;
  return unknowns_.Size() + 2 * view_.sized_board + lidar_extra - 1;
}

LossValue ApplyLoss(LossKind kind, double scale, double squared) {
  const double transition = scale * scale;
  if (kind == LossKind::kHuber && squared > transition) {
    const double root = std::sqrt(squared);
    return {2.0 * scale * root - transition, scale / root};
  }
  if (kind == LossKind::kCauchy) {
    return {transition * std::log1p(squared / transition), 1.0 / (1.0 + squared / transition)};
  }
  return {squared, 1.0};
}

double PrintedLimit(std::size_t points, double sigmas) {
  return std::sqrt(2.0 * static_cast<double>(points)) + sigmas * std::sqrt(0.5);
}

std::optional<JointSystem> Linearise(const std::vector<JointView>& views,
                                     const JointUnknowns& unknowns, const JointLosses& losses,
                                     const JointState& state) {
  JointSystem system;
  system.views.resize(views.size());
  system.ss.setZero(unknowns.Count(), unknowns.Count());
  system.s.setZero(unknowns.Count());
  if (!(state.camera.fx_px > 0.0 && state.camera.fy_px > 0.0)) return std::nullopt;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (!ViewLineariser(views[i], unknowns, losses, state).AddTo(system, i)) return std::nullopt;
  }
  if (!std::isfinite(system.cost)) return std::nullopt;
  return system;
}

JointState Moved(const JointState& state, const JointUnknowns& unknowns,
                 const Eigen::VectorXd& shared, const std::vector<Vector6d>& boards) {
  JointState moved = state;
  moved.cam_from_lidar = Perturb(state.cam_from_lidar, shared.head<6>());
  for (std::size_t i = 0; i < boards.size(); ++i) {
    moved.cam_from_board[i] = Perturb(state.cam_from_board[i], boards[i]);
  }
  if (unknowns.range_bias) moved.range_bias_m += shared[unknowns.Bias()];
  moved.size += shared.segment(unknowns.Size(), unknowns.SizeCount());
  if (unknowns.intrinsics.empty()) return moved;
  IntrinsicVector numbers = IntrinsicsOf(state.camera);
  for (std::size_t k = 0; k < unknowns.intrinsics.size(); ++k) {
    numbers[unknowns.intrinsics[k]] += shared[unknowns.Intrinsic() + static_cast<int>(k)];
  }
  moved.camera = WithIntrinsics(state.camera, numbers);
  return moved;
}

}  // namespace sextant
