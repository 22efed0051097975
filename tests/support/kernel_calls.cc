// SPDX-License-Identifier: Apache-2.0
#include "support/kernel_calls.h"

#include <array>
#include <cstdio>
#include <cstdlib>
#include <memory>

#include "eval/synthetic/mismatched_pairs.h"
#include "eval/synthetic/random_scene.h"
#include "geometry/pair_noise.h"
#include "solvers/builtin_solvers.h"
#include "solvers/core/registry.h"
#include "solvers/kernels/kabsch.h"
#include "solvers/kernels/p3p.h"
#include "solvers/least_squares/refine_pose.h"
#include "solvers/pnp/dlt.h"
#include "solvers/pnp/epnp.h"
#include "solvers/pnp/ippe.h"
#include "solvers/pnp/reprojection_covariance.h"
#include "solvers/pnp/sqpnp.h"
#include "solvers/robust/consensus.h"
#include "solvers/robust/term_scorer.h"

namespace sextant::test {
namespace {

constexpr int kProblems = 16;
constexpr double kMaxSquared = 9.21;

// One scene in the input formats of the kernels.
struct Forms {
  RandomScene scene;
  std::vector<Eigen::Vector3d> in_cam;
  std::vector<Eigen::Vector3d> in_lidar;
  std::vector<Eigen::Vector3d> rays;
  std::vector<Eigen::Vector2d> image_points;
  std::vector<double> weights;
  PairTerms pixels;
  PairTerms points;
  std::unique_ptr<TermScorer> pixel_scorer;
  std::unique_ptr<TermScorer> point_scorer;
  Rigid3d near_truth;
};

std::vector<Forms> MakeForms(int pairs, double outliers, bool planar) {
  const RandomSceneOptions options{
      .pairs = pairs, .sigma_m = 0.01, .sigma_px = 1.0, .planar = planar};
  Random random(11);
  std::vector<Forms> all(kProblems);
  for (Forms& forms : all) {
    forms.scene = MakeRandomScene(options, random);
    MismatchPairs(options, InlierCount(pairs, outliers), random, forms.scene);
    const CalibrationProblem& problem = forms.scene.problem;
    for (const Pair3d3d& pair : problem.pairs_3d3d) {
      forms.in_cam.push_back(pair.point_in_cam);
      forms.in_lidar.push_back(pair.point_in_lidar);
    }
    for (const Pair2d3d& pair : problem.pairs_2d3d) {
      forms.rays.push_back(*Unproject(*problem.camera, pair.pixel));
      forms.image_points.push_back(forms.rays.back().hnormalized());
    }
    forms.weights.assign(problem.pairs_3d3d.size(), 1.0);
    forms.pixels = MakeTerms(problem, PairKind::k2d3d);
    forms.points = MakeTerms(problem, PairKind::k3d3d);
    forms.pixel_scorer = std::make_unique<TermScorer>(forms.pixels);
    forms.point_scorer = std::make_unique<TermScorer>(forms.points);
    forms.near_truth = Perturb(forms.scene.cam_from_lidar, Vector6d::Constant(0.02));
  }
  return all;
}

// A kernel that returns no result would be fast, so results are checked.
void Require(bool answered, const char* kernel) {
  if (answered) return;
  std::fprintf(stderr, "%s gave no answer\n", kernel);
  std::abort();
}

// solve(forms) returns whether there is a result.
template <class Solve>
KernelCall CallOf(const char* name, int pairs, Solve solve, double outliers = 0.0,
                  bool planar = false) {
  const auto forms = std::make_shared<std::vector<Forms>>(MakeForms(pairs, outliers, planar));
  return {std::string(name) + "/" + std::to_string(pairs), kProblems, [name, forms, solve] {
            for (Forms& one : *forms) Require(solve(one), name);
          }};
}

bool AnswersP3p(Forms& forms) {
  std::array<Rigid3d, kMaxP3pPoses> poses;
  return SolveP3p(std::span<const Eigen::Vector3d, 3>(forms.rays),
                  std::span<const Eigen::Vector3d, 3>(forms.in_lidar), poses) > 0;
}

bool Refines(const PairTerms& terms, const Rigid3d& start) {
  return RefinePose(terms.View(), start, {}).outcome == RefineOutcome::kConverged;
}

void AddPnp(std::vector<KernelCall>& calls) {
  calls.push_back(CallOf("p3p", 3, AnswersP3p));
  for (const int pairs : {8, 100}) {
    calls.push_back(CallOf(
        "ippe", pairs, [](Forms& f) { return SolveIppe(f.image_points, f.in_lidar).has_value(); },
        0.0, true));
    calls.push_back(CallOf(
        "epnp", pairs, [](Forms& f) { return SolveEpnp(f.image_points, f.in_lidar).has_value(); }));
    calls.push_back(CallOf("sqpnp", pairs, [](Forms& f) {
      return SolveSqpnp(f.image_points, f.in_lidar).has_value();
    }));
    calls.push_back(CallOf(
        "dlt", pairs, [](Forms& f) { return SolveDlt(f.image_points, f.in_lidar).has_value(); }));
  }
}

void AddRefinements(std::vector<KernelCall>& calls) {
  for (const int pairs : {8, 100}) {
    calls.push_back(
        CallOf("refine_pixels", pairs, [](Forms& f) { return Refines(f.pixels, f.near_truth); }));
    calls.push_back(
        CallOf("refine_points", pairs, [](Forms& f) { return Refines(f.points, f.near_truth); }));
  }
}

// The work of RANSAC for one hypothesis.
void AddConsensus(std::vector<KernelCall>& calls) {
  calls.push_back(CallOf(
      "score_pixels", 100,
      [](Forms& f) { return f.pixel_scorer->Cost(f.near_truth, kMaxSquared) > 0.0; }, 0.5));
  calls.push_back(CallOf(
      "score_points", 100,
      [](Forms& f) { return f.point_scorer->Cost(f.near_truth, kMaxSquared) > 0.0; }, 0.5));
  calls.push_back(CallOf(
      "optimise_on_inliers", 100,
      [](Forms& f) {
        TermScorer& scorer = *f.pixel_scorer;
        const Rigid3d pose = OptimiseOnInliers(scorer, f.near_truth, kMaxSquared, 4, {});
        return scorer.Cost(pose, kMaxSquared) <= scorer.Cost(f.near_truth, kMaxSquared);
      },
      0.5));
}

void AddCovariances(std::vector<KernelCall>& calls) {
  calls.push_back(CallOf("propagate_covariance", 100, [](Forms& f) {
    return PropagateCovariance(f.scene.problem.pairs_3d3d, f.weights, f.scene.cam_from_lidar)
        .has_value();
  }));
  calls.push_back(CallOf("reprojection_covariance", 100, [](Forms& f) {
    const CalibrationProblem& problem = f.scene.problem;
    return ReprojectionCovariance(*problem.camera, problem.pairs_2d3d, f.scene.cam_from_lidar)
        .has_value();
  }));
}

KernelCall SolverCall(const char* spec, int pairs, double outliers) {
  const SolverPtr solver = *BuiltinSolvers().Make(spec);
  return CallOf(
      spec, pairs, [solver](Forms& f) { return solver->Solve(f.scene.problem).has_value(); },
      outliers);
}

}  // namespace

std::vector<KernelCall> KernelCalls() {
  std::vector<KernelCall> calls;
  for (const int pairs : {8, 100}) {
    calls.push_back(CallOf("kabsch", pairs,
                           [](Forms& f) { return FitKabsch(f.in_cam, f.in_lidar).has_value(); }));
  }
  calls.push_back(CallOf("kabsch_weighted", 100, [](Forms& f) {
    return FitKabsch(f.in_cam, f.in_lidar, f.weights).has_value();
  }));
  AddPnp(calls);
  AddRefinements(calls);
  AddConsensus(calls);
  AddCovariances(calls);
  return calls;
}

std::vector<KernelCall> SolverCalls() {
  return {SolverCall("kabsch", 8, 0.0),        SolverCall("refine(p3p)", 20, 0.0),
          SolverCall("ransac(p3p)", 100, 0.5), SolverCall("ransac(kabsch)", 100, 0.5),
          SolverCall("gnc(kabsch)", 100, 0.5), SolverCall("clique(kabsch)", 100, 0.8),
          SolverCall("ransac(epnp)", 100, 0.3)};
}

}  // namespace sextant::test
