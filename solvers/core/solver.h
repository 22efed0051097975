// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "base/error.h"
#include "geometry/calibration_problem.h"
#include "solvers/core/board_view_fit.h"
#include "solvers/core/camera_estimate.h"
#include "solvers/core/evaluation.h"

namespace sextant {

/// The least data that a solver can work with; 0 where it does not look at that kind.
struct DataNeeds {
  int pairs_3d3d = 0;
  int pairs_2d3d = 0;  ///< Also needs the camera.
  int points_per_set = 0;
  int board_views = 0;  ///< Also needs the camera and the boards.
  bool initial_pose = false;
  bool points_on_plane = false;  ///< Works where all points in the LiDAR frame lie on one plane.
};

/// What a solver is and promises; the contract tests hold it to this.
struct SolverSpec {
  std::string name;  ///< Canonical: makes the same solver when parsed again.
  DataNeeds needs = {};
  bool estimates_rotation = true;  ///< False: the rotation of the initial pose is taken as given.
  bool is_global = true;           ///< False: finds the optimum near its start only.
  bool estimates_camera = false;   ///< Its pose goes with another camera than the problem's.
};

/// Whether it finds all six degrees of freedom from anywhere, unlike baselines and local searches.
inline bool FindsWholePose(const SolverSpec& spec) {
  return spec.is_global && spec.estimates_rotation;
}

enum class Termination {
  kClosedForm,     ///< The optimum by formula, or a search that is finite by construction.
  kConverged,      ///< The method's own stopping inequality holds; stated in its header.
  kMaxIterations,  ///< Stopped by the limit; the answer is the best so far.
};
std::string_view ToString(Termination termination);

/// A step on the way to the answer of a composed solver.
struct Stage {
  std::string solver;
  Rigid3d cam_from_lidar;
  int iterations = 0;
  double wall_time_us = 0.0;
};

/// What a method returns of itself; Solver::Solve completes it to a SolveReport.
struct Estimate {
  Rigid3d cam_from_lidar;
  Termination termination = Termination::kClosedForm;
  int iterations = 0;
  /// Indices, ascending, of the pairs that the answer rests on (the 3D-3D ones where the solver
  /// needs both kinds); empty for point sets.
  std::vector<int> inliers;
  /// Of (dphi [rad], dt [m]); see Perturb. None where the data leaves no residual to judge by.
  std::optional<Matrix6d> covariance;
  /// Where the solver estimates the camera too; the covariance of the pose then accounts for it.
  std::optional<CameraEstimate> camera;
  /// What else was estimated: a range bias of the LiDAR, sizes of boards.
  std::vector<EstimatedNumber> extras;
  /// What the reader of the answer must know, each a sentence: what was asked for and could not be
  /// told, data that contradicts its stated noise.
  std::vector<std::string> warnings;
  /// Where the solver works on raw observations: of each of problem.board_views, in their order.
  std::vector<BoardViewFit> board_views;
  /// Other poses that explain the data about as well, best first (p3p, ippe).
  std::vector<Rigid3d> alternatives;
  std::vector<Stage> stages;
};

struct SolveReport : Estimate {
  std::string solver;
  double wall_time_us = 0.0;
  Evaluation evaluation;  ///< Of the answer with its camera, over all data of the problem.
};

/// A way to find cam_from_lidar. Immutable, deterministic, thread-safe.
class Solver {
 public:
  virtual ~Solver() = default;
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;

  const SolverSpec& spec() const { return spec_; }

  /// Checks that the problem has what the solver needs and that it is finite, solves, times and
  /// evaluates. Errors: kMissingData, kTooFewPairs, kNonFinite, kInvalidInput, and those of the
  /// method itself.
  Expected<SolveReport> Solve(const CalibrationProblem& problem) const;

  /// Appends every pose that explains the sampled pairs (indices into the kind of pairs that the
  /// solver needs) to `poses`; none where the sample is degenerate. The inner loop of consensus
  /// combinators: no checks, no covariance. The problem must have passed CheckProblem.
  void Hypothesize(const CalibrationProblem& problem, std::span<const int> sample,
                   std::vector<Rigid3d>& poses) const {
    DoHypothesize(problem, sample, poses);
  }

 protected:
  explicit Solver(SolverSpec spec) : spec_(std::move(spec)) {}

  /// Solves the sample as a problem of its own; overrides are faster, and may fall back on it.
  virtual void DoHypothesize(const CalibrationProblem& problem, std::span<const int> sample,
                             std::vector<Rigid3d>& poses) const;

 private:
  virtual Expected<Estimate> DoSolve(const CalibrationProblem& problem) const = 0;

  SolverSpec spec_;
};

using SolverPtr = std::shared_ptr<const Solver>;

/// Whether the problem meets the needs, with finite numbers; the error names the first that fails.
Expected<void> CheckProblem(const CalibrationProblem& problem, const SolverSpec& spec);

}  // namespace sextant
