// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/joint_costs.h"

#include <gtest/gtest.h>

#include <memory>

#include "eval/synthetic/simulate_views.h"
#include "solvers/blocks/condensed_cost.h"
#include "solvers/blocks/pose_manifold.h"

namespace sextant {
namespace {

using Derivative = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The parameter blocks of a cost, with the manifold of each that has one.
struct CostBlock {
  std::vector<double> numbers;
  const ceres::Manifold* manifold = nullptr;
};

std::vector<const double*> PointersOf(const std::vector<CostBlock>& blocks) {
  std::vector<const double*> pointers;
  for (const CostBlock& block : blocks) pointers.push_back(block.numbers.data());
  return pointers;
}

Eigen::VectorXd ValuesOf(const ceres::CostFunction& cost, const std::vector<CostBlock>& blocks) {
  Eigen::VectorXd values(cost.num_residuals());
  EXPECT_TRUE(cost.Evaluate(PointersOf(blocks).data(), values.data(), nullptr));
  return values;
}

CostBlock Moved(const CostBlock& block, Eigen::Index along, double step) {
  CostBlock moved = block;
  if (block.manifold == nullptr) {
    moved.numbers[static_cast<std::size_t>(along)] += step;
    return moved;
  }
  Eigen::VectorXd delta = Eigen::VectorXd::Zero(block.manifold->TangentSize());
  delta[along] = step;
  block.manifold->Plus(block.numbers.data(), delta.data(), moved.numbers.data());
  return moved;
}

// Compares with central differences in the tangent spaces.
void ExpectItsDerivatives(const ceres::CostFunction& cost, std::vector<CostBlock> blocks) {
  std::vector<Derivative> analytic;
  std::vector<double*> pointers;
  for (const CostBlock& block : blocks) {
    analytic.emplace_back(cost.num_residuals(), std::ssize(block.numbers));
  }
  for (Derivative& of : analytic) pointers.push_back(of.data());
  Eigen::VectorXd values(cost.num_residuals());
  ASSERT_TRUE(cost.Evaluate(PointersOf(blocks).data(), values.data(), pointers.data()));
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const CostBlock at = blocks[b];
    const Eigen::Index size =
        at.manifold != nullptr ? at.manifold->TangentSize() : std::ssize(at.numbers);
    for (Eigen::Index k = 0; k < size; ++k) {
      const double step =
          1e-6 *
          std::max(1.0, at.manifold != nullptr ? 1.0 : at.numbers[static_cast<std::size_t>(k)]);
      blocks[b] = Moved(at, k, step);
      const Eigen::VectorXd after = ValuesOf(cost, blocks);
      blocks[b] = Moved(at, k, -step);
      const Eigen::VectorXd numeric = (after - ValuesOf(cost, blocks)) / (2.0 * step);
      blocks[b] = at;
      EXPECT_LT((numeric - analytic[b].col(k)).norm(), 1e-5 * (1.0 + numeric.norm()))
          << "block " << b << ", number " << k;
    }
  }
}

struct CostCase {
  CostCase() : session(Simulated()), model(*ModelOf(session.problem, Options())) {
    const BoardView& view = session.problem.board_views[0];
    board.numbers.resize(2 * kPoseNumbers);
    StorePose(view.cam_from_board, board.numbers.data());
    StorePose(view.lidar_from_board, board.numbers.data() + kPoseNumbers);
    board.manifold = &two;
    pose.numbers.resize(kPoseNumbers);
    StorePose(session.true_cam_from_lidar, pose.numbers.data());
    pose.manifold = &one;
  }
  static SimulatedViews Simulated() {
    ViewSimulation simulation{.seed = 5, .views = 2};
    simulation.errors = LidarErrorModel{};
    return *SimulateViews(simulation);
  }
  static JointOptions Options() {
    JointOptions options;
    options.board_size = JointBoardSize::kSides;
    options.intrinsics = 3;  // Focal lengths and centre.
    return options;
  }
  CostBlock Shared(std::size_t k) const {
    const Eigen::VectorXd& mean = model.shared[k].mean;
    return {{mean.begin(), mean.end()}, nullptr};
  }

