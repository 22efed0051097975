// SPDX-License-Identifier: Apache-2.0
// The two implementations of the scoring interface agree on 3D-3D pairs with isotropic noise.
#include "solvers/robust/pair_scorer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <numeric>

#include "solvers/robust/column_scorer.h"
#include "solvers/robust/term_scorer.h"
#include "support/outliers.h"

namespace sextant {
namespace {

constexpr double kMaxSquared = 11.3;

// Pairs with different sigmas, a third of them mismatched, around the size of a block of columns.
class BothScorers : public testing::TestWithParam<int> {
 protected:
  void SetUp() override {
    const test::SceneOptions options{.pairs = GetParam(), .sigma_m = 0.01};
    Random random(static_cast<std::uint64_t>(GetParam()));
    test::PairScene scene = test::MakeScene(options, random);
    test::AddOutliers(1.0 / 3.0, options, random, scene);
    problem_ = scene.problem;
    for (Pair3d3d& pair : problem_.pairs_3d3d) pair.sigma_m = random.Uniform(0.005, 0.02);
    pose_ = Perturb(scene.cam_from_lidar, Vector6d::Constant(0.002));
    columns_ = std::make_unique<ColumnScorer>(problem_.pairs_3d3d);
    terms_ = std::make_unique<TermScorer>(MakeTerms(problem_, PairKind::k3d3d));
  }

  CalibrationProblem problem_;
  Rigid3d pose_;
  std::unique_ptr<ColumnScorer> columns_;
  std::unique_ptr<TermScorer> terms_;
};

TEST_P(BothScorers, AgreeOnCostAndInliers) {
  EXPECT_EQ(columns_->size(), terms_->size());
  const double cost = terms_->Cost(pose_, kMaxSquared);
  EXPECT_NEAR(columns_->Cost(pose_, kMaxSquared), cost, 1e-9 * cost);
  EXPECT_GE(terms_->CostUpTo(pose_, kMaxSquared, 0.5 * cost), 0.5 * cost);
  std::vector<int> of_columns;
  std::vector<int> of_terms;
  columns_->Inliers(pose_, kMaxSquared, of_columns);
  terms_->Inliers(pose_, kMaxSquared, of_terms);
  EXPECT_EQ(of_columns, of_terms);
  EXPECT_NEAR(columns_->RandomAgreementProbability(kMaxSquared),
              terms_->RandomAgreementProbability(kMaxSquared), 1e-12);
}

TEST_P(BothScorers, AgreeOnTheFitToTheInliers) {
  const auto of_columns = columns_->FitInliers(pose_, 4.0 * kMaxSquared, {});
  const auto of_terms = terms_->FitInliers(pose_, 4.0 * kMaxSquared, {});
  ASSERT_TRUE(of_columns && of_terms);
  const PoseDistance distance = DistanceBetween(*of_columns, *of_terms);
  EXPECT_LT(distance.rotation_rad, 1e-9);
  EXPECT_LT(distance.translation_m, 1e-9);
}

TEST_P(BothScorers, AgreeOnTheWeightsOfGraduatedNonConvexity) {
  const double largest = terms_->LargestSquared(pose_);
  EXPECT_NEAR(columns_->LargestSquared(pose_), largest, 1e-9 * largest);
  for (const double mu : {1e-3, 0.1, 10.0}) {
    const GncWeight weight_of(kMaxSquared, mu);
    const GncReweighting of_columns = columns_->Reweight(pose_, weight_of);
    EXPECT_NEAR(of_columns.unsettled, terms_->Reweight(pose_, weight_of).unsettled, 1e-9);
    EXPECT_TRUE(of_columns.fit);
    EXPECT_THAT(columns_->Weights(),
                testing::Pointwise(testing::DoubleNear(1e-9), terms_->Weights()));
  }
}

TEST_P(BothScorers, AgreeOnTheGraph) {
  const BitGraph of_columns = columns_->AgreementGraph(kMaxSquared);
  const BitGraph of_terms = terms_->AgreementGraph(kMaxSquared);
  for (int i = 0; i < GetParam(); ++i) {
    for (int j = 0; j < i; ++j) {
      EXPECT_EQ(of_columns.AreConnected(i, j), of_terms.AreConnected(i, j)) << i << " " << j;
    }
  }
}

// Exactly, whatever their number: too small a count would refuse a consensus.
TEST_P(BothScorers, CountDifferentPairs) {
  std::vector<int> indices(problem_.pairs_3d3d.size());
  std::iota(indices.begin(), indices.end(), 0);
  for (const PairScorer* scorer :
       {static_cast<PairScorer*>(columns_.get()), static_cast<PairScorer*>(terms_.get())}) {
    EXPECT_EQ(scorer->CountDistinct(indices), GetParam());
  }
  problem_.pairs_3d3d[3] = problem_.pairs_3d3d[1];
  problem_.pairs_3d3d[5] = problem_.pairs_3d3d[1];
  const TermScorer terms(MakeTerms(problem_, PairKind::k3d3d));
  EXPECT_EQ(columns_->CountDistinct(indices), GetParam() - 2);
  EXPECT_EQ(terms.CountDistinct(indices), GetParam() - 2);
}

INSTANTIATE_TEST_SUITE_P(Counts, BothScorers, testing::Values(12, 63, 64, 65, 1100));

TEST(MakePairScorer, ChoosesColumnsForIsotropicPairsOnly) {
  Random random(1);
  CalibrationProblem problem = test::MakeScene({.pairs = 8, .sigma_m = 0.01}, random).problem;
  const auto is_in_columns = [&problem](PairKind kind) {
    return dynamic_cast<ColumnScorer*>(MakePairScorer(problem, kind).get()) != nullptr;
  };
  EXPECT_TRUE(is_in_columns(PairKind::k3d3d));
  EXPECT_FALSE(is_in_columns(PairKind::k2d3d));
  problem.pairs_3d3d[2].covariance_in_cam = 1e-4 * Eigen::Matrix3d::Identity();
  EXPECT_FALSE(is_in_columns(PairKind::k3d3d));
}

}  // namespace
}  // namespace sextant
