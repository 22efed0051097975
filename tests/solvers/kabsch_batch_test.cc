// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/kabsch_batch.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>

#include "base/random.h"
#include "geometry/random_vectors.h"
#include "geometry/so3.h"

namespace sextant {
namespace {

using Points = std::vector<Eigen::Vector3d>;

struct Problem {
  Points in_b;
  Points in_a;
};

// Points of the given extent along three axes about a place far away, moved and disturbed.
Problem MakeProblem(std::size_t points, const Eigen::Vector3d& extent, double noise,
                    Random& random) {
  Problem problem;
  const Eigen::Quaterniond rotation = ExpSo3(NormalVector(random));
  const Eigen::Vector3d place = 10.0 * NormalVector(random);
  for (std::size_t i = 0; i < points; ++i) {
    const Eigen::Vector3d in_a = place + NormalVector(random).cwiseProduct(extent);
    problem.in_a.push_back(in_a);
    problem.in_b.push_back(rotation * in_a + place + noise * NormalVector(random));
  }
  return problem;
}

// The moments are summed in another order: some roundings over the gap of the eigenvalues.
double RotationTolerance(const Problem& problem) {
  const auto count = static_cast<Eigen::Index>(problem.in_a.size());
  Eigen::Matrix3Xd a = Eigen::Map<const Eigen::Matrix3Xd>(problem.in_a[0].data(), 3, count);
  Eigen::Matrix3Xd b = Eigen::Map<const Eigen::Matrix3Xd>(problem.in_b[0].data(), 3, count);
  a.colwise() -= Eigen::Vector3d(a.rowwise().mean());
  b.colwise() -= Eigen::Vector3d(b.rowwise().mean());
  const Eigen::Matrix3d cross = a * b.transpose();
  const Eigen::Vector3d s = cross.jacobiSvd().singularValues();
  const double last = cross.determinant() < 0.0 ? -s[2] : s[2];
  return 1e-12 + 100.0 * 2.2e-16 * 0.5 * (a.squaredNorm() + b.squaredNorm()) / (s[1] + last);
}

std::vector<KabschOutcome> FitAll(const std::vector<Problem>& problems) {
  const std::size_t points = problems[0].in_a.size();
  PointBatch batch(problems.size(), points);
  for (std::size_t k = 0; k < problems.size(); ++k) {
    for (std::size_t i = 0; i < points; ++i) {
      batch.Set(k, i, problems[k].in_b[i], problems[k].in_a[i]);
    }
  }
  std::vector<KabschOutcome> fits(problems.size());
  FitKabschBatch(batch, fits);
  return fits;
}

TEST(KabschBatch, AnswersAsTheSingleCallForEveryShapeAndCount) {
  const std::vector<Eigen::Vector3d> extents = {
      {1, 1, 1}, {1, 1, 0}, {1, 0.5, 0.1}, {1, 0.03, 0.03}, {1, 1e-3, 1e-3}};
  Random random(1);
  for (const std::size_t points : {3U, 4U, 8U, 20U}) {
    for (const std::size_t count : {1U, 7U, 8U, 19U}) {
      for (const double noise : {0.0, 1e-4, 0.3}) {
        std::vector<Problem> problems;
        for (std::size_t k = 0; k < count; ++k) {
          problems.push_back(MakeProblem(points, extents[k % extents.size()], noise, random));
        }
        const std::vector<KabschOutcome> fits = FitAll(problems);
        for (std::size_t k = 0; k < count; ++k) {
          const Expected<KabschFit> single = FitKabsch(problems[k].in_b, problems[k].in_a);
          ASSERT_EQ(fits[k].has_value(), single.has_value()) << points << " points, problem " << k;
          if (!single) {
            EXPECT_EQ(fits[k].error(), single.error().code);
            continue;
          }
          EXPECT_LT(RotationDistance(fits[k]->b_from_a.rotation, single->b_from_a.rotation),
                    RotationTolerance(problems[k]))
              << points << " points, problem " << k << ", noise " << noise;
          EXPECT_NEAR(fits[k]->sum_squares, single->sum_squares, 1e-12 * (1.0 + 400.0));
          EXPECT_NEAR(fits[k]->mirrored_sum_squares, single->mirrored_sum_squares,
                      1e-6 * static_cast<double>(points));
        }
      }
    }
  }
}

TEST(KabschBatch, ReportsDegenerateAndMirroredProblemsByThemselves) {
  Random random(2);
  std::vector<Problem> problems;
  for (int k = 0; k < 11; ++k) problems.push_back(MakeProblem(6, {1, 1, 1}, 1e-3, random));
  for (Eigen::Vector3d& p : problems[2].in_a) p = p.x() * Eigen::Vector3d(1, 2, 3);
  for (Eigen::Vector3d& p : problems[5].in_a) p = Eigen::Vector3d(1, 2, 3);
  for (Eigen::Vector3d& p : problems[9].in_b) p.x() = -p.x();
  const std::vector<KabschOutcome> fits = FitAll(problems);
  for (std::size_t k = 0; k < problems.size(); ++k) {
    if (k == 2 || k == 5) {
      EXPECT_EQ(fits[k].error(), ErrorCode::kDegenerate) << k;
    } else if (k == 9) {
      EXPECT_EQ(fits[k].error(), ErrorCode::kMirrored);
    } else {
      ASSERT_TRUE(fits[k]) << k;
      EXPECT_LT(fits[k]->sum_squares, 1e-3) << k;
    }
  }
}

// Neighbours that need more iterations, or none, change not a bit.
TEST(KabschBatch, DoesNotNoticeTheNeighbours) {
  Random random(3);
  const Problem problem = MakeProblem(5, {1, 1, 1}, 0.1, random);
  const KabschOutcome alone = FitAll({problem})[0];
  std::vector<Problem> crowd = {problem};
  for (int k = 1; k < 8; ++k) crowd.push_back(MakeProblem(5, {1, 0.02, 0.01}, 0.3, random));
  const KabschOutcome among = FitAll(crowd)[0];
  ASSERT_TRUE(alone && among);
  EXPECT_EQ(alone->b_from_a.rotation.coeffs(), among->b_from_a.rotation.coeffs());
  EXPECT_EQ(alone->b_from_a.translation, among->b_from_a.translation);
  EXPECT_EQ(alone->sum_squares, among->sum_squares);
}

TEST(KabschBatch, SaysThatTwoPointsAreTooFew) {
  Random random(4);
  const std::vector<KabschOutcome> fits = FitAll({MakeProblem(2, {1, 1, 1}, 0.0, random)});
  EXPECT_EQ(fits[0].error(), ErrorCode::kTooFewPairs);
}

}  // namespace
}  // namespace sextant