  SimulatedViews session;
  JointModel model;
  PoseManifold one{1};
  PoseManifold two{2};
  CostBlock board;
  CostBlock pose;
};

TEST(JointCosts, PrintedPoints) {
  const CostCase of;
  const double weight = 0.7;
  ExpectItsDerivatives(PrintedCost(of.model, of.model.views[0].terms.printed[0], weight),
                       {of.board, of.Shared(of.model.shared.size() - 1)});
}

TEST(JointCosts, FaceReturns) {
  const CostCase of;
  const JointView& view = of.model.views[0];
  const std::vector<double> weights(view.terms.face.size(), 0.7);
  for (const FaceGroup& group : view.face) {
    ASSERT_EQ(group.shared.size(), 3U);
    ExpectItsDerivatives(FaceCost(view, group, weights), {of.board, {{0.01}}, {{-0.02}}, {{0.03}}});
  }
}

TEST(JointCosts, EdgeRays) {
  const CostCase of;
  const JointView& view = of.model.views[0];
  const std::vector<double> weights(view.terms.edges.size(), 0.7);
  std::vector<CostBlock> blocks = {of.board};
  for (const EdgeShift& by : view.shifts) blocks.push_back(of.Shared(by.shared));
  ASSERT_EQ(blocks.size(), 4U);
  ExpectItsDerivatives(EdgeCost(of.model, view, weights), blocks);
}

TEST(JointCosts, LinkOfASensorsPosesOfABoard) {
  const CostCase of;
  Vector6d scale;
  scale << 1.0, 2.0, 3.0, 4.0, 5.0, 6.0;
  ExpectItsDerivatives(LinkCost(0.25, scale), {of.pose, of.board});
}

TEST(JointCosts, Priors) {
  const CostCase of;
  for (const SharedBlock& block : of.model.shared) {
    const double weight = 0.7;
    ExpectItsDerivatives(PriorCost(block, weight),
                         {{{block.mean.begin(), block.mean.end()}, nullptr}});
  }
}

// r^2, J^T r and J^T J over all parameter blocks.
struct NormalEquations {
  double squares = 0.0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd matrix;
};

NormalEquations NormalOf(const ceres::CostFunction& cost, const std::vector<CostBlock>& blocks) {
  std::vector<Derivative> derivatives;
  std::vector<double*> places;
  Eigen::Index columns = 0;
  for (const CostBlock& block : blocks) {
    derivatives.emplace_back(cost.num_residuals(), std::ssize(block.numbers));
    columns += std::ssize(block.numbers);
  }
  for (Derivative& of : derivatives) places.push_back(of.data());
  Eigen::VectorXd values(cost.num_residuals());
  EXPECT_TRUE(cost.Evaluate(PointersOf(blocks).data(), values.data(), places.data()));
  Eigen::MatrixXd all(cost.num_residuals(), columns);
  Eigen::Index at = 0;
  for (const Derivative& of : derivatives) {
    all.middleCols(at, of.cols()) = of;
    at += of.cols();
  }
  return {values.squaredNorm(), all.transpose() * values, all.transpose() * all};
}

TEST(JointCosts, CondensedIsTheSameProblem) {
  const CostCase of;
  const JointView& view = of.model.views[0];
  const std::vector<double> weights(view.terms.edges.size(), 0.7);
  std::vector<CostBlock> blocks = {of.board};
  for (const EdgeShift& by : view.shifts) {
    blocks.push_back(of.Shared(by.shared));
    blocks.back().numbers[0] += 0.01;
  }
  const EdgeCost all(of.model, view, weights);
  const CondensedCost condensed(std::make_unique<EdgeCost>(of.model, view, weights), 6, 6);
  EXPECT_LT(condensed.num_residuals(), all.num_residuals());
  const NormalEquations expected = NormalOf(all, blocks);
  const NormalEquations normal = NormalOf(condensed, blocks);
  constexpr double kRounding = 1e-12;
  EXPECT_NEAR(normal.squares, expected.squares, kRounding * expected.squares);
  EXPECT_LT((normal.gradient - expected.gradient).norm(), kRounding * expected.gradient.norm());
  EXPECT_LT((normal.matrix - expected.matrix).norm(), kRounding * expected.matrix.norm());
  EXPECT_NEAR(ValuesOf(condensed, blocks).squaredNorm(), expected.squares,
              kRounding * expected.squares);
}

TEST(JointCosts, WhatIsLeftOutHasNoResidual) {
  const CostCase of;
  const JointView& view = of.model.views[0];
  const std::vector<double> weights(view.terms.edges.size(), 0.0);
  std::vector<CostBlock> blocks = {of.board};
  for (const EdgeShift& by : view.shifts) blocks.push_back(of.Shared(by.shared));
  EXPECT_EQ(ValuesOf(EdgeCost(of.model, view, weights), blocks).norm(), 0.0);
}

}  // namespace
}  // namespace sextant
