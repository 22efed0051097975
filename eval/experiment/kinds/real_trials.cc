// SPDX-License-Identifier: Apache-2.0
#include "eval/experiment/kinds/real_trials.h"

#include <fmt/core.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>
#include <utility>

#include "base/median.h"
#include "base/random.h"
#include "base/units.h"
#include "solvers/core/evaluation.h"
#include "solvers/external/imported_solver.h"

namespace sextant {
namespace {

enum RealMeasured : int {
  kRealAnswered,
  kRealUsedShare,
  kReferenceDeg,
  kReferenceMm,
  kNearReference,
  kHeldOutPx,
  kHeldOutMm,
  kHalvesDeg,
  kHalvesMm,
  kHalvesWithin95,
  kSigmaMm,
};

// The pairs and raw views of each group of the data, by their places in the problem.
struct DataGroup {
  std::vector<std::size_t> points;
  std::vector<std::size_t> pixels;
  std::vector<std::size_t> views;
};

std::vector<DataGroup> GroupsOf(const CalibrationProblem& problem, ResampleBy by) {
  std::map<std::tuple<int, int, int>, DataGroup> groups;
  int next = 0;
  const auto group_of = [&](int view, int board, int corner) -> DataGroup& {
    switch (by) {
      case ResampleBy::kViews:
        return groups[{view, 0, 0}];
      case ResampleBy::kBoards:
        return groups[{view, board, 0}];
      case ResampleBy::kPairs:
        return groups[{view, board, corner + 1000 * next++}];
    }
    return groups[{0, 0, 0}];
  };
  for (std::size_t i = 0; i < problem.pairs_3d3d.size(); ++i) {
    const PairId& id = problem.pairs_3d3d[i].id;
    group_of(id.view, id.board, id.corner).points.push_back(i);
  }
  next = 0;
  for (std::size_t i = 0; i < problem.pairs_2d3d.size(); ++i) {
    const PairId& id = problem.pairs_2d3d[i].id;
    group_of(id.view, id.board, id.corner).pixels.push_back(i);
  }
  for (std::size_t i = 0; i < problem.board_views.size(); ++i) {
    const BoardView& view = problem.board_views[i];
    // A single pair has no raw view.
    if (by != ResampleBy::kPairs) group_of(view.view, view.board, 0).views.push_back(i);
  }
  std::vector<DataGroup> all;
  for (auto& [key, group] : groups) all.push_back(std::move(group));
  return all;
}

// The problem of the groups at `chosen`. A group that is drawn twice keeps its ids: its errors are
// the same.
CalibrationProblem ProblemOfGroups(const CalibrationProblem& problem,
                                   const std::vector<DataGroup>& groups,
                                   const std::vector<std::size_t>& chosen) {
  CalibrationProblem part;
  part.camera = problem.camera;
  part.boards = problem.boards;
  part.lidar_errors = problem.lidar_errors;
  part.initial_cam_from_lidar = problem.initial_cam_from_lidar;
  for (const std::size_t g : chosen) {
    for (const std::size_t i : groups[g].points) part.pairs_3d3d.push_back(problem.pairs_3d3d[i]);
    for (const std::size_t i : groups[g].pixels) part.pairs_2d3d.push_back(problem.pairs_2d3d[i]);
    for (const std::size_t i : groups[g].views) part.board_views.push_back(problem.board_views[i]);
  }
  return part;
}

struct Draw {
  std::vector<std::size_t> train;  ///< Ascending; with repetitions where drawn with replacement.
  std::vector<std::size_t> held_out;
};

Draw DrawGroups(std::size_t count, const RealSettings& settings, std::uint64_t seed) {
  Random random(seed);
  Draw draw;
  std::vector<bool> drawn(count, false);
  if (settings.resampling == Resampling::kBootstrap) {
    for (std::size_t i = 0; i < count; ++i) {
      const auto g = static_cast<std::size_t>(random.Below(count));
      draw.train.push_back(g);
      drawn[g] = true;
    }
    std::sort(draw.train.begin(), draw.train.end());
  } else {
    const double share = settings.resampling == Resampling::kHalves ? 0.5 : settings.held_out;
    const auto out = std::clamp<std::size_t>(
        static_cast<std::size_t>(std::lround(share * static_cast<double>(count))), 1, count - 1);
    std::vector<int> sample(count - out);
    random.Sample(static_cast<int>(count), sample);
    for (const int g : sample) drawn[static_cast<std::size_t>(g)] = true;
    for (std::size_t g = 0; g < count; ++g) {
      if (drawn[g]) draw.train.push_back(g);
    }
  }
  for (std::size_t g = 0; g < count; ++g) {
    if (!drawn[g]) draw.held_out.push_back(g);
  }
  return draw;
}

class RealTrials final : public Trials {
 public:
  RealTrials(CalibrationProblem problem, std::vector<DataGroup> groups,
             const std::optional<ReferencePose>& reference, const RealSettings& settings,
             std::vector<SolverPtr> solvers, std::string condition)
      : problem_(std::move(problem)),
        groups_(std::move(groups)),
        reference_(reference),
        settings_(settings),
        solvers_(std::move(solvers)),
        condition_(std::move(condition)) {
    for (const SolverPtr& solver : solvers_) names_.push_back(solver->spec().name);
  }

