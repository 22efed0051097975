// SPDX-License-Identifier: Apache-2.0
#include "solvers/pnp/p3p_solver.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>
#include <utility>

#include "geometry/residuals.h"
#include "solvers/core/registry.h"
#include "solvers/kernels/p3p.h"
#include "solvers/kernels/pair_terms.h"
#include "solvers/least_squares/refine_pose.h"
#include "solvers/pnp/explained.h"
#include "solvers/pnp/reprojection_covariance.h"

namespace sextant {
namespace {

// More points gain little: the triples of the outermost five include one close to the best.
constexpr std::size_t kMaxCorners = 5;

// Pairs far apart in the image: the one farthest from the centre, then repeatedly the one farthest
// from those chosen; of equal ones the first.
std::vector<std::size_t> SpreadPairs(std::span<const Pair2d3d> pairs) {
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const Pair2d3d& pair : pairs) sum += pair.pixel;
  const Eigen::Vector2d centre = sum / static_cast<double>(pairs.size());
  std::vector<double> distances;
  distances.reserve(pairs.size());
  for (const Pair2d3d& pair : pairs) distances.push_back((pair.pixel - centre).norm());
  std::vector<std::size_t> chosen;
  while (chosen.size() < std::min(kMaxCorners, pairs.size())) {
    const auto farthest = std::max_element(distances.begin(), distances.end());
    chosen.push_back(static_cast<std::size_t>(farthest - distances.begin()));
    const Eigen::Vector2d& pixel = pairs[chosen.back()].pixel;
    for (std::size_t i = 0; i < pairs.size(); ++i) {
      const double distance = (pairs[i].pixel - pixel).norm();
      distances[i] = chosen.size() == 1 ? distance : std::min(distances[i], distance);
    }
    for (const std::size_t i : chosen) distances[i] = -1.0;
  }
  return chosen;
}

std::vector<Triple> TriplesOf(const std::vector<std::size_t>& chosen) {
  std::vector<Triple> triples;
  for (std::size_t i = 0; i < chosen.size(); ++i) {
    for (std::size_t j = i + 1; j < chosen.size(); ++j) {
      for (std::size_t k = j + 1; k < chosen.size(); ++k) {
        triples.push_back({chosen[i], chosen[j], chosen[k]});
      }
    }
  }
  return triples;
}

// Whether the points of a triple are so close to a line that the rotation about it is lost in
// rounding, by the criterion of SolveP3p.
bool IsFlat(std::span<const Pair2d3d> pairs, const Triple& triple) {
  const Eigen::Vector3d& origin = pairs[triple[0]].point_in_lidar;
  const Eigen::Vector3d a = pairs[triple[1]].point_in_lidar - origin;
  const Eigen::Vector3d b = pairs[triple[2]].point_in_lidar - origin;
  return !(a.cross(b).norm() > 1e-6 * std::max(a.squaredNorm(), b.squaredNorm()));
}

// The misfit of a pose: the number of points that it does not project, then squared pixels. The sum
// stops early once it exceeds `give_up`.
using Misfit = std::pair<int, double>;

Misfit MisfitOf(const CalibrationProblem& problem, const Rigid3d& pose, const Misfit& give_up) {
  Misfit misfit{0, 0.0};
  for (const Pair2d3d& pair : problem.pairs_2d3d) {
    const auto residual = ReprojectionResidual(*problem.camera, pose, pair);
    if (residual) {
      misfit.second += residual->squaredNorm();
    } else {
      ++misfit.first;
    }
    if (misfit > give_up) break;
  }
  return misfit;
}

struct TriplePoses {
  std::array<Rigid3d, kMaxP3pPoses> poses;
  int count = 0;
};

template <class Indices>
TriplePoses SolveTriple(const CalibrationProblem& problem, const Indices& indices) {
  TriplePoses found;
  std::array<Eigen::Vector3d, 3> rays;
  std::array<Eigen::Vector3d, 3> points;
  for (std::size_t i = 0; i < 3; ++i) {
    const Pair2d3d& pair = problem.pairs_2d3d[static_cast<std::size_t>(indices[i])];
    const std::optional<Eigen::Vector3d> ray = Unproject(*problem.camera, pair.pixel);
    if (!ray) return found;
    rays[i] = *ray;
    points[i] = pair.point_in_lidar;
  }
  found.count = SolveP3p(rays, points, found.poses);
  return found;
}

// The triples by how little their pixel noise perturbs the projections of all pairs, at a pose near
// the solution; those that determine no pose there last. The order does not use residuals, so that
// the covariance of the solution stays unbiased.
std::vector<Triple> SteadiestFirst(const CalibrationProblem& problem, std::vector<Triple> triples,
                                   const Rigid3d& near_answer) {
  const Camera& camera = *problem.camera;
  const std::vector<Pair2d3d>& pairs = problem.pairs_2d3d;
  const auto information = ProjectionInformation(camera, pairs, near_answer);
  if (!information) return triples;
  std::vector<std::pair<double, Triple>> rated;
  for (const Triple& triple : triples) {
    const auto covariance = RelativeTripleCovariance(camera, pairs, triple, near_answer);
    const double variance = covariance ? covariance->cwiseProduct(*information).sum()
                                       : std::numeric_limits<double>::infinity();
    rated.emplace_back(std::isnan(variance) ? std::numeric_limits<double>::infinity() : variance,
                       triple);
  }
  std::ranges::stable_sort(rated, {}, [](const auto& r) { return r.first; });
  std::ranges::transform(rated, triples.begin(), [](const auto& r) { return r.second; });
  return triples;
}

// Whether a pose leaves far more than another. Where noise makes two solutions of a triple complex,
// its others, at which the triple fits as exactly, are elsewhere.
bool IsFarWorse(const Misfit& misfit, const Misfit& least, std::size_t pairs) {
  constexpr double kFarWorse = 400.0;  // Twenty times the RMSE.
  constexpr double kRounding_px2 = 1e-12;
  if (misfit.first != least.first) return misfit.first > least.first;
  return misfit.second > kFarWorse * least.second + kRounding_px2 * static_cast<double>(pairs);
}

/// Solves the three of the outermost pairs that determine the pose best; the others only select one
/// of the solutions. With exactly three pairs the alternatives are as good as the answer.
class P3pSolver final : public Solver {
 public:
  explicit P3pSolver(const std::string& name)
      : Solver({.name = name, .needs = {.pairs_2d3d = 3}}) {}

