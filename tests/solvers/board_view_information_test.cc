// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/board_view_information.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <functional>

#include "eval/metrics/bounds.h"
#include "eval/synthetic/simulate_views.h"
#include "solvers/core/board_view_check.h"
#include "solvers/core/solver.h"

namespace sextant {
namespace {

SimulatedViews CheckedViews(const ViewSimulation& simulation) {
  Expected<SimulatedViews> views = SimulateViews(simulation);
  EXPECT_TRUE(views) << views.error().message;
  return *std::move(views);
}

Matrix6d InformationAtTruth(const SimulatedViews& session, const BoardView& view,
                            std::size_t index) {
  const auto information =
      InformationOfView(view, session.problem.boards.front(), *session.problem.camera,
                        session.true_cam_from_lidar, session.true_cam_from_board[index]);
  EXPECT_TRUE(information) << information.error().message;
  return *information;
}

TEST(BoardViewResiduals, AreZeroForExactData) {
  const SimulatedViews session = CheckedViews({.views = 3, .exact = true});
  for (std::size_t i = 0; i < session.problem.board_views.size(); ++i) {
    const BoardView& view = session.problem.board_views[i];
    const BoardViewResiduals residuals =
        ResidualsOf(view, session.problem.boards.front(), *session.problem.camera,
                    session.true_cam_from_lidar, session.true_cam_from_board[i]);
    EXPECT_GT(residuals.face.size(), 100U);
    EXPECT_GE(residuals.edges.size(), 8U);
    ASSERT_EQ(residuals.printed.size(), 1U);
    for (const auto* kind : {&residuals.printed, &residuals.face, &residuals.edges}) {
      for (const double value : *kind) EXPECT_LT(std::abs(value), 1e-9);
    }
  }
}

// 300 returns and more per view: the mean square of unit variance residuals has a standard error of
// sqrt(2 / n) for normal errors and sqrt(0.8 / n) for uniform ones.
TEST(BoardViewResiduals, HaveTheVarianceThatIsStated) {
  const SimulatedViews session = CheckedViews({.views = 40});
  double face = 0.0;
  double edges = 0.0;
  double printed = 0.0;
  double face_count = 0.0;
  double edge_count = 0.0;
  for (std::size_t i = 0; i < session.problem.board_views.size(); ++i) {
    const BoardViewResiduals residuals = ResidualsOf(
        session.problem.board_views[i], session.problem.boards.front(), *session.problem.camera,
        session.true_cam_from_lidar, session.true_cam_from_board[i]);
    for (const double value : residuals.face) face += value * value;
    for (const double value : residuals.edges) edges += value * value;
    printed += std::pow(residuals.printed[0], 2);
    face_count += static_cast<double>(residuals.face.size());
    edge_count += static_cast<double>(residuals.edges.size());
  }
  EXPECT_NEAR(face / face_count, 1.0, 4.0 * std::sqrt(2.0 / face_count));
  EXPECT_NEAR(edges / edge_count, 1.0, 4.0 * std::sqrt(0.8 / edge_count));
  EXPECT_NEAR(printed / 40.0, 1.0, 4.0 * std::sqrt(2.0 / (8.0 * 40.0)));
}

TEST(BoardViewInformation, GradientIsThatOfTheCost) {
  const SimulatedViews session = CheckedViews({.seed = 3, .views = 2});
  const BoardView& view = session.problem.board_views[1];
  const auto at = [&](const Vector12d& delta) {
    return InformationOfPoses(view, session.problem.boards.front(), *session.problem.camera,
                              Perturb(session.true_cam_from_lidar, delta.head<6>()),
                              Perturb(session.true_cam_from_board[1], delta.tail<6>()));
  };
  const BoardViewInformation here = *at(Vector12d::Zero());
  for (int k = 0; k < 12; ++k) {
    const double h = 1e-6;
    const BoardViewInformation up = *at(h * Vector12d::Unit(k));
    const BoardViewInformation down = *at(-h * Vector12d::Unit(k));
    const double slope = (up.cost - down.cost) / (2.0 * h);
    EXPECT_NEAR(slope, here.gradient[k], 1e-5 * here.gradient.norm()) << "unknown " << k;
  }
}

// With exact data the second derivatives of the residuals do not contribute.
TEST(BoardViewInformation, NormalMatrixIsTheHessianOfTheCostForExactData) {
  const SimulatedViews session = CheckedViews({.seed = 4, .views = 1, .exact = true});
  const BoardView& view = session.problem.board_views[0];
  const auto at = [&](const Vector12d& delta) {
    return *InformationOfPoses(view, session.problem.boards.front(), *session.problem.camera,
                               Perturb(session.true_cam_from_lidar, delta.head<6>()),
                               Perturb(session.true_cam_from_board[0], delta.tail<6>()));
  };
  const Matrix12d normal = at(Vector12d::Zero()).normal;
  Matrix12d differences;
  for (int k = 0; k < 12; ++k) {
    const double h = 1e-6;
    differences.col(k) =
        (at(h * Vector12d::Unit(k)).gradient - at(-h * Vector12d::Unit(k)).gradient) / (2.0 * h);
  }
  EXPECT_LT((differences - normal).norm(), 1e-7 * normal.norm());
}

TEST(BoardViewInformation, EliminationIsTheMarginalOfTheInverse) {
  const SimulatedViews session = CheckedViews({.seed = 5, .views = 1});
  const auto information = InformationOfPoses(
      session.problem.board_views[0], session.problem.boards.front(), *session.problem.camera,
      session.true_cam_from_lidar, session.true_cam_from_board[0]);
  const Matrix12d inverse = information->normal.inverse();
  const Matrix6d marginal = inverse.topLeftCorner<6, 6>();
  const Matrix6d covariance = EliminateBoard(information->normal).inverse();
  EXPECT_LT((covariance - marginal).norm(), 1e-8 * marginal.norm());
}

TEST(BoardViewInformation, OneSensorAloneHasNone) {
  const SimulatedViews session = CheckedViews({.seed = 6, .views = 1});
  BoardView of_camera = session.problem.board_views[0];
  of_camera.face_in_lidar.clear();
  of_camera.edges.clear();
  BoardView of_lidar = session.problem.board_views[0];
  of_lidar.printed.clear();
  const double both = InformationAtTruth(session, session.problem.board_views[0], 0).norm();
  EXPECT_LT(InformationAtTruth(session, of_camera, 0).norm(), 1e-9 * both);
  EXPECT_LT(InformationAtTruth(session, of_lidar, 0).norm(), 1e-9 * both);
}

TEST(CramerRaoBoundOfViews, FallsWithTheNumberOfViews) {
  const SimulatedViews session = CheckedViews({.seed = 7, .views = 8});
  SimulatedViews half = session;
  half.problem.board_views.resize(4);
  half.true_cam_from_board.resize(4);
  const auto of = [](const SimulatedViews& views) {
    return CramerRaoBoundOfViews(views.problem, views.true_cam_from_lidar,
                                 views.true_cam_from_board);
  };
  const auto few = of(half);
  const auto many = of(session);
  ASSERT_TRUE(few && many);
  EXPECT_LT(RmsOf(*many).translation_m, RmsOf(*few).translation_m);
  EXPECT_LT(RmsOf(*many).rotation_rad, RmsOf(*few).rotation_rad);
  CalibrationProblem none;
  const auto missing = CramerRaoBoundOfViews(none, session.true_cam_from_lidar, {});
  ASSERT_FALSE(missing);
  EXPECT_EQ(missing.error().code, ErrorCode::kMissingData);
}

struct Fault {
  const char* name;
  std::function<void(CalibrationProblem&)> make;
  ErrorCode code;
  const char* words;
};

TEST(CheckBoardViews, StatesTheFault) {
  const double nan = std::nan("");
  const std::vector<Fault> faults = {
      {"no views", [](auto& p) { p.board_views.clear(); }, ErrorCode::kMissingData, "raw views"},
      {"no camera", [](auto& p) { p.camera.reset(); }, ErrorCode::kMissingData, "intrinsics"},
      {"no board", [](auto& p) { p.boards.clear(); }, ErrorCode::kInvalidInput, "names board 0"},
      {"no size", [](auto& p) { p.boards[0].top_right_m = 0; }, ErrorCode::kInvalidInput, "sides"},
      {"twice", [](auto& p) { p.board_views.push_back(p.board_views[0]); },
       ErrorCode::kInvalidInput, "twice"},
      {"pixel", [nan](auto& p) { p.board_views[1].printed[0].pixels[2].x() = nan; },
       ErrorCode::kNonFinite, "board 0 of view 1"},
      {"count", [](auto& p) { p.board_views[0].printed[0].pixels.pop_back(); },
       ErrorCode::kInvalidInput, "4 printed points and 3 pixels"},
      {"covariance size",
       [](auto& p) {
         p.board_views[0].printed[0].covariance_px2 = Eigen::MatrixXd::Identity(6, 6);
       },
       ErrorCode::kInvalidInput, "expected 8 x 8"},
      {"covariance", [](auto& p) { p.board_views[0].printed[0].covariance_px2(0, 0) = -1.0; },
       ErrorCode::kInvalidInput, "positive definite"},
      {"face", [nan](auto& p) { p.board_views[0].face_in_lidar[5].z() = nan; },
       ErrorCode::kNonFinite, "face return"},
      {"face at the LiDAR", [](auto& p) { p.board_views[0].face_in_lidar[5].setZero(); },
       ErrorCode::kInvalidInput, "at the LiDAR"},
      {"range sigma", [](auto& p) { p.board_views[0].range_sigma_m = 0.0; },
       ErrorCode::kInvalidInput, "range sigma"},
      {"direction", [](auto& p) { p.board_views[0].edges[0].direction *= 2.0; },
       ErrorCode::kInvalidInput, "unit vector"},
      {"side", [](auto& p) { p.board_views[0].edges[0].side = 4; }, ErrorCode::kInvalidInput,
       "side 4, which board 0 does not have"},
      {"edge sigma", [](auto& p) { p.board_views[0].edges[0].sigma_m = 0.0; },
       ErrorCode::kInvalidInput, "sigma 0 m"},
      {"pose", [nan](auto& p) { p.board_views[0].cam_from_board.translation.x() = nan; },
       ErrorCode::kNonFinite, "a pose"},
  };
  const SimulatedViews session = CheckedViews({.views = 2});
  const SolverSpec spec{.name = "joint", .needs = {.board_views = 1}};
  ASSERT_TRUE(CheckProblem(session.problem, spec));
  for (const Fault& fault : faults) {
    CalibrationProblem problem = session.problem;
    fault.make(problem);
    const Expected<void> ok = CheckProblem(problem, spec);
    ASSERT_FALSE(ok) << fault.name;
    EXPECT_EQ(ok.error().code, fault.code) << fault.name << ": " << ok.error().message;
    EXPECT_NE(ok.error().message.find(fault.words), std::string::npos) << ok.error().message;
  }
}

}  // namespace
}  // namespace sextant
