// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/trust.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <map>
#include <string>

#include "base/random.h"
#include "calibrate/trust/halves.h"
#include "calibrate/trust/outlier_views.h"
#include "calibrate/trust/select_views.h"
#include "calibrate/trust/stated_covariance.h"
#include "calibrate/trust/trust_text.h"
#include "solvers/joint/view_comparison.h"

namespace sextant {
namespace {

using Poses = std::vector<std::optional<Rigid3d>>;

std::optional<Rigid3d> PoseOf(const CalibrationProblem& problem, const Solver& solver) {
  const Expected<SolveReport> report = solver.Solve(problem);
  if (!report) return std::nullopt;
  return report->cam_from_lidar;
}

// Groups of views that are left out or drawn together, in the order of their first views.
using ViewGroups = std::vector<std::vector<int>>;

ViewGroups GroupsOf(const std::vector<int>& views, const ViewGroups& together) {
  ViewGroups groups;
  std::map<std::size_t, std::size_t> place;  // In `groups`, by the place in `together`.
  for (const int view : views) {
    const auto shared = std::ranges::find_if(together, [view](const std::vector<int>& group) {
      return std::ranges::find(group, view) != group.end();
    });
    if (shared == together.end()) {
      groups.push_back({view});
      continue;
    }
    const auto [entry, is_first] =
        place.try_emplace(static_cast<std::size_t>(shared - together.begin()), groups.size());
    if (is_first) groups.emplace_back();
    groups[entry->second].push_back(view);
  }
  return groups;
}

// The pose without each fold; none where the solver finds none.
Poses SolveFolds(const CalibrationProblem& problem, const Solver& solver, const ViewGroups& groups,
                 std::size_t folds, ProgressCounter& counter) {
  Poses answers(folds);
  tbb::parallel_for(std::size_t{0}, folds, [&](std::size_t fold) {
    std::vector<int> others;
    for (std::size_t i = 0; i < groups.size(); ++i) {
      if (i % folds != fold) others.insert(others.end(), groups[i].begin(), groups[i].end());
    }
    answers[fold] = PoseOf(SelectViews(problem, others), solver);
    counter.Step();
  });
  return answers;
}

Poses SolveResamples(const CalibrationProblem& problem, const Solver& solver,
                     const ViewGroups& groups, const TrustOptions& options,
                     ProgressCounter& counter) {
  Poses answers(static_cast<std::size_t>(options.bootstrap_samples));
  const auto solve = [&](std::size_t draw) {
    Random random(DeriveSeed(options.seed, "bootstrap of views", 0, draw));
    std::vector<int> drawn;
    for (std::size_t i = 0; i < groups.size(); ++i) {
      const std::vector<int>& group = groups[random.Below(groups.size())];
      drawn.insert(drawn.end(), group.begin(), group.end());
    }
    answers[draw] = PoseOf(ResampleViews(problem, drawn), solver);
    counter.Step();
  };
  // One draw a task: where the progress callback throws, tasks that have begun run to their end.
  tbb::parallel_for(std::size_t{0}, answers.size(), solve, tbb::simple_partitioner());
  return answers;
}

std::vector<Vector6d> DifferencesFrom(const Rigid3d& reference, const Poses& poses) {
  std::vector<Vector6d> differences;
  for (const std::optional<Rigid3d>& pose : poses) {
    if (pose) differences.push_back(PoseDifference(*pose, reference));
  }
  return differences;
}

// Sum of squared deviations from the mean, per axis.
Vector6d ScatterOf(const std::vector<Vector6d>& differences) {
  Vector6d mean = Vector6d::Zero();
  for (const Vector6d& d : differences) mean += d / static_cast<double>(differences.size());
  Vector6d scatter = Vector6d::Zero();
  for (const Vector6d& d : differences) scatter += (d - mean).cwiseAbs2();
  return scatter;
}

Matrix6d SampleCovariance(const std::vector<Vector6d>& differences) {
  Vector6d mean = Vector6d::Zero();
  for (const Vector6d& d : differences) mean += d / static_cast<double>(differences.size());
  Matrix6d covariance = Matrix6d::Zero();
  for (const Vector6d& d : differences) covariance += (d - mean) * (d - mean).transpose();
  return covariance / static_cast<double>(differences.size() - 1);
}

// Linear interpolation between the order statistics.
double Quantile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const double place = share * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  const double part = place - static_cast<double>(below);
  return (1.0 - part) * values[below] + part * values[above];
}

void AddBootstrap(const std::vector<Vector6d>& differences, const TrustOptions& options,
                  TrustFigures& figures) {
  BootstrapFigures& bootstrap = figures.bootstrap.emplace();
  bootstrap.level = options.level;
  bootstrap.samples = static_cast<int>(differences.size());
  bootstrap.unanswered = options.bootstrap_samples - bootstrap.samples;
  for (int axis = 0; axis < 6; ++axis) {
    std::vector<double> values;
    for (const Vector6d& d : differences) values.push_back(d[axis]);
    bootstrap.low[axis] = Quantile(values, 0.5 * (1.0 - options.level));
    bootstrap.high[axis] = Quantile(values, 0.5 * (1.0 + options.level));
  }
  figures.bootstrap_sigma =
      (ScatterOf(differences) / static_cast<double>(differences.size() - 1)).cwiseSqrt();
}

void AddJackknife(const std::vector<Vector6d>& of_folds, TrustFigures& figures) {
  const double g = figures.folds;
  if (of_folds.size() < 2 || static_cast<double>(of_folds.size()) != g) return;
  figures.jackknife_sigma = ((g - 1.0) / g * ScatterOf(of_folds)).cwiseSqrt();
}

Vector6d SigmaOf(const Matrix6d& covariance) {
  return covariance.diagonal().cwiseMax(0.0).cwiseSqrt();
}

// Geometric mean of a / b over the axes; none where an axis has zero sigma.
std::optional<double> MeanRatio(const std::optional<Vector6d>& a,
                                const std::optional<Vector6d>& b) {
  if (!a || !b || !(a->minCoeff() > 0.0) || !(b->minCoeff() > 0.0)) return std::nullopt;
  return std::exp((a->array().log() - b->array().log()).mean());
}

// Root mean square of the finite residuals of a view.
class ViewRms {
 public:
  void Add(double residual) {
    if (!std::isfinite(residual)) return;
    squares_ += residual * residual;
    ++count_;
  }
  void Add(const ViewRms& other) {
    squares_ += other.squares_;
    count_ += other.count_;
  }
  std::optional<double> Value() const {
    if (count_ == 0) return std::nullopt;
    return std::sqrt(squares_ / count_);
  }

