// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/pair_diagnostics.h"

#include <gmock/gmock.h>

#include <algorithm>

#include "eval/synthetic/random_scene.h"
#include "eval/synthetic/simulate_pairs.h"
#include "geometry/symmetric.h"

namespace sextant {
namespace {

using testing::HasSubstr;

CalibrationProblem CleanProblem(int views) {
  PairSimulation simulation;
  simulation.views = views;
  simulation.outliers = 0;
  return SimulatePairs(simulation)->problem;
}

void RotateLabels(CalibrationProblem& problem, int view, int board, int turns) {
  std::vector<Pair3d3d>& pairs = problem.pairs_3d3d;
  const auto first = std::find_if(pairs.begin(), pairs.end(), [&](const Pair3d3d& p) {
    return p.id.view == view && p.id.board == board;
  });
  std::vector<Eigen::Vector3d> lidar;
  for (auto it = first; it != first + 4; ++it) lidar.push_back(it->point_in_lidar);
  std::rotate(lidar.begin(), lidar.begin() + turns, lidar.end());
  for (int i = 0; i < 4; ++i) (first + i)->point_in_lidar = lidar[static_cast<std::size_t>(i)];
}

TEST(PairDiagnostics, ReportsNothingForGoodData) {
  const PairDiagnostics diagnostics = DiagnosePairs(CleanProblem(3));
  EXPECT_FALSE(diagnostics.order.better);
  EXPECT_THAT(diagnostics.order.rivals, testing::IsEmpty());
  EXPECT_FALSE(diagnostics.mirrored_rmse_m);
  EXPECT_THAT(diagnostics.edges, testing::IsEmpty());
}

// There the error of the rotation moves the translation by kilometres.
TEST(PairDiagnostics, AFarOriginIsNoWeakTranslation) {
  CalibrationProblem problem = CleanProblem(2);
  EXPECT_TRUE(DiagnosePairs(problem).weak_translation);
  for (Pair3d3d& pair : problem.pairs_3d3d) pair.point_in_lidar += Eigen::Vector3d(4e5, 6e6, 3e2);
  EXPECT_THAT(Describe(DiagnosePairs(problem)), testing::IsEmpty());
}

TEST(PairDiagnostics, FindsRotatedLabelsOfOneBoard) {
  for (int turns = 1; turns < 4; ++turns) {
    const CalibrationProblem truth = CleanProblem(1);
    CalibrationProblem problem = truth;
    RotateLabels(problem, 0, 1, turns);
    const PairDiagnostics diagnostics = DiagnosePairs(problem);
    ASSERT_TRUE(diagnostics.order.better);
    EXPECT_FALSE(diagnostics.order.better->boards_swapped);
    EXPECT_EQ(diagnostics.order.better->moved.size(), 4U);
    EXPECT_LT(diagnostics.order.better->rmse, 0.03);
    const CalibrationProblem reordered = Reordered(problem, *diagnostics.order.better);
    for (std::size_t i = 0; i < truth.pairs_3d3d.size(); ++i) {
      EXPECT_EQ(reordered.pairs_3d3d[i].point_in_lidar, truth.pairs_3d3d[i].point_in_lidar);
    }
    EXPECT_THAT(Describe(diagnostics).front(), HasSubstr("--reorder uses it"));
  }
}

TEST(PairDiagnostics, FindsSwappedBoardsAndReversedOrders) {
  const CalibrationProblem truth = CleanProblem(2);
  CalibrationProblem problem = truth;
  std::vector<Pair3d3d>& pairs = problem.pairs_3d3d;
  for (std::size_t i = 0; i < 4; ++i)
    std::swap(pairs[i].point_in_lidar, pairs[i + 4].point_in_lidar);
  std::swap(pairs[9].point_in_lidar, pairs[11].point_in_lidar);
  const PairDiagnostics diagnostics = DiagnosePairs(problem);
  ASSERT_TRUE(diagnostics.order.better);
  EXPECT_TRUE(diagnostics.order.better->boards_swapped);
  const CalibrationProblem reordered = Reordered(problem, *diagnostics.order.better);
  for (std::size_t i = 0; i < truth.pairs_3d3d.size(); ++i) {
    EXPECT_EQ(reordered.pairs_3d3d[i].point_in_lidar, truth.pairs_3d3d[i].point_in_lidar);
  }
}

TEST(PairDiagnostics, ReportsTheBoardWithInconsistentEdges) {
  CalibrationProblem problem = CleanProblem(2);
  problem.pairs_3d3d[13].point_in_lidar.z() += 0.3;
  const PairDiagnostics diagnostics = DiagnosePairs(problem);
  ASSERT_EQ(diagnostics.edges.size(), 1U);
  EXPECT_EQ(diagnostics.edges[0].view, 1);
  EXPECT_EQ(diagnostics.edges[0].board, 1);
  EXPECT_THAT(Describe(diagnostics), testing::Contains(HasSubstr("board 1 of view 1")));
}

// Forty edges each, with a stated noise of a tenth of their length: in a scene in a hundred may one
// of them exceed the limit.
TEST(PairDiagnostics, ReportsHardlyAnyEdgeForNoiseAlone) {
  constexpr std::uint64_t kScenes = 100;
  int reported = 0;
  for (std::uint64_t seed = 1; seed <= kScenes; ++seed) {
    Random random(DeriveSeed(1, "edges", 0, seed));
    RandomScene scene = MakeRandomScene({.pairs = 40, .sigma_m = 0.05, .on_boards = true}, random);
    scene.problem.pairs_2d3d.clear();
    reported += DiagnosePairs(scene.problem).edges.empty() ? 0 : 1;
  }
  EXPECT_LE(reported, 3);
}

TEST(PairDiagnostics, ReportsANominalSizeThatDisagreesWithBothSensors) {
  CalibrationProblem problem = CleanProblem(1);
  problem.boards[0].top_right_m = 0.60;
  const PairDiagnostics diagnostics = DiagnosePairs(problem);
  ASSERT_FALSE(diagnostics.edges.empty()) << testing::PrintToString(Describe(diagnostics));
  EXPECT_EQ(diagnostics.edges[0].board, 0);
  EXPECT_EQ(diagnostics.edges[0].known_m, 0.60);
}

TEST(PairDiagnostics, ReportsTheWeakRotationOfAlmostCollinearPoints) {
  CalibrationProblem problem = CleanProblem(1);
  const Rigid3d truth = SimulatePairs({.seed = 1, .outliers = 0})->true_cam_from_lidar;
  for (Pair3d3d& pair : problem.pairs_3d3d) {
    pair.point_in_cam = Eigen::Vector3d(pair.point_in_cam.x() * 4.0, 0.02 * pair.id.corner,
                                        2.0 + 0.01 * (pair.id.corner % 2));
    pair.point_in_lidar = truth.Inverse() * pair.point_in_cam;
    pair.point_in_cam.z() += 1e-3 * (pair.id.corner - 1.5);
  }
  const PairDiagnostics diagnostics = DiagnosePairs(problem);
  ASSERT_TRUE(diagnostics.weak_rotation) << testing::PrintToString(Describe(diagnostics));
  EXPECT_GT(std::abs(diagnostics.weak_rotation->axis_in_cam.x()), 0.99);
  EXPECT_THAT(Describe(diagnostics), testing::Contains(HasSubstr("rotation about")));
}

TEST(SimulatePairs, TheSameSeedGivesTheSameBytes) {
  const SimulatedSession a = *SimulatePairs({.seed = 3, .views = 2});
  const SimulatedSession b = *SimulatePairs({.seed = 3, .views = 2});
  const SimulatedSession c = *SimulatePairs({.seed = 4, .views = 2});
  for (std::size_t i = 0; i < a.problem.pairs_3d3d.size(); ++i) {
    EXPECT_EQ(a.problem.pairs_3d3d[i].point_in_lidar, b.problem.pairs_3d3d[i].point_in_lidar);
    EXPECT_NE(a.problem.pairs_3d3d[i].point_in_lidar, c.problem.pairs_3d3d[i].point_in_lidar);
  }
}

TEST(SimulatePairs, ResidualsUnderTheTruthHaveTheStatedCovariance) {
  const SimulatedSession session = *SimulatePairs({.seed = 5, .views = 250, .outliers = 0});
  double chi2 = 0.0;
  for (const Pair3d3d& pair : session.problem.pairs_3d3d) {
    const Eigen::Vector3d r = pair.point_in_cam - session.true_cam_from_lidar * pair.point_in_lidar;
    chi2 += SquaredMahalanobis(r, *pair.covariance_in_cam);
  }
  const double freedom = 3.0 * static_cast<double>(session.problem.pairs_3d3d.size());
  EXPECT_NEAR(chi2 / freedom, 1.0, 5.0 * std::sqrt(2.0 / freedom));
}

TEST(SimulatePairs, CornersRunClockwiseFromTheTop) {
  const SimulatedSession session = *SimulatePairs({.seed = 6, .views = 20, .outliers = 0});
  const std::vector<Pair3d3d>& pairs = session.problem.pairs_3d3d;
  for (std::size_t i = 0; i < pairs.size(); i += 4) {
    EXPECT_LT(pairs[i].point_in_cam.y(), pairs[i + 2].point_in_cam.y());      // top above bottom
    EXPECT_GT(pairs[i + 1].point_in_cam.x(), pairs[i + 3].point_in_cam.x());  // right of left
  }
}

TEST(SimulatePairs, RejectsInvalidOptions) {
  EXPECT_EQ(SimulatePairs({.views = 0}).error().code, ErrorCode::kInvalidOption);
  EXPECT_EQ(SimulatePairs({.outliers = 9}).error().code, ErrorCode::kInvalidOption);
  EXPECT_EQ(SimulatePairs({.lidar_sigma_m = -1.0}).error().code, ErrorCode::kInvalidOption);
}

}  // namespace
}  // namespace sextant