 private:
  Expected<Estimate> DoSolve(const CalibrationProblem& problem) const override {
    const std::vector<Triple> triples = TriplesOf(SpreadPairs(problem.pairs_2d3d));
    std::vector<Rigid3d> poses;
    for (const Triple& triple : triples) Append(SolveTriple(problem, triple), poses);
    if (poses.empty()) return Refusal(problem, triples);
    Triple triple = triples.front();
    if (triples.size() > 1) {
      const Steady steady = SteadyPose(problem, triples, Best(problem, poses));
      triple = steady.triple;
      poses = {steady.pose};
    }
    if (Expected<void> ok = CheckExplained(*problem.camera, problem.pairs_2d3d, poses.front());
        !ok) {
      return MakeError(ok.error().code, spec().name + ": " + ok.error().message);
    }
    if (triples.size() > 1) {
      if (auto lost = PoseWithoutTriple(problem, poses.front())) return *std::move(lost);
    }
    Estimate estimate;
    estimate.cam_from_lidar = poses.front();
    estimate.alternatives.assign(poses.begin() + 1, poses.end());
    estimate.inliers.resize(problem.pairs_2d3d.size());
    std::iota(estimate.inliers.begin(), estimate.inliers.end(), 0);
    estimate.covariance =
        TripleCovariance(*problem.camera, problem.pairs_2d3d, triple, estimate.cam_from_lidar);
    return estimate;
  }

  struct Steady {
    Rigid3d pose;
    Triple triple;
  };

  // The pose of the steadiest triple that has one near the best.
  static Steady SteadyPose(const CalibrationProblem& problem, const std::vector<Triple>& triples,
                           const Rigid3d& best) {
    constexpr Misfit kNone{std::numeric_limits<int>::max(), 0.0};
    const Misfit least = MisfitOf(problem, best, kNone);
    const std::vector<Triple> sorted = SteadiestFirst(problem, triples, best);
    for (const Triple& triple : sorted) {
      std::vector<Rigid3d> poses;
      Append(SolveTriple(problem, triple), poses);
      if (poses.empty()) continue;
      const Rigid3d pose = Best(problem, poses);
      if (!IsFarWorse(MisfitOf(problem, pose, kNone), least, problem.pairs_2d3d.size())) {
        return {pose, triple};
      }
    }
    return {best, sorted.front()};
  }