 private:
  double squares_ = 0.0;
  int count_ = 0;
};

struct ViewFit {
  ViewRms metres;
  ViewRms pixels;
};

// The residuals of one view under a pose.
ViewFit FitOf(const CalibrationProblem& problem, int view, const Rigid3d& pose) {
  ViewFit fit;
  const Evaluation evaluation = Evaluate(SelectViews(problem, {&view, 1}), pose);
  for (const double r : evaluation.per_pair_m) fit.metres.Add(r);
  for (const double r : evaluation.per_pair_px) fit.pixels.Add(r);
  return fit;
}

// The residuals of every view under the answer and under the pose of the other folds.
void AddFits(const CalibrationProblem& problem, const std::vector<int>& views,
             const ViewGroups& groups, const SolveReport& answer, const Poses& folds,
             Trust& trust) {
  std::map<int, std::size_t> group_of;
  for (std::size_t i = 0; i < groups.size(); ++i) {
    for (const int view : groups[i]) group_of[view] = i;
  }
  ViewFit all;
  ViewFit all_held_out;
  for (const int of : views) {
    ViewTrust& view = trust.views.emplace_back();
    view.view = of;
    const ViewFit fit = FitOf(problem, of, answer.cam_from_lidar);
    view.rmse_m = fit.metres.Value();
    view.rmse_px = fit.pixels.Value();
    all.metres.Add(fit.metres);
    all.pixels.Add(fit.pixels);
    if (folds.empty()) continue;
    const std::optional<Rigid3d>& others = folds[group_of[of] % folds.size()];
    if (!others) continue;
    const ViewFit held_out = FitOf(problem, of, *others);
    view.held_out_m = held_out.metres.Value();
    view.held_out_px = held_out.pixels.Value();
    all_held_out.metres.Add(held_out.metres);
    all_held_out.pixels.Add(held_out.pixels);
  }
  trust.figures.fit_rmse_m = all.metres.Value();
  trust.figures.fit_rmse_px = all.pixels.Value();
  trust.figures.held_out_rmse_m = all_held_out.metres.Value();
  trust.figures.held_out_rmse_px = all_held_out.pixels.Value();
}

// Without the views of which the answer uses no board.
std::vector<int> UsedViews(const std::vector<int>& views, const SolveReport& answer) {
  std::vector<int> used;
  std::ranges::copy_if(views, std::back_inserter(used), [&answer](int view) {
    const auto is_of_view = [view](const BoardViewFit& fit) { return fit.view == view; };
    return std::ranges::none_of(answer.board_views, is_of_view) ||
           std::ranges::any_of(answer.board_views, [&](const BoardViewFit& fit) {
             return is_of_view(fit) && fit.used;
           });
  });
  return used;
}

// Squared scatter of the views over the solver's sigma, the larger of the two checks.
double ScatterOver(const TrustFigures& figures) {
  const double ratio = std::max(figures.jackknife_over_solver.value_or(0.0),
                                figures.bootstrap_over_solver.value_or(0.0));
  return ratio * ratio;
}

std::vector<double> HeldOutErrors(const Trust& trust) {
  std::vector<double> errors;
  for (const ViewTrust& view : trust.views) {
    errors.push_back(view.held_out_m.value_or(view.held_out_px.value_or(0.0)));
  }
  return errors;
}

std::vector<double> ErrorsUnder(const CalibrationProblem& problem, const std::vector<int>& views,
                                const Rigid3d& pose) {
  std::vector<double> errors;
  for (const int view : views) {
    const ViewFit fit = FitOf(problem, view, pose);
    errors.push_back(fit.metres.Value().value_or(fit.pixels.Value().value_or(0.0)));
  }
  return errors;
}

// Solves again without the marked views and tests all views under that pose, until nothing changes.
std::vector<bool> MarkByErrors(const CalibrationProblem& problem, const Solver& solver,
                               const std::vector<int>& views, const Trust& trust) {
  std::vector<bool> marked = OutlyingViews(HeldOutErrors(trust));
  constexpr int kMaxRounds = 10;
  for (int round = 0; round < kMaxRounds; ++round) {
    std::vector<int> rest;
    for (std::size_t i = 0; i < views.size(); ++i) {
      if (!marked[i]) rest.push_back(views[i]);
    }
    if (rest.size() == views.size()) break;
    const std::optional<Rigid3d> pose = PoseOf(SelectViews(problem, rest), solver);
    if (!pose) break;
    std::vector<bool> again = OutlyingViews(ErrorsUnder(problem, views, *pose));
    if (again == marked) break;
    marked = std::move(again);
  }
  return marked;
}

std::vector<bool> MarkOutliers(const CalibrationProblem& problem, const Solver& solver,
                               const SolveReport& answer, const std::vector<int>& views,
                               const Trust& trust) {
  if (!problem.board_views.empty()) {
    const auto compared = CompareViews(problem, answer.cam_from_lidar);
    if (compared) return DisagreeingViews(*compared, views);
  }
  return MarkByErrors(problem, solver, views, trust);
}

}  // namespace

