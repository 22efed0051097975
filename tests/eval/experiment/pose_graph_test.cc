// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/kinds/pose_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cmath>

#include "base/random.h"
#include "geometry/symmetric.h"

namespace sextant {
namespace {

using testing::HasSubstr;

Vector6d NormalVector6(Random& random) {
  Vector6d v;
  for (int i = 0; i < 6; ++i) v[i] = random.Normal();
  return v;
}

// A correlated covariance of some millimetres and hundredths of a degree.
Matrix6d RandomCovariance(Random& random) {
  Matrix6d root;
  for (int i = 0; i < 6; ++i) root.col(i) = 0.001 * NormalVector6(random);
  return root * root.transpose() + 1e-7 * Matrix6d::Identity();
}

struct Rig {
  std::vector<std::string> names = {"lidar", "cam1", "cam2", "cam3", "rear_lidar"};
  std::vector<Rigid3d> sensor_from_world{};

  Rigid3d Between(std::size_t to, std::size_t from) const {
    return sensor_from_world[to] * sensor_from_world[from].Inverse();
  }
  PoseEdge Measure(std::size_t to, std::size_t from, Random& random, double noise = 1.0) const {
    const Matrix6d covariance = RandomCovariance(random);
    const Matrix6d root = covariance.llt().matrixL();
    return {
        .from = names[from],
        .to = names[to],
        .to_from = {Perturb(Between(to, from), noise * root * NormalVector6(random)), covariance}};
  }
};

Rig MakeRig(Random& random) {
  Rig rig;
  for (std::size_t i = 0; i < rig.names.size(); ++i) {
    rig.sensor_from_world.push_back(Perturb({}, NormalVector6(random)));
  }
  return rig;
}

TEST(SensorGraph, ChainsTwoCamerasThroughTheLidar) {
  Random random(1);
  const Rig rig = MakeRig(random);
  const PoseEdge first = rig.Measure(1, 0, random);
  const PoseEdge second = rig.Measure(2, 0, random);
  const Expected<SensorGraph> graph = SensorGraph::Solve({first, second});
  ASSERT_TRUE(graph) << graph.error().message;
  const Expected<UncertainPose> cam1_from_cam2 = graph->Between("cam1", "cam2");
  ASSERT_TRUE(cam1_from_cam2);
  const UncertainPose chain = Chain(first.to_from, Inverse(second.to_from));
  EXPECT_LT(PoseDifference(cam1_from_cam2->b_from_a, chain.b_from_a).norm(), 1e-10);
  EXPECT_LT((cam1_from_cam2->covariance - chain.covariance).norm(), 1e-6 * chain.covariance.norm());
  EXPECT_EQ(graph->redundancy(), 0);
  EXPECT_LT(graph->chi_square(), 1e-12);
}

TEST(SensorGraph, ExactLoopsGiveTheTruth) {
  Random random(2);
  const Rig rig = MakeRig(random);
  std::vector<PoseEdge> edges;
  for (const auto& [to, from] : {std::pair{1, 0}, {2, 0}, {3, 4}, {2, 4}, {0, 4}, {1, 4}, {3, 0}}) {
    edges.push_back(
        rig.Measure(static_cast<std::size_t>(to), static_cast<std::size_t>(from), random, 0.0));
  }
  const Expected<SensorGraph> graph = SensorGraph::Solve(edges);
  ASSERT_TRUE(graph) << graph.error().message;
  EXPECT_EQ(graph->redundancy(), 18);
  EXPECT_LT(graph->chi_square(), 1e-12);
  const Expected<UncertainPose> pose = graph->Between("cam1", "cam3");
  ASSERT_TRUE(pose);
  EXPECT_LT(PoseDifference(pose->b_from_a, rig.Between(1, 3)).norm(), 1e-10);
}

// Mean of e^T C^-1 e / 6 over independent trials, whose standard deviation is sqrt(2 / 6 / trials).
TEST(SensorGraph, CovarianceAndChiSquareAreConsistent) {
  constexpr int kTrials = 400;
  Random random(3);
  double nees = 0.0;
  double chi_square = 0.0;
  double joint = 0.0;
  double chained = 0.0;
  for (int i = 0; i < kTrials; ++i) {
    const Rig rig = MakeRig(random);
    std::vector<PoseEdge> edges;
    for (const auto& [to, from] : {std::pair{1, 0}, {2, 0}, {1, 4}, {2, 4}, {0, 4}}) {
      edges.push_back(
          rig.Measure(static_cast<std::size_t>(to), static_cast<std::size_t>(from), random));
    }
    const Expected<SensorGraph> graph = SensorGraph::Solve(edges);
    ASSERT_TRUE(graph) << graph.error().message;
    const UncertainPose pose = *graph->Between("cam2", "cam1");
    const Vector6d error = PoseDifference(rig.Between(2, 1), pose.b_from_a);
    nees += SquaredMahalanobis(error, pose.covariance) / 6.0 / kTrials;
    chi_square += graph->chi_square() / graph->redundancy() / kTrials;
    const UncertainPose chain = Chain(edges[1].to_from, Inverse(edges[0].to_from));
    joint += pose.covariance.trace();
    chained += chain.covariance.trace();
  }
  EXPECT_NEAR(nees, 1.0, 4.0 * std::sqrt(2.0 / 6.0 / kTrials));
  EXPECT_NEAR(chi_square, 1.0, 4.0 * std::sqrt(2.0 / 12.0 / kTrials));
  EXPECT_LT(joint, 0.9 * chained);  // The chain through the second LiDAR contributes as well.
}

TEST(SensorGraph, RejectsInvalidGraphs) {
  Random random(4);
  const Rig rig = MakeRig(random);
  EXPECT_EQ(SensorGraph::Solve({}).error().code, ErrorCode::kMissingData);

  const Expected<SensorGraph> apart =
      SensorGraph::Solve({rig.Measure(1, 0, random), rig.Measure(3, 4, random)});
  ASSERT_FALSE(apart);
  EXPECT_EQ(apart.error().code, ErrorCode::kDegenerate);
  EXPECT_THAT(apart.error().message, HasSubstr("joins rear_lidar to lidar"));

  PoseEdge certain = rig.Measure(1, 0, random);
  certain.to_from.covariance.setZero();
  EXPECT_EQ(SensorGraph::Solve({certain}).error().code, ErrorCode::kInvalidInput);

  PoseEdge itself = rig.Measure(1, 0, random);
  itself.to = itself.from;
  EXPECT_EQ(SensorGraph::Solve({itself}).error().code, ErrorCode::kInvalidInput);

  PoseEdge broken = rig.Measure(1, 0, random);
  broken.to_from.b_from_a.translation.x() = std::nan("");
  EXPECT_EQ(SensorGraph::Solve({broken}).error().code, ErrorCode::kNonFinite);

  const Expected<SensorGraph> graph = SensorGraph::Solve({rig.Measure(1, 0, random)});
  ASSERT_TRUE(graph);
  const Expected<UncertainPose> unknown = graph->Between("cam", "lidar");
  ASSERT_FALSE(unknown);
  EXPECT_THAT(unknown.error().message, HasSubstr("cam1"));
}

}  // namespace
}  // namespace sextant
