// SPDX-License-Identifier: Apache-2.0
#include <ceres/ceres.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/random.h"
#include "eval/metrics/bounds.h"
#include "eval/synthetic/simulate_views.h"
#include "geometry/symmetric.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "solvers/joint/board_view_residuals.h"
#include "solvers/joint/joint_contradiction.h"
#include "solvers/joint/joint_noise.h"
#include "solvers/refine/rotation_manifold.h"

namespace sextant {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

// Many sessions have a third of the returns of the default. What the tests of errors are about, the
// offsets of rings and of views, is as large for few returns.
constexpr double kCoarseAzimuth_deg = 0.6;

SimulatedViews Views(const ViewSimulation& simulation) { return SimulateViews(simulation).value(); }

Expected<SolveReport> Solve(const CalibrationProblem& problem, const char* spec) {
  return (*BuiltinSolvers().Make(spec))->Solve(problem);
}

/// Error in units of the bound of the raw data; the square has a mean of 6.
double ErrorInSigmas(const SimulatedViews& session, const Rigid3d& cam_from_lidar) {
  const Matrix6d bound = *CramerRaoBoundOfViews(session.problem, session.true_cam_from_lidar,
                                                session.true_cam_from_board);
  const Vector6d error = PoseDifference(cam_from_lidar, session.true_cam_from_lidar);
  return std::sqrt(SquaredMahalanobis(error, bound));
}

// The root of the 1 - 1e-6 quantile of chi-square with 6 degrees of freedom, 38.3.
constexpr double kFarOff = 6.2;

/// All whitened residuals of one view under two poses, for an independent solver (Ceres).
struct ViewCost {
  const BoardView& view;
  const CalibrationProblem& problem;

