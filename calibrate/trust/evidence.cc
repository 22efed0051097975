// SPDX-License-Identifier: Apache-2.0
#include "calibrate/trust/evidence.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>
#include <vector>

#include "calibrate/trust/information.h"
#include "calibrate/trust/measured_boards.h"
#include "calibrate/trust/scale_fit.h"
#include "calibrate/trust/select_views.h"
#include "geometry/scan_marks.h"

namespace sextant {
namespace {

// A view counts by its best board: used, else contradicting, else without a board in the scan.
void CountViews(const Evidence& evidence, VerdictFigures& figures) {
  std::map<std::size_t, std::set<BoardStatus>> views;
  for (const BoardRow& row : evidence.assembly.rows) views[row.view].insert(row.fate);
  for (const auto& [view, fates] : views) {
    const bool used = fates.contains(BoardStatus::kKept);
    const bool contradicts =
        fates.contains(BoardStatus::kDisagrees) || fates.contains(BoardStatus::kContradicts);
    const bool missing = fates.contains(BoardStatus::kNotInScan);
    figures.views_used += used ? 1 : 0;
    figures.views_contradicting += !used && contradicts ? 1 : 0;
    figures.views_with_board += used || contradicts || missing ? 1 : 0;
  }
  const auto seen = static_cast<int>(ViewsOf(evidence.assembly.problem).size());
  int shared = 0;
  for (const std::vector<int>& group : ViewsThatShare(evidence.assembly.repeated)) {
    shared += static_cast<int>(group.size()) - 1;
  }
  figures.independent_views = std::max(seen - shared, std::min(seen, 1));
}

// Those of the matching, and those that the solver found.
void AddRivals(const Evidence& evidence, VerdictFigures& figures) {
  const auto& of_matching = evidence.assembly.matching.alternatives;
  const auto& of_solver = evidence.report.alternatives;
  const std::vector<Rigid3d>& rivals =
      of_solver.size() > of_matching.size() ? of_solver : of_matching;
  figures.rival_poses = static_cast<int>(rivals.size());
  figures.has_rough_pose = evidence.rough_pose.has_value();
  const Eigen::Quaterniond expected = evidence.rough_pose.value_or(AxesCamFromLidar()).rotation;
  double nearest = std::numbers::pi;
  for (const Rigid3d& rival : rivals) {
    nearest = std::min(nearest, RotationDistance(rival.rotation, expected));
  }
  figures.rival_margin_rad =
      nearest - RotationDistance(evidence.report.cam_from_lidar.rotation, expected);
}

void AddAgreement(const Evidence& evidence, VerdictFigures& figures) {
  const Assembly& assembly = evidence.assembly;
  const Rigid3d& pose = evidence.report.cam_from_lidar;
  if (const auto fits = FitScales(assembly.problem, pose)) {
    figures.range_excess = fits->Better().excess;
    figures.range_excess_sigma = fits->Better().sigma;
  }
  for (const MeasuredEdge& edge : MeasureEdges(evidence.views, assembly)) {
    if (!ContradictsFile(edge)) continue;
    if (std::abs(edge.Excess()) < std::abs(figures.size_excess.value_or(0.0))) continue;
    figures.size_excess = edge.Excess();
  }
  figures.normals_off_rad = NormalsOff(assembly.problem, pose);
  if (const auto prints = MeasurePrints(evidence.views, assembly)) {
    figures.print_rms_px = prints->rms_px;
    figures.print_over_noise = prints->over_noise;
  }
  figures.corner_rms_m = evidence.report.evaluation.rmse_m;
}

void AddChecks(const Trust& trust, const CalibrationProblem& problem, VerdictFigures& figures) {
  const TrustFigures& checks = trust.figures;
  figures.is_checked = true;
  figures.halves_off = trust.halves_off;
  const std::vector<int> used = ViewsOf(problem);
  figures.outlier_views = static_cast<int>(std::ranges::count_if(
      checks.outlier_views, [&](int view) { return std::ranges::binary_search(used, view); }));
  // The larger of the two: either may miss a direction.
  for (const auto& ratio : {checks.bootstrap_over_solver, checks.jackknife_over_solver}) {
    if (ratio)
      figures.spread_over_solver = std::max(figures.spread_over_solver.value_or(0), *ratio);
  }
  const bool has_points = checks.held_out_rmse_m && checks.fit_rmse_m;
  const auto& held_out = has_points ? checks.held_out_rmse_m : checks.held_out_rmse_px;
  const auto& fit = has_points ? checks.fit_rmse_m : checks.fit_rmse_px;
  if (held_out && fit && *fit > 0.0) figures.held_out_over_fit = *held_out / *fit;
}

}  // namespace

VerdictFigures FiguresOf(const Evidence& evidence) {
  VerdictFigures figures;
  CountViews(evidence, figures);
  AddRivals(evidence, figures);
  if (evidence.report.covariance) {
    const WeakestDirections weakest = WeakestOf(*evidence.report.covariance);
    figures.worst_translation_m = weakest.translation_sigma_m;
    figures.worst_rotation_rad = weakest.rotation_sigma_rad;
  }
  AddAgreement(evidence, figures);
  if (evidence.trust != nullptr) AddChecks(*evidence.trust, evidence.assembly.problem, figures);
  return figures;
}

}  // namespace sextant
