// SPDX-License-Identifier: Apache-2.0
// Data that two poses explain, data that one pose explains although a solver finds two, and data
// that none explains. Right values: Levenberg-Marquardt on the pixels from many starts.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "support/make_solver.h"

namespace sextant {
namespace {

struct PixelRow {
  double u, v, x, y, z;
};

CalibrationProblem ProblemOf(double fx, double fy, double cx, double cy,
                             const std::vector<PixelRow>& rows, double scale = 1.0) {
  CalibrationProblem problem;
  Camera& camera = problem.camera.emplace();
  camera.fx_px = fx;
  camera.fy_px = fy;
  camera.cx_px = cx;
  camera.cy_px = cy;
  for (const PixelRow& row : rows) {
    Pair2d3d& pair = problem.pairs_2d3d.emplace_back();
    pair.pixel = {row.u, row.v};
    pair.point_in_lidar = scale * Eigen::Vector3d(row.x, row.y, row.z);
  }
  return problem;
}

CalibrationProblem FlatMarker(double scale = 1.0) {
  return ProblemOf(519.0, 522.0, 320.0, 240.0,
                   {{384.3331, 162.23618, -0.088, 0.088, 0.0},
                    {385.27521, 135.21503, -0.088, -0.088, 0.0},
                    {409.36746, 139.30315, 0.088, -0.088, 0.0},
                    {407.43854, 165.64435, 0.088, 0.088, 0.0}},
                   scale);
}

CalibrationProblem TwoMarkers() {
  return ProblemOf(401.0513916015625, 401.064453125, 326.7859191894531, 206.62399291992188,
                   {{197.0, 202.0, -0.2, -0.02, 1.0},
                    {212.0, 202.0, -0.16, -0.02, 1.0},
                    {212.0, 218.0, -0.16, 0.02, 1.0},
                    {197.0, 218.0, -0.2, 0.02, 1.0},
                    {285.0, 204.0, 0.16, -0.02, 1.0},
                    {301.0, 204.0, 0.2, -0.02, 1.0},
                    {301.0, 220.0, 0.2, 0.02, 1.0},
                    {285.0, 220.0, 0.16, 0.02, 1.0}});
}

CalibrationProblem LongLens() {
  return ProblemOf(12396.8, 12396.8, 1280.0, 960.0,
                   {{1393.44, 953.2, 1.98017, 13.7966, -1.97846},
                    {1621.67, 1023.33, 6.98866, 11.3999, -7.39016},
                    {1360.64, 1015.75, 3.62744, 11.5429, 0.310433}});
}

CalibrationProblem PointsBesideTheCamera() {
  const double a = 0.07473859190940857;
  return ProblemOf(1.0, 1.0, 0.0, 0.0,
                   {{-11.53961181640625, -10.31392955780029, -a, a, 0.0},
                    {-9.84475326538086, -8.958239555358887, a, a, 0.0},
                    {-322.693115234375, -406.5050659179688, a, -a, 0.0},
                    {-250.9387664794922, -295.6614990234375, -a, -a, 0.0}});
}

CalibrationProblem TinyFocalLength() {
  return ProblemOf(8.5, 8.5, 0.0, 0.0,
                   {{-1.2094, 1.9775, 0.0, 0.0, 0.0},
                    {-1.1058, 2.4848, 0.41, 45.8, 0.0},
                    {-0.7222, 1.8587, 45.26, 0.04, 0.0},
                    {-0.6125, 2.3564, 45.61, 45.95, 0.0}});
}

CalibrationProblem TiltedBoard() {
  return ProblemOf(800.0, 800.0, 640.0, 360.0,
                   {{690.6633370680253, 244.03336143664717, 0.10649643532668149, -1.873894449117018,
                     0.09086554941995519},
                    {930.909225651966, 342.9423260379773, -0.12001528647798475, -1.4787179319863037,
                     0.4814138309339367},
                    {802.8617010727826, 564.4527117515029, -0.507689355044133, -1.4751405695251525,
                     0.25294935002018293},
                    {590.2811372813518, 417.97598805386417, -0.2811776332394669,
                     -1.8703170866558665, -0.13759893149379865}});
}

CalibrationProblem MirroredFive() {
  return ProblemOf(1.0, 1.0, 0.0, 0.0,
                   {{0.0, 0.0, 10.0, 0.0, 0.0},
                    {0.0, 1.0, 4.0, 3.0, 0.0},
                    {1.0, 0.0, 4.0, 0.0, 3.0},
                    {0.0, 2.0, 3.0, 4.0, 0.0},
                    {2.0, 0.0, 3.0, 0.0, 4.0}});
}

CalibrationProblem NoInformation() {
  return ProblemOf(600.0, 600.0, 320.0, 240.0,
                   {{167.0, 117.0, -0.3390885, 3.573442, -0.568522},
                    {206.0, 116.0, -0.7454906, 3.477403, -0.311146},
                    {208.0, 145.0, -0.364554, 3.591593, -0.443259},
                    {169.0, 148.0, -0.2483596, 3.59366, -0.315155},
                    {174.0, 124.0, -0.1818541, 3.716697, -0.723318},
                    {199.0, 122.0, -0.6471004, 3.651254, -0.455303},
                    {174.0, 131.0, -0.8174115, 3.61537, -0.720495},
                    {200.0, 131.0, -0.7178828, 3.770423, -0.607904}});
}

SolveReport Answer(const std::string& spec, const CalibrationProblem& problem) {
  Expected<SolveReport> report = test::MakeSolver(spec)->Solve(problem);
  EXPECT_TRUE(report) << spec << ": " << report.error().message;
  return report ? *std::move(report) : SolveReport{};
}

double Rmse(const CalibrationProblem& problem, const Rigid3d& pose) {
  return Evaluate(problem, pose).rmse_px.value_or(-1.0);
}

void ExpectTranslation(const Rigid3d& pose, const Eigen::Vector3d& expected, double tolerance) {
  EXPECT_LT((pose.translation - expected).norm(), tolerance) << pose.translation.transpose();
}

// Two minima of 0.274 and 0.362 px, 62.84 deg apart. Closed forms are near the first, not in it.
TEST(TwoPoses, OfASmallFlatMarkerAreBothReportedByEverySolver) {
  const CalibrationProblem problem = FlatMarker();
  for (const char* spec :
       {"ippe", "sqpnp", "epnp", "p3p", "refine(sqpnp)", "refine(p3p)", "refine(ippe)",
        "refine(epnp)", "average(ippe)", "refine(average(p3p))", "average(refine(sqpnp))"}) {
    const SolveReport report = Answer(spec, problem);
    ASSERT_EQ(report.alternatives.size(), 1U) << spec;
    EXPECT_NEAR(Rmse(problem, report.alternatives[0]), 0.362, 1e-3) << spec;
    EXPECT_NEAR(RotationDistance(report.cam_from_lidar.rotation, report.alternatives[0].rotation),
                62.84 * 3.14159 / 180.0, 0.1)
        << spec;
  }
  for (const char* spec : {"refine(sqpnp)", "refine(p3p)", "refine(epnp)"}) {
    EXPECT_NEAR(*Answer(spec, problem).evaluation.rmse_px, 0.274, 1e-3) << spec;
  }
}

TEST(TwoPoses, DoNotDependOnTheUnit) {
  const SolveReport in_m = Answer("refine(sqpnp)", FlatMarker());
  const SolveReport in_mm = Answer("refine(sqpnp)", FlatMarker(1000.0));
  ASSERT_EQ(in_mm.alternatives.size(), 1U);
  EXPECT_LT(RotationDistance(in_mm.alternatives[0].rotation, in_m.alternatives[0].rotation), 1e-6);
  ExpectTranslation(in_mm.alternatives[0], 1000.0 * in_m.alternatives[0].translation, 1e-3);
}

TEST(TwoPoses, OfTwoMarkersInALine) {
  for (const char* spec : {"refine(p3p)", "refine(sqpnp)", "refine(epnp)"}) {
    const SolveReport report = Answer(spec, TwoMarkers());
    ExpectTranslation(report.cam_from_lidar, {-0.850, 0.017, 0.283}, 2e-3);
    EXPECT_NEAR(*report.evaluation.rmse_px, 2.966, 1e-3);
    ASSERT_EQ(report.alternatives.size(), 1U) << spec;
    ExpectTranslation(report.alternatives[0], {0.657, -0.009, 0.592}, 2e-3);
    EXPECT_NEAR(Rmse(TwoMarkers(), report.alternatives[0]), 3.329, 1e-3);
  }
  for (const char* spec : {"sqpnp", "epnp", "p3p", "ippe"}) {
    EXPECT_EQ(Answer(spec, TwoMarkers()).alternatives.size(), 1U) << spec;
  }
}

TEST(TwoPoses, OfThreePointsAreBothExact) {
  for (const char* spec : {"p3p", "sqpnp", "refine(p3p)", "refine(sqpnp)"}) {
    const SolveReport report = Answer(spec, LongLens());
    ASSERT_EQ(report.alternatives.size(), 1U) << spec;
    Rigid3d near = report.cam_from_lidar;
    Rigid3d far = report.alternatives[0];
    if (near.translation.z() > far.translation.z()) std::swap(near, far);
    ExpectTranslation(near, {0.926, 13.580, 395.314}, 2e-3);
    ExpectTranslation(far, {3.484, -3.479, 406.500}, 2e-3);
    EXPECT_LT(Rmse(LongLens(), near), 1e-6);
    EXPECT_LT(Rmse(LongLens(), far), 1e-6);
  }
}

TEST(TwoPoses, OfACameraWhoseUnitIsNotThePixel) {
  const SolveReport report = Answer("refine(sqpnp)", TinyFocalLength());
  EXPECT_NEAR(*report.evaluation.rmse_px, 0.001728, 1e-6);
  ASSERT_EQ(report.alternatives.size(), 1U);
  EXPECT_NEAR(Rmse(TinyFocalLength(), report.alternatives[0]), 0.001746, 1e-6);
}

TEST(OnePose, HasNoAlternativeBehindTheCamera) {
  for (const char* spec : {"ippe", "sqpnp", "p3p", "refine(ippe)", "refine(p3p)"}) {
    const SolveReport report = Answer(spec, PointsBesideTheCamera());
    ExpectTranslation(report.cam_from_lidar, {-0.628101, -0.657845, 0.032405}, 2e-6);
    EXPECT_TRUE(report.alternatives.empty()) << spec;
  }
}

// The second minimum leaves 20.6 px, the first 0.047.
TEST(OnePose, HasNoAlternativeThatFitsFarWorse) {
  for (const char* spec : {"ippe", "sqpnp", "epnp", "p3p", "refine(ippe)"}) {
    const SolveReport report = Answer(spec, TiltedBoard());
    EXPECT_TRUE(report.alternatives.empty()) << spec;
  }
}

TEST(NoPose, IsRefusedByEverySolverForTheSameReason) {
  for (const char* spec :
       {"sqpnp", "epnp", "p3p", "refine(epnp)", "refine(p3p)", "average(epnp)"}) {
    const Expected<SolveReport> mirrored = test::MakeSolver(spec)->Solve(MirroredFive());
    ASSERT_FALSE(mirrored) << spec;
    EXPECT_EQ(mirrored.error().code, ErrorCode::kMirrored) << spec;
    const Expected<SolveReport> unexplained = test::MakeSolver(spec)->Solve(NoInformation());
    ASSERT_FALSE(unexplained) << spec;
    EXPECT_EQ(unexplained.error().code, ErrorCode::kNoConsensus) << spec;
  }
}

// One pose fits four of the pairs, another the other four, and neither more.
TEST(Rivals, AreTwoSetsOfPairsThatContradictEachOther) {
  const std::vector<Eigen::Vector3d> board = {
      {0.0, 0.0, 2.0}, {0.4, 0.1, 2.1}, {0.3, 0.5, 1.9}, {-0.1, 0.4, 2.2}};
  const Rigid3d first{ExpSo3({0.1, -0.2, 0.3}), {0.1, 0.2, 0.3}};
  const Rigid3d second{ExpSo3({0.15, -0.25, 0.2}), {0.4, 0.1, 0.2}};
  CalibrationProblem problem;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d shift(i < 4 ? -0.8 : 0.8, 0.02 * i, 0.01 * (i % 3));
    Pair3d3d pair;
    pair.point_in_lidar = board[static_cast<std::size_t>(i % 4)] + shift;
    pair.point_in_cam = (i < 4 ? first : second) * pair.point_in_lidar;
    pair.point_in_cam.x() += 0.004 * (i % 2);
    pair.sigma_m = 0.01;
    problem.pairs_3d3d.push_back(pair);
  }
  for (const char* spec : {"ransac(kabsch)", "robust(kabsch)", "clique(kabsch)",
                           "refine(robust(kabsch))", "drop_worst(kabsch,keep=4)"}) {
    const SolveReport report = Answer(spec, problem);
    ASSERT_EQ(report.inliers.size(), 4U) << spec;
    ASSERT_EQ(report.alternatives.size(), 1U) << spec;
    const Rigid3d& other = report.inliers[0] == 0 ? second : first;
    EXPECT_LT(DistanceBetween(report.alternatives[0], other).rotation_rad, 0.02) << spec;
  }
}

}  // namespace
}  // namespace sextant