  bool operator()(const double* q, const double* t, const double* board_q, const double* board_t,
                  double* out) const {
    const Rigid3d cam_from_lidar{Eigen::Quaterniond(q), Eigen::Map<const Eigen::Vector3d>(t)};
    const Rigid3d cam_from_board{Eigen::Quaterniond(board_q),
                                 Eigen::Map<const Eigen::Vector3d>(board_t)};
    const BoardViewTerms terms = TermsOf(view, problem.boards.front());
    PrintedResidual printed;
    if (!Differentiate(terms.printed.front(), *problem.camera, cam_from_board, printed))
      return false;
    for (const double value : printed.value) *out++ = value;
    const BoardPlane plane(cam_from_lidar.Inverse() * cam_from_board);
    RayResidual ray;
    for (const FaceTerm& term : terms.face) {
      if (!Differentiate(term, plane, ray)) return false;
      *out++ = ray.value;
    }
    for (const EdgeTerm& term : terms.edges) {
      if (!Differentiate(term, plane, ray)) return false;
      *out++ = ray.value;
    }
    return true;
  }
};

struct CeresAnswer {
  Rigid3d cam_from_lidar;
  Matrix6d covariance;
};

CeresAnswer SolveWithCeres(const SimulatedViews& session) {
  CeresAnswer answer{session.true_cam_from_lidar, {}};
  std::vector<Rigid3d> boards = session.true_cam_from_board;
  ceres::Problem problem;
  double* q = answer.cam_from_lidar.rotation.coeffs().data();
  double* t = answer.cam_from_lidar.translation.data();
  for (std::size_t i = 0; i < boards.size(); ++i) {
    const BoardView& view = session.problem.board_views[i];
    using Cost =
        ceres::NumericDiffCostFunction<ViewCost, ceres::CENTRAL, ceres::DYNAMIC, 4, 3, 4, 3>;
    const auto residuals = static_cast<int>(8 + view.face_in_lidar.size() + view.edges.size());
    double* board_q = boards[i].rotation.coeffs().data();
    problem.AddResidualBlock(
        new Cost(new ViewCost{view, session.problem}, ceres::TAKE_OWNERSHIP, residuals), nullptr, q,
        t, board_q, boards[i].translation.data());
    problem.SetManifold(board_q, new RotationManifold);
  }
  problem.SetManifold(q, new RotationManifold);
  ceres::Solver::Options options;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-16;
  options.parameter_tolerance = 1e-12;
  options.gradient_tolerance = 1e-12;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  ceres::Covariance covariance({});
  const std::vector<const double*> blocks = {q, t};
  EXPECT_TRUE(covariance.Compute(blocks, &problem));
  Eigen::Matrix<double, 6, 6, Eigen::RowMajor> matrix;
  covariance.GetCovarianceMatrixInTangentSpace(blocks, matrix.data());
  answer.covariance = matrix;
  return answer;
}

TEST(Joint, FindsTheMinimumAndCovarianceThatCeresFinds) {
  const SimulatedViews session = Views({.seed = 11, .views = 3});
  const CeresAnswer expected = SolveWithCeres(session);
  const auto report =
      Solve(session.problem,
            "joint(kabsch,pixel_loss=none,face_loss=none,edge_loss=none,cut=0,noise=stated)");
  ASSERT_TRUE(report) << report.error().message;
  const Vector6d difference = PoseDifference(report->cam_from_lidar, expected.cam_from_lidar);
  EXPECT_LT(difference.norm(), 1e-7);
  EXPECT_LT((*report->covariance - expected.covariance).norm(), 1e-4 * expected.covariance.norm());
}

TEST(Joint, ReportsItsObservationsAndInliers) {
  const SimulatedViews session = Views({.seed = 12, .views = 5});
  const auto report = Solve(session.problem, "joint(kabsch)");
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_THAT(report->warnings, IsEmpty());
  EXPECT_EQ(report->inliers.size(), 20U);
  ASSERT_EQ(report->board_views.size(), 5U);
  for (std::size_t i = 0; i < 5; ++i) {
    const BoardViewFit& fit = report->board_views[i];
    EXPECT_TRUE(fit.used);
    EXPECT_EQ(fit.view, static_cast<int>(i));
    EXPECT_EQ(fit.printed.used, 1);
    EXPECT_EQ(fit.face.of, static_cast<int>(session.problem.board_views[i].face_in_lidar.size()));
    EXPECT_GT(fit.face.used, fit.face.of - 5);
    EXPECT_NEAR(fit.rms, 1.0, 0.25);
    const PoseDistance off = DistanceBetween(fit.cam_from_board, session.true_cam_from_board[i]);
    EXPECT_LT(off.translation_m, 0.02);
  }
}

// A third of the edges assigned to a wrong side, a fifth of the face returns from an object in
// front of or behind the board.
TEST(Joint, ResistsMislabelledEdgesAndReturnsOfOtherObjects) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SimulatedViews session = Views({.seed = seed, .views = 6});
    Random random(seed);
    for (BoardView& view : session.problem.board_views) {
      for (EdgeRay& ray : view.edges) {
        if (random.Uniform() < 0.33)
          ray.side = (ray.side + 1 + static_cast<int>(random.Below(3))) % 4;
      }
      for (Eigen::Vector3d& point : view.face_in_lidar) {
        if (random.Uniform() < 0.2) point *= random.Uniform(0.7, 1.5);
      }
    }
    const auto report = Solve(session.problem, "joint(kabsch)");
    ASSERT_TRUE(report) << "seed " << seed << ": " << report.error().message;
    EXPECT_LT(ErrorInSigmas(session, report->cam_from_lidar), 1.5 * kFarOff) << "seed " << seed;
  }
}

// The board moved between image and scan in one of the views.
TEST(Joint, DropsAViewThatContradictsTheOthersAndNamesIt) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SimulatedViews session = Views({.seed = seed, .views = 6});
    const Rigid3d moved{ExpSo3({0.0, 0.0, 0.1}), {0.1, -0.05, 0.08}};
    BoardView& view = session.problem.board_views[3];
    for (Eigen::Vector3d& point : view.face_in_lidar) point = moved * point;
    for (EdgeRay& ray : view.edges) {
      // The intersection of the ray with the board, moved along.
      const BoardPlane plane(session.true_cam_from_lidar.Inverse() *
                             session.true_cam_from_board[3]);
      const double distance =
          plane.axes.col(2).dot(plane.origin) / plane.axes.col(2).dot(ray.direction);
      ray.direction = (moved * (distance * ray.direction)).normalized();
    }
    view.lidar_from_board = moved * view.lidar_from_board;
    const auto report = Solve(session.problem, "joint(kabsch)");
    ASSERT_TRUE(report) << "seed " << seed << ": " << report.error().message;
    EXPECT_FALSE(report->board_views[3].used) << "seed " << seed;
    EXPECT_THAT(report->warnings, Contains(HasSubstr("board 0 of view 3 was left out")));
    for (const int i : report->inliers) {
      EXPECT_NE(session.problem.pairs_3d3d[static_cast<std::size_t>(i)].id.view, 3);
    }
    EXPECT_LT(ErrorInSigmas(session, report->cam_from_lidar), 1.5 * kFarOff) << "seed " << seed;
  }
}

