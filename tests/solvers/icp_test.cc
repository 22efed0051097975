// SPDX-License-Identifier: Apache-2.0
#include "solvers/icp/icp.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fstream>
#include <map>
#include <string>

#include "base/random.h"
#include "base/units.h"
#include "geometry/random_vectors.h"
#include "geometry/symmetric.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "solvers/kernels/kabsch.h"
#include "support/points.h"
#include "support/poses.h"
#include "support/real_data.h"

namespace sextant {
namespace {

using test::ExpectSamePose;
using test::Moved;
using test::NormalPoints;

using Points = std::vector<Eigen::Vector3d>;

// Points of three faces of a cube of side 2, which determine every motion.
Points Corner(int count, Random& random) {
  Points points;
  for (int i = 0; i < count; ++i) {
    Eigen::Vector3d p(random.Uniform(-1.0, 1.0), random.Uniform(-1.0, 1.0), 1.0);
    std::swap(p[i % 3], p[2]);
    points.push_back(p);
  }
  return points;
}

Rigid3d SmallMotion(Random& random, double rotation_rad, double translation_m) {
  const Eigen::Vector3d axis = NormalVector(random).normalized();
  const Eigen::Vector3d direction = NormalVector(random).normalized();
  return {ExpSo3(rotation_rad * axis), translation_m * direction};
}

TEST(Icp, RecoversSmallMotionsOfCornersExactly) {
  for (int trial = 0; trial < 100; ++trial) {
    Random random(DeriveSeed(1, "icp", 0, static_cast<std::uint64_t>(trial)));
    const Points source = NormalPoints(8, random);
    const Rigid3d truth = SmallMotion(random, 0.02, 0.02);
    const Expected<IcpFit> fit = FitIcp(Moved(truth, source), source, Rigid3d{}, {});
    ASSERT_TRUE(fit) << fit.error().message;
    EXPECT_TRUE(fit->converged);
    ExpectSamePose(fit->target_from_source, truth, 1e-9);
  }
}

TEST(Icp, RecoversSmallMotionsAlongPlanesExactly) {
  Random random(2);
  const Points source = Corner(2000, random);
  const Rigid3d truth = SmallMotion(random, 0.01, 0.01);
  const IcpSettings settings{.metric = IcpMetric::kPlane, .max_distance_m = 0.3};
  const Expected<IcpFit> fit = FitIcp(Moved(truth, source), source, Rigid3d{}, settings);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_TRUE(fit->converged);
  ExpectSamePose(fit->target_from_source, truth, 1e-6);
}

TEST(Icp, AgreesWithKabschOnTheMatchesItReports) {
  Random random(3);
  const Points source = NormalPoints(30, random);
  const Rigid3d truth = SmallMotion(random, 0.05, 0.05);
  Points target = Moved(truth, source);
  for (Eigen::Vector3d& p : target) p += 0.01 * NormalVector(random);
  const Expected<IcpFit> fit = FitIcp(target, source, Rigid3d{}, {});
  ASSERT_TRUE(fit) << fit.error().message;
  Points matched_target;
  Points matched_source;
  for (const IcpMatch& match : fit->matches) {
    matched_target.push_back(target[static_cast<std::size_t>(match.target)]);
    matched_source.push_back(source[static_cast<std::size_t>(match.source)]);
  }
  const Expected<KabschFit> kabsch = FitKabsch(matched_target, matched_source);
  ASSERT_TRUE(kabsch);
  ExpectSamePose(fit->target_from_source, kabsch->b_from_a, 1e-12);
  EXPECT_NEAR(fit->rmse_m, std::sqrt(kabsch->sum_squares / 30.0), 1e-12);
}

// A tenth of the source has no counterpart and is far off: it shifts the plain fit by decimetres.
TEST(Icp, TrimmingAndMaxDistanceEachSurviveOutliers) {
  Random random(4);
  Points source = NormalPoints(200, random);
  const Rigid3d truth = SmallMotion(random, 0.01, 0.01);
  const Points target = Moved(truth, source);
  for (std::size_t i = 0; i < 20; ++i) source[i] += Eigen::Vector3d(8.0, 0.0, 0.0);

  const Expected<IcpFit> plain = FitIcp(target, source, Rigid3d{}, {});
  ASSERT_TRUE(plain) << plain.error().message;
  EXPECT_GT(DistanceBetween(plain->target_from_source, truth).translation_m, 0.1);

  const Expected<IcpFit> trimmed = FitIcp(target, source, Rigid3d{}, {.trim = 0.1});
  ASSERT_TRUE(trimmed) << trimmed.error().message;
  EXPECT_EQ(trimmed->matches.size(), 180U);
  ExpectSamePose(trimmed->target_from_source, truth, 1e-9);

  const Expected<IcpFit> near = FitIcp(target, source, Rigid3d{}, {.max_distance_m = 1.0});
  ASSERT_TRUE(near) << near.error().message;
  EXPECT_EQ(near->matches.size(), 180U);
  ExpectSamePose(near->target_from_source, truth, 1e-9);
}

TEST(Icp, MatchesAHundredThousandPoints) {
  Random random(5);
  const Points source = NormalPoints(100000, random);
  const Rigid3d truth = SmallMotion(random, 0.001, 0.001);
  const Expected<IcpFit> fit = FitIcp(Moved(truth, source), source, Rigid3d{}, {});
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_TRUE(fit->converged);
  ExpectSamePose(fit->target_from_source, truth, 1e-9);
}

TEST(Icp, ReportsThatTheIterationsRanOut) {
  Random random(6);
  const Points source = NormalPoints(500, random);
  const Points target = Moved(SmallMotion(random, 0.2, 0.2), source);
  const Expected<IcpFit> fit = FitIcp(target, source, Rigid3d{}, {.max_iterations = 2});
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_FALSE(fit->converged);
  EXPECT_EQ(fit->iterations, 2);
}

TEST(Icp, RefusesDegenerateInput) {
  Random random(7);
  const Points source = NormalPoints(8, random);
  const auto code = [](const Points& target, const Points& from, const IcpSettings& settings) {
    return FitIcp(target, from, Rigid3d{}, settings).error().code;
  };
  const Points two(source.begin(), source.begin() + 2);
  EXPECT_EQ(code(two, source, {}), ErrorCode::kTooFewPairs);
  EXPECT_EQ(code(source, two, {}), ErrorCode::kTooFewPairs);
  EXPECT_EQ(code(source, source, {.metric = IcpMetric::kPlane}), ErrorCode::kTooFewPairs);

  const Points far = Moved({Eigen::Quaterniond::Identity(), {50.0, 0.0, 0.0}}, source);
  EXPECT_EQ(code(source, far, {.max_distance_m = 1.0}), ErrorCode::kNoConsensus);

  Points line;
  for (int i = 0; i < 8; ++i) line.push_back(Eigen::Vector3d(0.3, 0.2, 0.1) * i);
  EXPECT_EQ(code(line, line, {}), ErrorCode::kDegenerate);

  Points plane = NormalPoints(50, random);
  for (Eigen::Vector3d& p : plane) p.z() = 2.0;
  EXPECT_EQ(code(plane, plane, {.metric = IcpMetric::kPlane}), ErrorCode::kDegenerate);

  const Points same(50, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_EQ(code(same, plane, {.metric = IcpMetric::kPlane}), ErrorCode::kNoConsensus);
}

// Mean NEES over its 6 degrees of freedom; five standard errors of sqrt(2 / (6 n)). With the true
// start and noise far below the spacing the matches are right, so that the covariance must be
// consistent.
TEST(Icp, CovarianceIsConsistentWhereTheMatchesAreRight) {
  constexpr int kTrials = 300;
  double sum = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Random random(DeriveSeed(8, "icp", 0, static_cast<std::uint64_t>(trial)));
    const Points source = NormalPoints(40, random);
    const Rigid3d truth = SmallMotion(random, 1.0, 1.0);
    Points target = Moved(truth, source);
    for (Eigen::Vector3d& p : target) p += 1e-4 * NormalVector(random);
    const Expected<IcpFit> fit = FitIcp(target, source, truth, {});
    ASSERT_TRUE(fit && fit->covariance);
    const Vector6d error = PoseDifference(fit->target_from_source, truth);
    sum += SquaredMahalanobis(error, *fit->covariance) / 6.0;
  }
  // The estimated variance, of 114 degrees of freedom, raises the mean by 114 / 112.
  EXPECT_NEAR(sum / kTrials, 114.0 / 112.0, 5.0 * std::sqrt(2.0 / (6.0 * kTrials)));
}

TEST(Icp, CovarianceOfPlanesIsConsistent) {
  constexpr int kTrials = 100;
  double sum = 0.0;
  for (int trial = 0; trial < kTrials; ++trial) {
    Random random(DeriveSeed(9, "icp", 0, static_cast<std::uint64_t>(trial)));
    const Points target = Corner(1500, random);
    const Rigid3d truth = SmallMotion(random, 0.01, 0.01);
    Points source = Moved(truth.Inverse(), Corner(90, random));
    for (Eigen::Vector3d& p : source) p += 1e-4 * NormalVector(random);
    const IcpSettings settings{.metric = IcpMetric::kPlane, .max_distance_m = 0.5};
    const Expected<IcpFit> fit = FitIcp(target, source, truth, settings);
    ASSERT_TRUE(fit && fit->covariance);
    const Vector6d error = PoseDifference(fit->target_from_source, truth);
    sum += SquaredMahalanobis(error, *fit->covariance) / 6.0;
  }
  EXPECT_NEAR(sum / kTrials, 84.0 / 82.0, 5.0 * std::sqrt(2.0 / (6.0 * kTrials)));
}

TEST(IcpSolver, StartsAtTheGivenPose) {
  Random random(10);
  CalibrationProblem problem;
  problem.point_sets.in_lidar = NormalPoints(8, random);
  const Rigid3d truth = SmallMotion(random, 2.0, 5.0);
  problem.point_sets.in_cam = Moved(truth, problem.point_sets.in_lidar);
  const SolverRegistry registry = BuiltinSolvers();
  EXPECT_EQ((*registry.Make("icp(init=pose)"))->Solve(problem).error().code,
            ErrorCode::kMissingData);
  problem.initial_cam_from_lidar = truth;
  for (const char* spec : {"icp(init=pose)", "icp(init=pose,trim=0.2,max_distance_m=0.5)"}) {
    const Expected<SolveReport> report = (*registry.Make(spec))->Solve(problem);
    ASSERT_TRUE(report) << report.error().message;
    ExpectSamePose(report->cam_from_lidar, truth, 1e-9);
    EXPECT_EQ(report->termination, Termination::kConverged);
  }
  EXPECT_EQ(registry.Make("icp(init=guess)").error().code, ErrorCode::kInvalidOption);
  EXPECT_EQ(registry.Make("icp(trim=1)").error().code, ErrorCode::kInvalidOption);
}

TEST(IcpSolver, FindsThePairingOfTheOriginalsCorners) {
  SEXTANT_REAL_DATA(path, "dhall/points_head.txt");
  std::ifstream file(path);
  std::size_t count = 0;
  file >> count;
  std::vector<Pair3d3d> pairs(count);
  const auto read = [&file](Eigen::Vector3d& p) { file >> p.x() >> p.y() >> p.z(); };
  for (Pair3d3d& pair : pairs) read(pair.point_in_lidar);
  for (Pair3d3d& pair : pairs) read(pair.point_in_cam);
  ASSERT_TRUE(file);
  CalibrationProblem paired;
  paired.pairs_3d3d = pairs;
  CalibrationProblem withheld;
  withheld.point_sets = WithholdPairing(pairs);
  const SolverRegistry registry = BuiltinSolvers();
  const Expected<SolveReport> icp = (*registry.Make("icp(init=centroid)"))->Solve(withheld);
  const Expected<SolveReport> kabsch = (*registry.Make("kabsch"))->Solve(paired);
  ASSERT_TRUE(icp) << icp.error().message;
  ASSERT_TRUE(kabsch);
  ExpectSamePose(icp->cam_from_lidar, kabsch->cam_from_lidar, 1e-9);
  const Eigen::Vector3d expected(0.07782465, -0.12717874, -0.13056974);
  EXPECT_LT((icp->cam_from_lidar.translation - expected).norm(), 1e-7);
  EXPECT_TRUE(icp->covariance->isApprox(*kabsch->covariance, 1e-6));

  const Points& target = withheld.point_sets.in_cam;
  const Points& source = withheld.point_sets.in_lidar;
  const Expected<IcpFit> fit = FitIcp(target, source, AlignCentroids(target, source), {});
  ASSERT_TRUE(fit);
  EXPECT_NEAR(fit->rmse_m, 0.03914974, 1e-7);
  for (const IcpMatch& match : fit->matches) {
    EXPECT_TRUE(std::any_of(pairs.begin(), pairs.end(), [&](const Pair3d3d& pair) {
      return pair.point_in_cam == target[static_cast<std::size_t>(match.target)] &&
             pair.point_in_lidar == source[static_cast<std::size_t>(match.source)];
    }));
  }
}

// Binary little-endian, four floats per vertex: the format of these two files.
Points ReadScan(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::size_t count = 0;
  for (std::string word; word != "end_header" && file >> word;) {
    if (word == "vertex") file >> count;
  }
  file.get();
  std::vector<float> numbers(4 * count);
  std::string bytes(numbers.size() * sizeof(float), '\0');
  file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  Points points;
  if (!file) return points;
  for (std::size_t i = 0; i < count; ++i) {
    points.push_back(Eigen::Map<Eigen::Vector3f>(&numbers[4 * i]).cast<double>());
  }
  return points;
}

// Means of the points in each cube of 25 cm, so that the ground near the sensor does not
// dominate.
Points Thinned(const Points& points) {
  struct Cell {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int count = 0;
  };
  std::map<std::array<int, 3>, Cell> cells;
  for (const Eigen::Vector3d& p : points) {
    const Eigen::Vector3i place = (p / 0.25).array().floor().cast<int>();
    Cell& cell = cells[{place.x(), place.y(), place.z()}];
    cell.sum += p;
    ++cell.count;
  }
  Points means;
  for (const auto& [place, cell] : cells) means.push_back(cell.sum / cell.count);
  return means;
}

TEST(Icp, AlignsTwoRealScansFromIdentity) {
  SEXTANT_REAL_DATA(path, "gicp");
  const Points target = Thinned(ReadScan(path / "target.ply"));
  const Points source = Thinned(ReadScan(path / "source.ply"));
  ASSERT_GT(target.size(), 5000U);
  ASSERT_GT(source.size(), 5000U);
  Eigen::Matrix4d expected;
  std::ifstream file(path / "T_target_source.txt");
  for (int i = 0; i < 16; ++i) file >> expected(i / 4, i % 4);
  ASSERT_TRUE(file);
  const Eigen::Matrix3d expected_rotation = expected.topLeftCorner<3, 3>();
  const Rigid3d published{Eigen::Quaterniond(expected_rotation).normalized(),
                          expected.topRightCorner<3, 1>()};
  const IcpSettings settings{.metric = IcpMetric::kPlane,
                             .max_distance_m = 1.0,
                             .trim = 0.2,
                             .neighbours = 20,
                             .max_iterations = 30,
                             .rotation_tolerance_rad = 1e-4,
                             .translation_tolerance_m = 1e-3};
  const Expected<IcpFit> fit = FitIcp(target, source, Rigid3d{}, settings);
  ASSERT_TRUE(fit) << fit.error().message;
  EXPECT_TRUE(fit->converged);
  const PoseDistance distance = DistanceBetween(fit->target_from_source, published);
  EXPECT_LT(distance.rotation_rad, 0.5 * kRadPerDeg);
  EXPECT_LT(distance.translation_m, 0.03);
}

}  // namespace
}  // namespace sextant
