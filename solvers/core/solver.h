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
#include "solvers/core/noise_estimate.h"

namespace sextant {

/// The minimum data that a solver can work with; 0 where it does not use that kind.
struct DataNeeds {
  int pairs_3d3d = 0;
  int pairs_2d3d = 0;  ///< Also needs the camera.
  int points_per_set = 0;
  int board_views = 0;  ///< Also needs the camera and the boards.
  bool initial_pose = false;
  bool points_on_plane = false;  ///< Works where all points in the LiDAR frame lie on one plane.
};

/// Properties of a solver, which the contract tests check.
struct SolverSpec {
  std::string name;  ///< Canonical spec: makes the same solver when parsed again.
  DataNeeds needs = {};
  bool estimates_rotation = true;  ///< False: keeps the rotation of the initial pose.
  bool is_global = true;           ///< False: finds only the optimum near its start.
  bool estimates_camera = false;   ///< The pose belongs to a camera that it estimates too.
};

/// Whether it finds all six degrees of freedom from any start, unlike baselines and local searches.
inline bool FindsWholePose(const SolverSpec& spec) {
  return spec.is_global && spec.estimates_rotation;
}

enum class Termination {
  kClosedForm,     ///< A formula, or a search that is finite by construction.
  kConverged,      ///< The stopping inequality stated in the solver's comment holds.
  kMaxIterations,  ///< Stopped by the limit; the answer is the best so far.
};
std::string_view ToString(Termination termination);

/// One stage of a composed solver.
struct Stage {
  std::string solver;
  Rigid3d cam_from_lidar;
  int iterations = 0;
  double wall_time_us = 0.0;
};

/// The result of a solver's own method; Solver::Solve completes it to a SolveReport.
struct Estimate {
  Rigid3d cam_from_lidar;
  Termination termination = Termination::kClosedForm;
  int iterations = 0;
  /// Indices, ascending, of the pairs that the answer is based on (the 3D-3D ones where the solver
  /// needs both kinds); empty for point sets.
  std::vector<int> inliers;
  /// For (dphi [rad], dt [m]); see Perturb. None where there is no redundant data to estimate it.
  std::optional<Matrix6d> covariance;
  /// The noise that the covariance is based on; none where the pairs state theirs, and for solvers
  /// that use no pairs.
  std::optional<NoiseEstimate> noise;
  /// Set where the solver estimates the camera too; the covariance of the pose then accounts for
  /// it.
  std::optional<CameraEstimate> camera;
  /// Other estimated numbers: a range bias of the LiDAR, sizes of boards.
  std::vector<EstimatedNumber> extras;
  /// One sentence each: parameters that could not be estimated, data that contradicts its stated
  /// noise.
  std::vector<std::string> warnings;
  /// One for each of problem.board_views, in their order, where the solver uses raw observations.
  std::vector<BoardViewFit> board_views;
  /// Other poses that explain the data about as well, best first: see FindLikelyPoses and
  /// FindRivals, which complete what the solver itself found.
  std::vector<Rigid3d> alternatives;
  std::vector<Stage> stages;
};

struct SolveReport : Estimate {
  std::string solver;
  double wall_time_us = 0.0;  ///< NaN where it is not known: a pose that another program found.
  Evaluation evaluation;      ///< The pose with its camera, over all data of the problem.
};

/// A method that finds cam_from_lidar. Immutable, deterministic, thread-safe.
class Solver {
 public:
  virtual ~Solver() = default;
  Solver(const Solver&) = delete;
  Solver& operator=(const Solver&) = delete;

  const SolverSpec& spec() const { return spec_; }

  /// Checks that the problem has the data that the solver needs and that it is finite; solves, in
  /// coordinates near the data (LocalFrame), completes the covariance where the noise is not
  /// stated, measures the time, finds alternatives and evaluates. Errors: kMissingData,
  /// kTooFewPairs, kNonFinite, kInvalidInput, kNoConsensus (CheckPlausible), and those of the
  /// method itself.
  Expected<SolveReport> Solve(const CalibrationProblem& problem) const;

  /// Appends every pose that explains the sampled pairs (indices into the kind of pairs that the
  /// solver needs) to `poses`; none where the sample is degenerate. This is the inner loop of the
  /// robust solvers: no checks, no covariance. The problem must have passed CheckProblem.
  void Hypothesize(const CalibrationProblem& problem, std::span<const int> sample,
                   std::vector<Rigid3d>& poses) const {
    DoHypothesize(problem, sample, poses);
  }

 protected:
  explicit Solver(SolverSpec spec) : spec_(std::move(spec)) {}

  /// Solves the sample as a separate problem; overrides are faster and may fall back on this.
  virtual void DoHypothesize(const CalibrationProblem& problem, std::span<const int> sample,
                             std::vector<Rigid3d>& poses) const;

 private:
  virtual Expected<Estimate> DoSolve(const CalibrationProblem& problem) const = 0;

  /// The answer at the minimum next to `start`, for the pairs of `answer`: for solvers whose answer
  /// is the lowest of several minima. None: `answer` stays, whatever other poses explain the data.
  virtual std::optional<Estimate> DoSolveFrom(const CalibrationProblem& /*problem*/,
                                              const Estimate& /*answer*/,
                                              const Rigid3d& /*start*/) const {
    return std::nullopt;
  }

  Expected<Estimate> SolveWithAlternatives(const CalibrationProblem& problem) const;
  Expected<SolveReport> SolveAndEvaluate(const CalibrationProblem& problem) const;
  Expected<SolveReport> SolveSeenPairs(const CalibrationProblem& problem) const;

  SolverSpec spec_;
};

using SolverPtr = std::shared_ptr<const Solver>;

/// Whether the problem meets the needs, with finite numbers. The error names the first that it does
/// not meet.
Expected<void> CheckProblem(const CalibrationProblem& problem, const SolverSpec& spec);

}  // namespace sextant