// Blur shifts all points of one photo, more than the others', but shows nothing wrong.
TEST(Joint, KeepsAViewWhosePhotoIsNoisierThanTheOthers) {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    SimulatedViews session = Views({.seed = seed, .views = 6});
    Random random(seed);
    BoardView& view = session.problem.board_views[2];
    const double sigma_px = 2.0 * std::sqrt(view.printed.front().covariance_px2(0, 0));
    for (Eigen::Vector2d& pixel : view.printed.front().pixels) {
      pixel += sigma_px * Eigen::Vector2d(random.Normal(), random.Normal());
    }
    const auto report = Solve(session.problem, "joint(kabsch)");
    ASSERT_TRUE(report) << "seed " << seed << ": " << report.error().message;
    EXPECT_TRUE(report->board_views[2].used) << "seed " << seed;
  }
}

TEST(Joint, DropsAViewOfOneSensor) {
  SimulatedViews session = Views({.seed = 13, .views = 4});
  session.problem.board_views[1].printed.clear();
  const auto report = Solve(session.problem, "joint(kabsch)");
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_FALSE(report->board_views[1].used);
  EXPECT_THAT(report->warnings, Contains(HasSubstr("only one of the sensors")));
}

TEST(Joint, ReportsThatTheNoiseIsLargerThanStated) {
  SimulatedViews session = Views({.seed = 14, .views = 20});
  for (BoardView& view : session.problem.board_views) view.range_sigma_m *= 0.4;
  for (const char* spec : {"joint(kabsch)", "joint(kabsch,cut=0)"}) {
    const auto report = Solve(session.problem, spec);
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_THAT(report->warnings, Contains(HasSubstr("noise of the ranges on the boards is 2.5")))
        << spec;
  }
}

// The level of the links is not estimated where nothing can be compared, as with a single view.
TEST(Joint, ContradictionOfNoViewsIsAsExpected) {
  EXPECT_EQ(ContradictionScale({}), 1.0);
  EXPECT_EQ(WithMedianShift({ViewSums{}}, {.out_of_plane_m = 0.01}).out_of_plane_m, 0.01);
}

// Named estimate within five of its own sigmas.
void ExpectEstimated(const std::vector<EstimatedNumber>& numbers, const std::string& name,
                     double truth) {
  for (const EstimatedNumber& number : numbers) {
    if (number.name != name) continue;
    ASSERT_TRUE(number.sigma);
    EXPECT_NEAR(number.value, truth, 5.0 * *number.sigma) << name;
    return;
  }
  ADD_FAILURE() << name << " was not estimated";
}

TEST(Joint, EstimatesTheRangeBias) {
  SimulatedViews session = Views({.seed = 15, .views = 12});
  for (BoardView& view : session.problem.board_views) {
    for (Eigen::Vector3d& point : view.face_in_lidar) point += 0.04 * point.normalized();
  }
  const auto plain = Solve(session.problem, "joint(kabsch)");
  const auto report = Solve(session.problem, "joint(kabsch,range_bias=true)");
  ASSERT_TRUE(plain && report);
  ExpectEstimated(report->extras, "range_bias_m", 0.04);
  EXPECT_LT(*report->extras.front().sigma, 0.02);
  EXPECT_LT((report->cam_from_lidar.translation - session.true_cam_from_lidar.translation).norm(),
            0.02);
  EXPECT_THAT(report->warnings, IsEmpty());
}