Expected<Trust> AssessTrust(const CalibrationProblem& problem, const Solver& solver,
                            const SolveReport& answer, const TrustOptions& options) {
  const std::vector<int> views = ViewsOf(problem);
  if (views.empty()) {
    return MakeError(ErrorCode::kMissingData,
                     "expected pairs or board views to compare with each other, got none");
  }
  const ViewGroups groups = GroupsOf(views, options.together);
  Trust trust;
  trust.independent_views = static_cast<int>(groups.size());
  TrustFigures& figures = trust.figures;
  if (answer.covariance) figures.solver_sigma = SigmaOf(*answer.covariance);
  Poses folds;
  if (groups.size() > 1) {
    figures.folds = std::min(std::max(options.folds, 2), static_cast<int>(groups.size()));
  }
  ProgressCounter counter(options.progress, "bootstrap",
                          static_cast<std::size_t>(figures.folds + options.bootstrap_samples));
  if (groups.size() > 1) {
    folds = SolveFolds(problem, solver, groups, static_cast<std::size_t>(figures.folds), counter);
  }
  AddFits(problem, views, groups, answer, folds, trust);
  AddJackknife(DifferencesFrom(answer.cam_from_lidar, folds), figures);
  ViewScatter scatter{.views = trust.independent_views};
  if (groups.size() > 2 && options.bootstrap_samples > 1) {
    const std::vector<Vector6d> draws = DifferencesFrom(
        answer.cam_from_lidar, SolveResamples(problem, solver, groups, options, counter));
    if (draws.size() > 1) {
      AddBootstrap(draws, options, figures);
      scatter.bootstrap = SampleCovariance(draws);
    }
  }
  figures.bootstrap_over_solver = MeanRatio(figures.bootstrap_sigma, figures.solver_sigma);
  figures.jackknife_over_solver = MeanRatio(figures.jackknife_sigma, figures.solver_sigma);
  scatter.jackknife_over_solver = figures.jackknife_over_solver;
  trust.covariance = StatedCovariance(answer.covariance, scatter);
  trust.halves_off = HalvesDisagreement(
      problem, solver, GroupsOf(UsedViews(views, answer), options.together), ScatterOver(figures));
  if (trust.covariance) {
    figures.stated_over_solver = MeanRatio(SigmaOf(*trust.covariance), figures.solver_sigma);
  }
  const std::vector<bool> marked = MarkOutliers(problem, solver, answer, views, trust);
  for (std::size_t i = 0; i < views.size(); ++i) {
    trust.views[i].outlier = marked[i];
    if (marked[i]) figures.outlier_views.push_back(views[i]);
  }
  figures.comparison = DescribeChecks(figures, trust.independent_views);
  counter.Finish();
  return trust;
}

void AddTrust(const Trust& trust, CalibrationResult& result) {
  result.trust = trust.figures;
  for (ResultView& view : result.views) {
    const auto judged = std::find_if(trust.views.begin(), trust.views.end(),
                                     [&](const ViewTrust& v) { return v.view == view.view; });
    if (judged == trust.views.end()) continue;
    view.rmse_m = judged->rmse_m;
    view.rmse_px = judged->rmse_px;
    view.held_out_m = judged->held_out_m;
    view.held_out_px = judged->held_out_px;
    if (!judged->outlier || !view.kept) continue;
    const std::string name = "view " + (view.name.empty() ? std::to_string(view.view) : view.name);
    result.warnings.push_back(OutlierText(name, *judged, trust.figures));
  }
}

}  // namespace sextant