  const std::vector<std::string>& subjects() const override { return names_; }

  Expected<CalibrationProblem> ProblemOf(const TrialId& id) const override {
    return ProblemOfGroups(problem_, groups_, DrawGroups(groups_.size(), settings_, id.seed).train);
  }

  void Run(const TrialId& id, TrialRows& rows) const override {
    const Draw draw = DrawGroups(groups_.size(), settings_, id.seed);
    const CalibrationProblem train = ProblemOfGroups(problem_, groups_, draw.train);
    const CalibrationProblem held_out = ProblemOfGroups(problem_, groups_, draw.held_out);
    for (std::size_t k = 0; k < solvers_.size(); ++k) {
      MetricValues values = rows.Add(static_cast<int>(k));
      const Expected<SolveReport> report = SolveTrial(*solvers_[k], train, condition_, id.trial);
      if (!report) {
        MeasureNoAnswer(reference_.has_value(), values);
        continue;
      }
      values.Set(kRealAnswered, 1.0);
      MeasureAnswer(*report, solvers_[k]->spec().needs, train, values);
      MeasureHeldOut(*report, held_out, values);
      if (settings_.resampling == Resampling::kHalves) {
        const Expected<SolveReport> other = solvers_[k]->Solve(held_out);
        if (other) MeasureHalves(*report, *other, values);
      }
    }
  }

 private:
  void MeasureAnswer(const SolveReport& report, const DataNeeds& needs,
                     const CalibrationProblem& train, MetricValues& values) const {
    // Inliers are of one kind of pairs.
    const auto pairs = static_cast<double>(needs.pairs_3d3d > 0 ? train.pairs_3d3d.size()
                                                                : train.pairs_2d3d.size());
    if (!report.inliers.empty()) {
      values.Set(kRealUsedShare, static_cast<double>(report.inliers.size()) / pairs);
    }
    if (report.covariance) {
      values.Set(kSigmaMm,
                 kMmPerM * std::sqrt(report.covariance->bottomRightCorner<3, 3>().trace()));
    }
    if (!reference_) return;
    const PoseDistance off = DistanceBetween(report.cam_from_lidar, reference_->cam_from_lidar);
    const double deg = kDegPerRad * off.rotation_rad;
    const double mm = kMmPerM * off.translation_m;
    values.Set(kReferenceDeg, deg);
    values.Set(kReferenceMm, mm);
    values.Set(kNearReference,
               deg <= settings_.success_deg && mm <= settings_.success_mm ? 1.0 : 0.0);
  }

  // Medians, because wrong pairs are held out, too.
  static void MeasureHeldOut(const SolveReport& report, const CalibrationProblem& held_out,
                             MetricValues& values) {
    const Camera* camera = report.camera ? &report.camera->camera : nullptr;
    CalibrationProblem seen = held_out;
    if (camera != nullptr) seen.camera = *camera;
    Evaluation evaluation = Evaluate(seen, report.cam_from_lidar);
    if (!evaluation.per_pair_px.empty()) values.Set(kHeldOutPx, Median(evaluation.per_pair_px));
    if (!evaluation.per_pair_m.empty()) {
      values.Set(kHeldOutMm, kMmPerM * Median(evaluation.per_pair_m));
    }
  }