TEST(Joint, EstimatesTheSizeOfTheBoard) {
  SimulatedViews session = Views({.seed = 16, .views = 12});
  const auto exact = Solve(session.problem, "joint(kabsch)");
  session.problem.boards[0].top_right_m = 0.49;  // 0.5 in truth.
  session.problem.boards[0].right_bottom_m = 0.52;
  const auto sides = Solve(session.problem, "joint(kabsch,board_size=sides)");
  ASSERT_TRUE(exact && sides) << sides.error().message;
  ExpectEstimated(sides->extras, "board_0_top_right_m", 0.5);
  ExpectEstimated(sides->extras, "board_0_right_bottom_m", 0.5);
  session.problem.boards[0].top_right_m = 0.51;
  session.problem.boards[0].right_bottom_m = 0.51;
  const auto scale = Solve(session.problem, "joint(kabsch,board_size=scale)");
  ASSERT_TRUE(scale) << scale.error().message;
  ExpectEstimated(scale->extras, "board_scale", 0.5 / 0.51);
  EXPECT_LT(*scale->extras.front().sigma, 0.002);
}

TEST(Joint, EstimatesIntrinsics) {
  SimulatedViews session = Views({.seed = 17, .views = 30});
  session.problem.camera->fx_px = 690.0;  // 700 in truth.
  session.problem.camera->fy_px = 708.0;
  const auto report = Solve(session.problem, "joint(kabsch,intrinsics=focal+center)");
  ASSERT_TRUE(report) << report.error().message;
  ASSERT_TRUE(report->camera);
  ExpectEstimated(report->camera->estimated, "fx_px", 700.0);
  ExpectEstimated(report->camera->estimated, "fy_px", 700.0);
  ExpectEstimated(report->camera->estimated, "cx_px", 639.5);
}

const EstimatedNumber* Find(const std::vector<EstimatedNumber>& numbers, const std::string& name) {
  for (const EstimatedNumber& number : numbers) {
    if (number.name == name) return &number;
  }
  return nullptr;
}

TEST(Joint, UnobservableParametersStayAtTheirPrior) {
  // With poorly determined sides, the range alone determines the distance of the board.
  SimulatedViews session = Views({.seed = 18, .views = 1});
  for (EdgeRay& ray : session.problem.board_views[0].edges) ray.sigma_m = 0.2;
  const auto plain = Solve(session.problem, "joint(kabsch,noise=stated)");
  const auto report = Solve(session.problem, "joint(kabsch,range_bias=true,noise=stated)");
  ASSERT_TRUE(plain && report) << report.error().message;
  const EstimatedNumber* bias = Find(report->extras, "range_bias_m");
  ASSERT_NE(bias, nullptr);
  EXPECT_NEAR(*bias->sigma, 0.1, 0.02);
  EXPECT_NEAR(bias->value, 0.0, 0.05);
  EXPECT_GT((*report->covariance).trace(), (*plain->covariance).trace());
}

TEST(Joint, IgnoresRingNumbersOfASensorWithoutOffsets) {
  SimulatedViews session = Views({.seed = 19, .views = 5});
  const auto with = Solve(session.problem, "joint(kabsch)");
  for (BoardView& view : session.problem.board_views) view.face_rings.clear();
  const auto without = Solve(session.problem, "joint(kabsch)");
  ASSERT_TRUE(with && without);
  EXPECT_LT(PoseDifference(with->cam_from_lidar, without->cam_from_lidar).norm(), 1e-8);
}

// The limit of narrow priors is the answer of a sensor without systematic errors.
TEST(Joint, NarrowPriorsGiveTheAnswerOfWhiteNoise) {
  SimulatedViews session = Views({.seed = 20, .views = 5});
  const auto white = Solve(session.problem, "joint(kabsch,noise=stated)");
  session.problem.lidar_errors = {1e-7, 1e-7, 1e-7, 1e-7};
  const auto narrow = Solve(session.problem, "joint(kabsch,noise=stated)");
  ASSERT_TRUE(white && narrow);
  EXPECT_LT(PoseDifference(white->cam_from_lidar, narrow->cam_from_lidar).norm(), 1e-7);
  EXPECT_LT((*white->covariance - *narrow->covariance).norm(), 1e-4 * white->covariance->norm());
}

struct ErrorStatistics {
  double nees = 0.0;  ///< Mean, over 6.
  double rms_m = 0.0;
  double number = 0.0;  ///< Mean of an estimated number.
};

