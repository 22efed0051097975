// SPDX-License-Identifier: Apache-2.0
// How often each robust solver finds the pose among outliers, compared with OpenCV and opengv on
// the same scenes. Prints the table; exits with 1 where a peer beats one of ours, or one of ours
// fails at 100 pairs and up to 50 percent of outliers.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>
#include <vector>

#include "bench/outlier_study.h"
#include "solvers/core/registry.h"

#ifdef SEXTANT_BENCH_OPENCV
#include "solvers/builtin_solvers.h"
#include "solvers/opencv/opencv_solvers.h"
#endif
#ifdef SEXTANT_BENCH_OPENGV
#include <memory>
#include <opengv/absolute_pose/CentralAbsoluteAdapter.hpp>
#include <opengv/sac/Ransac.hpp>
#include <opengv/sac_problems/absolute_pose/AbsolutePoseSacProblem.hpp>
#endif

namespace sextant::bench {
namespace {

constexpr const char* kOurs[] = {"refine(ransac(p3p))", "ransac(p3p)", "ransac(epnp)", "gnc(epnp)"};
// The first ones have goals; gnc is a local method, listed for comparison.
constexpr std::size_t kWithGoals = 3;

std::vector<Contestant> Solvers(const SolverRegistry& registry,
                                const std::vector<std::string>& specs) {
  std::vector<Contestant> contestants;
  for (const std::string& spec : specs) {
    const Expected<SolverPtr> solver = registry.Make(spec);
    if (!solver) {
      std::fprintf(stderr, "bench_outliers: %s\n", solver.error().message.c_str());
      std::exit(2);
    }
    contestants.push_back(ContestantOf(*solver));
  }
  return contestants;
}

#ifdef SEXTANT_BENCH_OPENGV
// With our threshold, 3.03 px, and number of iterations; refined on the inliers as in its examples.
std::optional<Rigid3d> OpengvRansac(const CalibrationProblem& problem) {
  using Problem = opengv::sac_problems::absolute_pose::AbsolutePoseSacProblem;
  constexpr double kThresholdPx = 3.03;
  opengv::bearingVectors_t bearings;
  opengv::points_t points;
  for (const Pair2d3d& pair : problem.pairs_2d3d) {
    bearings.push_back(*Unproject(*problem.camera, pair.pixel));
    points.push_back(pair.point_in_lidar);
  }
  opengv::absolute_pose::CentralAbsoluteAdapter adapter(bearings, points);
  opengv::sac::Ransac<Problem> ransac;
  ransac.sac_model_ = std::make_shared<Problem>(adapter, Problem::KNEIP, /*randomSeed=*/false);
  ransac.threshold_ = 1.0 - std::cos(std::atan(kThresholdPx / problem.camera->fx_px));
  ransac.max_iterations_ = 10000;
  ransac.probability_ = 0.999;
  if (!ransac.computeModel()) return std::nullopt;
  opengv::transformation_t refined = ransac.model_coefficients_;
  ransac.sac_model_->optimizeModelCoefficients(ransac.inliers_, ransac.model_coefficients_,
                                               refined);
  const Eigen::Matrix3d rotation = refined.leftCols<3>();
  return Rigid3d{Eigen::Quaterniond(rotation), refined.col(3)}.Inverse();
}
#endif

std::vector<Contestant> Peers() {
  std::vector<Contestant> peers;
#ifdef SEXTANT_BENCH_OPENCV
  SolverRegistry opencv;
  AddOpenCvSolvers(opencv);
  peers = Solvers(opencv, {"opencv.magsac", "opencv.ransac_epnp"});
#endif
#ifdef SEXTANT_BENCH_OPENGV
  peers.push_back({"opengv ransac(kneip)", OpengvRansac});
#endif
  return peers;
}

// Two standard errors of the difference of two counts.
int TwoStandardErrors(int successes, int scenes) {
  const double share = static_cast<double>(successes) / scenes;
  return static_cast<int>(2.0 * std::sqrt(2.0 * scenes * share * (1.0 - share)));
}

// Prints one line for every goal that is missed.
int CountMisses(const OutlierStudy& study, const std::vector<OutlierCell>& cells,
                std::size_t contestants) {
  const std::size_t fractions = study.outlier_fractions.size();
  int misses = 0;
  for (std::size_t n = 0; n < study.pairs.size(); ++n) {
    for (std::size_t f = 0; f < fractions; ++f) {
      const auto cell = [&](std::size_t k) { return cells[(n * contestants + k) * fractions + f]; };
      int best_peer = 0;
      const std::size_t knows_inliers = contestants - 1;
      for (std::size_t k = std::size(kOurs); k < knows_inliers; ++k) {
        best_peer = std::max(best_peer, cell(k).successes);
      }
      for (std::size_t k = 0; k < kWithGoals; ++k) {
        const OutlierCell ours = cell(k);
        const bool must_not_fail = ours.pairs == 100 && ours.outlier_fraction <= 0.5;
        const int goal =
            must_not_fail ? ours.scenes : std::min(best_peer, cell(knows_inliers).successes);
        if (ours.successes + (must_not_fail ? 0 : TwoStandardErrors(goal, ours.scenes)) >= goal)
          continue;
        ++misses;
        std::printf("missed: %s, %d pairs, %.0f %% outliers: %d successes, goal %d\n",
                    ours.contestant.c_str(), ours.pairs, 100.0 * ours.outlier_fraction,
                    ours.successes, goal);
      }
    }
  }
  return misses;
}

int Main() {
  std::vector<Contestant> contestants =
      Solvers(BuiltinSolvers(), {std::begin(kOurs), std::end(kOurs)});
  const std::vector<Contestant> peers = Peers();
  contestants.insert(contestants.end(), peers.begin(), peers.end());
  contestants.push_back(ContestantThatKnowsInliers(*BuiltinSolvers().Make("refine(epnp)")));
  OutlierStudy study;
  study.threads = static_cast<int>(std::thread::hardware_concurrency());
  const std::vector<OutlierCell> cells = StudyOutliers(study, contestants);
  for (const int pairs : study.pairs) {
    std::printf("%d pairs: successes of %d scenes (wrong poses)\n%s\n", pairs, study.scenes,
                OutlierTable(cells, pairs).Plain().c_str());
  }
  const int misses = CountMisses(study, cells, contestants.size());
  for (const double sigma_px : {0.3, 1.0, 3.0, 10.0}) {
    OutlierStudy unknown = study;
    unknown.sigma_px = sigma_px;
    unknown.states_noise = false;
    unknown.pairs = {100};
    std::printf("100 pairs, %g px that no pair states\n%s\n", sigma_px,
                OutlierTable(StudyOutliers(unknown, contestants), 100).Plain().c_str());
  }
  return misses == 0 ? 0 : 1;
}

}  // namespace
}  // namespace sextant::bench

int main() { return sextant::bench::Main(); }