  // Near a double solution noise can deprive every triple of the pose: least squares of all pairs,
  // where these are few, then explains them far better than any triple.
  std::optional<Estimate> PoseWithoutTriple(const CalibrationProblem& problem,
                                            const Rigid3d& best) const {
    constexpr Misfit kNone{std::numeric_limits<int>::max(), 0.0};
    constexpr RefineLimits kLimits = {.max_iterations = 50, .step_tolerance = 1e-10};
    const std::size_t pairs = problem.pairs_2d3d.size();
    const Misfit misfit = MisfitOf(problem, best, kNone);
    if (pairs > kMaxCorners || misfit.first > 0) return std::nullopt;
    const PairTerms terms = MakeTerms(problem, PairKind::k2d3d);
    const RefinedPose refined = RefinePose(terms.View(), best, kLimits);
    if (!refined.cam_from_lidar.IsFinite()) return std::nullopt;
    const Misfit least = MisfitOf(problem, refined.cam_from_lidar, kNone);
    if (!IsFarWorse(misfit, least, pairs)) return std::nullopt;
    Estimate estimate;
    estimate.cam_from_lidar = refined.cam_from_lidar;
    estimate.iterations = refined.iterations;
    estimate.inliers.resize(pairs);
    std::iota(estimate.inliers.begin(), estimate.inliers.end(), 0);
    estimate.covariance =
        ReprojectionCovariance(*problem.camera, problem.pairs_2d3d, estimate.cam_from_lidar);
    estimate.warnings.push_back(
        spec().name +
        ": noise leaves no three pixels an exact pose near that of all; the answer "
        "is least squares of the pixels");
    return estimate;
  }

  static void Append(const TriplePoses& found, std::vector<Rigid3d>& poses) {
    poses.insert(poses.end(), found.poses.begin(), found.poses.begin() + found.count);
  }

  static Rigid3d Best(const CalibrationProblem& problem, const std::vector<Rigid3d>& poses) {
    const Rigid3d* best = &poses.front();
    Misfit least{std::numeric_limits<int>::max(), 0.0};
    for (const Rigid3d& pose : poses) {
      const Misfit misfit = MisfitOf(problem, pose, least);
      if (!(misfit < least)) continue;
      least = misfit;
      best = &pose;
    }
    return *best;
  }

  void DoHypothesize(const CalibrationProblem& problem, std::span<const int> sample,
                     std::vector<Rigid3d>& poses) const override {
    if (sample.size() > 3) {
      Solver::DoHypothesize(problem, sample, poses);
      return;
    }
    Append(SolveTriple(problem, sample), poses);
  }

  tl::unexpected<Error> Refusal(const CalibrationProblem& problem,
                                const std::vector<Triple>& triples) const {
    if (std::all_of(triples.begin(), triples.end(),
                    [&](const Triple& triple) { return IsFlat(problem.pairs_2d3d, triple); })) {
      return MakeError(ErrorCode::kDegenerate,
                       spec().name +
                           ": the points coincide or lie on one line, which leaves a rotation "
                           "undetermined; use points that span a plane");
    }
    return MakeError(ErrorCode::kNoConsensus,
                     spec().name +
                         ": no pose in front of the camera sees the outermost points at their "
                         "pixels; check the pairing, the units and the camera");
  }
};

}  // namespace

bool IsP3pOfPinhole(const Solver& solver, const CalibrationProblem& problem) {
  return problem.camera && problem.camera->model == CameraModel::kPinhole &&
         dynamic_cast<const P3pSolver*>(&solver) != nullptr;
}

SolverPtr MakeP3p() { return std::make_shared<P3pSolver>("p3p"); }

SolverEntry P3pEntry() {
  return {
      .name = "p3p",
      .summary =
          "exact pose of the three best placed pixels; the others choose among its solutions",
      .needs = "3 or more 2D-3D pairs, not on one line; with 3 the answer is ambiguous",
      .reference = "Ding et al. 2023 (CVPR), Persson and Nordberg 2018 (ECCV)",
      .example = "p3p",
      .make = [](const SolverArguments& arguments) -> Expected<SolverPtr> {
        return std::make_shared<P3pSolver>(arguments.name);
      },
  };
}

}  // namespace sextant