// The errors of each solver on the same sessions.
std::vector<ErrorStatistics> StatisticsOf(const ViewSimulation& simulation, int sessions,
                                          const std::vector<const char*>& specs,
                                          const char* number = "") {
  std::vector<ErrorStatistics> means(specs.size());
  for (int i = 1; i <= sessions; ++i) {
    ViewSimulation one = simulation;
    one.seed = static_cast<std::uint64_t>(i);
    const SimulatedViews session = Views(one);
    for (std::size_t k = 0; k < specs.size(); ++k) {
      const auto report = Solve(session.problem, specs[k]);
      EXPECT_TRUE(report) << specs[k] << ", session " << i;
      if (!report) continue;
      const Vector6d error = PoseDifference(report->cam_from_lidar, session.true_cam_from_lidar);
      means[k].nees += SquaredMahalanobis(error, *report->covariance) / (6.0 * sessions);
      means[k].rms_m += error.tail<3>().squaredNorm() / sessions;
      const EstimatedNumber* estimated = Find(report->extras, number);
      if (estimated != nullptr) means[k].number += estimated->value / sessions;
    }
  }
  for (ErrorStatistics& mean : means) mean.rms_m = std::sqrt(mean.rms_m);
  return means;
}

// Offsets of rings and of all ranges, growth of edges, and shifts of single views. With 60 sessions
// the mean of chi-square over its 6 degrees has a sigma of 0.075, and that of all six cases one of
// 0.03; the estimated noise and what is cut add to it.
TEST(Joint, CovarianceIncludesTheSystematicErrorsOfTheLidar) {
  const LidarErrorModel models[] = {
      {0.01, 0.0, 0.0, 0.0}, {0.01, 0.01, 0.003, 0.001}, {0.01, 0.01, 0.003, 0.004}};
  constexpr int kSessions = 60;
  double mean_nees = 0.0;
  for (const LidarErrorModel& errors : models) {
    for (const int views : {6, 15}) {
      ViewSimulation simulation{.views = views, .azimuth_step_deg = kCoarseAzimuth_deg};
      simulation.errors = errors;
      const auto means = StatisticsOf(simulation, kSessions, {"joint(kabsch)", "kabsch"});
      const ErrorStatistics& joint = means[0];
      EXPECT_GT(joint.nees, 0.8) << views << " views, shift " << errors.view_shift_sigma_m;
      EXPECT_LT(joint.nees, 1.25) << views << " views, shift " << errors.view_shift_sigma_m;
      EXPECT_LT(joint.rms_m, means[1].rms_m);
      mean_nees += joint.nees / 6.0;
    }
  }
  EXPECT_GT(mean_nees, 0.85);
  EXPECT_LT(mean_nees, 1.15);
}

// Returns that are written as if all beams started at the origin make boards too tall and tilt
// them; the crossing distance is found, and the pose as accurate as the covariance states.
TEST(Joint, FindsWhereTheBeamsOfTheLidarCross) {
  constexpr int kSessions = 60;
  ViewSimulation simulation{
      .views = 15, .azimuth_step_deg = kCoarseAzimuth_deg, .beam_crossing_m = 0.042};
  simulation.errors = {0.01, 0.01, 0.003, 0.001};
  const ErrorStatistics joint =
      StatisticsOf(simulation, kSessions, {"joint(kabsch)"}, "beam_crossing_m").front();
  // The prior of 30 mm about 0 draws it nearer.
  EXPECT_GT(joint.number, 0.025);
  EXPECT_LT(joint.number, 0.046);
  EXPECT_GT(joint.nees, 0.7);
  EXPECT_LT(joint.nees, 1.35);
}

TEST(Joint, NamesTheViewThatItLeavesOut) {
  SimulatedViews session = Views({.seed = 13, .views = 4});
  session.problem.board_views[1].printed.clear();
  session.problem.board_views[1].name = "photo_7";
  const auto report = Solve(session.problem, "joint(kabsch)");
  ASSERT_TRUE(report) << report.error().message;
  EXPECT_THAT(report->warnings, Contains(HasSubstr("board 0 of view photo_7 was left out")));
}

TEST(Joint, OtherCombinatorsNameItsPlace) {
  const auto solver = BuiltinSolvers().Make("ransac(joint(kabsch))");
  ASSERT_FALSE(solver);
  EXPECT_THAT(solver.error().message, HasSubstr("joint"));
}

}  // namespace
}  // namespace sextant