  static void MeasureHalves(const SolveReport& one, const SolveReport& other,
                            MetricValues& values) {
    constexpr double kChiSquared6At95 = 12.5916;
    const PoseDistance off = DistanceBetween(one.cam_from_lidar, other.cam_from_lidar);
    values.Set(kHalvesDeg, kDegPerRad * off.rotation_rad);
    values.Set(kHalvesMm, kMmPerM * off.translation_m);
    if (!one.covariance || !other.covariance) return;
    const Matrix6d covariance = *one.covariance + *other.covariance;
    const Vector6d difference = PoseDifference(one.cam_from_lidar, other.cam_from_lidar);
    const double squared = difference.dot(covariance.ldlt().solve(difference));
    values.Set(kHalvesWithin95, squared <= kChiSquared6At95 ? 1.0 : 0.0);
  }

  CalibrationProblem problem_;
  std::vector<DataGroup> groups_;
  std::optional<ReferencePose> reference_;
  RealSettings settings_;
  std::vector<SolverPtr> solvers_;
  std::string condition_;
  std::vector<std::string> names_;
};

}  // namespace

void MeasureNoAnswer(bool has_reference, MetricValues values) {
  values.Set(kRealAnswered, 0.0);
  if (has_reference) values.Set(kNearReference, 0.0);
}

const ParameterSet<RealSettings>& RealParameters() {
  static const ParameterSet<RealSettings> set =
      ParameterSet<RealSettings>()
          .Text("manifest", &RealSettings::manifest, "path",
                "the data set: a manifest, relative to the experiment file")
          .Choice("resample", &RealSettings::resampling, {"bootstrap", "halves", "held_out"},
                  "how a trial draws from the data; the rest is held out")
          .Choice("by", &RealSettings::by, {"views", "boards", "pairs"}, "what is drawn as one")
          .Real("held_out", &RealSettings::held_out, "1", 0.01, 0.9,
                "the share that resample: held_out leaves out")
          .Real("success_deg", &RealSettings::success_deg, "deg", 0.0, 180.0,
                "largest angle to the reference of near_reference")
          .Real("success_mm", &RealSettings::success_mm, "mm", 0.0, 1e6,
                "largest distance to the reference of near_reference");
  return set;
}

const std::vector<Metric>& RealMetrics() {
  static const std::vector<Metric> metrics = {
      {"answered", "1 if the solver returned a pose, 0 if it returned an error"},
      {"used_share", "share of the pairs of the solver's kind that the answer is based on"},
      {"reference_deg", "angle between the answer's rotation and the reference's"},
      {"reference_mm", "distance between the answer's translation and the reference's"},
      {"near_reference", "1 if both are within success_deg and success_mm, else 0"},
      {"held_out_px", "median distance of the pixels that were held out from their projections"},
      {"held_out_mm", "median distance of the 3D-3D pairs that were held out"},
      {"halves_deg", "angle between the answers to two halves of the data"},
      {"halves_mm", "distance between the answers to two halves of the data"},
      {"halves_within95",
       "1 if the answers to two halves differ by no more than the 95 percent region of their "
       "stated "
       "covariances, else 0"},
      {"sigma_mm", "stated standard deviation of the translation, root of the sum of variances"},
  };
  return metrics;
}

Expected<TrialsPtr> MakeRealTrials(CalibrationProblem problem,
                                   const std::optional<ReferencePose>& reference,
                                   const RealSettings& settings, std::vector<SolverPtr> solvers,
                                   const std::string& condition) {
  constexpr std::size_t kMinGroups = 3;
  std::vector<DataGroup> groups = GroupsOf(problem, settings.by);
  if (groups.size() < kMinGroups) {
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("the data has {} groups to draw from, expected at least {}; "
                                 "resample it by boards or pairs",
                                 groups.size(), kMinGroups));
  }
  return std::make_shared<RealTrials>(std::move(problem), std::move(groups), reference, settings,
                                      std::move(solvers), condition);
}

Expected<std::vector<SolverPtr>> SolversFor(const CalibrationProblem& problem,
                                            std::vector<SolverPtr> solvers) {
  std::string reasons;
  std::erase_if(solvers, [&](const SolverPtr& solver) {
    const Expected<void> met = CheckProblem(problem, solver->spec());
    if (!met) reasons += fmt::format("; {}", met.error().message);
    return !met;
  });
  if (solvers.empty()) {
    return MakeError(ErrorCode::kMissingData, "none of the solvers can use this data" + reasons);
  }
  return solvers;
}

}  // namespace sextant
