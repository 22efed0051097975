// SPDX-License-Identifier: Apache-2.0
#include "report/collect/page_tables.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <string_view>

#include "base/units.h"
#include "eval/statistics/text_table.h"
#include "solvers/builtin_solvers.h"

namespace sextant {
namespace {

std::vector<std::string> SigmaRow(const std::string& name, const Vector6d& sigma) {
  std::vector<std::string> row = {name};
  for (Eigen::Index i = 0; i < 3; ++i) row.push_back(Fixed(kDegPerRad * sigma(i), 3));
  for (Eigen::Index i = 3; i < 6; ++i) row.push_back(Fixed(1e3 * sigma(i), 2));
  return row;
}

// The value in the unit that its name ends in, with metres as millimetres.
std::string NumberText(const std::string& name, double value) {
  if (name.ends_with("_m")) return Fixed(1e3 * value, 2) + " mm";
  if (name.ends_with("_px")) return Fixed(value, 3) + " px";
  return fmt::format("{:.5g}", value);
}

std::string PriorText(const EstimatedNumber& number, const LidarErrorModel& errors) {
  const auto about_zero = [](double sigma_m) { return fmt::format("0 ± {:g} mm", 1e3 * sigma_m); };
  if (number.name == "range_bias_m") return about_zero(errors.range_offset_sigma_m);
  if (number.name.starts_with("edge_growth_")) return about_zero(errors.edge_growth_sigma_m);
  if (number.name.starts_with("ring_")) return about_zero(errors.ring_offset_sigma_m);
  return "none: from the data alone";
}

void AddEstimated(const std::vector<EstimatedNumber>& numbers, const LidarErrorModel& errors,
                  PageTable& table) {
  for (const EstimatedNumber& number : numbers) {
    table.rows.push_back({number.name, NumberText(number.name, number.value),
                          number.sigma ? NumberText(number.name, *number.sigma) : "–",
                          PriorText(number, errors)});
  }
}

void AddNoise(const NoiseEstimate& noise, PageTable& table) {
  const std::string how = noise.is_given ? "given" : "estimated from the residuals";
  if (noise.sigma_m) {
    table.rows.push_back({"corner, per axis", Fixed(1e3 * *noise.sigma_m, 2) + " mm", "–", how});
  }
  if (noise.sigma_px) {
    table.rows.push_back({"pixel, per axis", Fixed(*noise.sigma_px, 3) + " px", "–", how});
  }
}

// RMS over the boards of what a solver of raw observations left over; 1 if the noise is as stated.
void AddFit(const SolveReport& report, PageTable& table) {
  double squares = 0.0;
  int used = 0;
  for (const BoardViewFit& fit : report.board_views) {
    if (!fit.used) continue;
    squares += fit.rms * fit.rms;
    ++used;
  }
  if (used == 0) return;
  table.rows.push_back({"residuals over their stated noise", Fixed(std::sqrt(squares / used), 2),
                        "–", "1 if the noise is as stated"});
}

void AddErrorModel(const LidarErrorModel& errors, PageTable& table) {
  const auto add = [&](const std::string& name, double sigma_m) {
    if (sigma_m > 0.0) {
      table.rows.push_back({name, "marginalised", "–", fmt::format("0 ± {:g} mm", 1e3 * sigma_m)});
    }
  };
  add("offset of each ring", errors.ring_offset_sigma_m);
  add("shift of each board in each view", errors.view_shift_sigma_m);
}

// The solvers that a report compares with, one of each family.
std::vector<SolverPtr> OthersThan(const std::string& solver) {
  constexpr std::array<std::string_view, 5> kOthers = {"kabsch", "gnc(kabsch)", "sqpnp",
                                                       "refine(ransac(p3p))", "epnp"};
  const SolverRegistry registry = BuiltinSolvers();
  std::vector<SolverPtr> others;
  for (const std::string_view spec : kOthers) {
    Expected<SolverPtr> made = registry.Make(std::string(spec));
    if (made && (*made)->spec().name != solver) others.push_back(std::move(*made));
  }
  return others;
}

std::vector<ComparisonRow> ComparisonFor(const Calibration& calibration) {
  std::vector<ComparisonRow> rows = calibration.comparison;
  const SolveReport* first = calibration.report();
  if (rows.size() != 1 || first == nullptr) return rows;
  for (ComparisonRow& row : Compare(calibration.problem, OthersThan(first->solver),
                                    calibration.observed.session.true_cam_from_lidar)) {
    if (row.report) {
      row.from_first = DistanceBetween(row.report->cam_from_lidar, first->cam_from_lidar);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string Off(const std::optional<PoseDistance>& distance, bool rotation) {
  if (!distance) return "–";
  return rotation ? Fixed(kDegPerRad * distance->rotation_rad, 3)
                  : Fixed(1e3 * distance->translation_m, 1);
}

std::vector<std::string> ComparisonCells(const ComparisonRow& row, bool has_truth) {
  const SolveReport& report = *row.report;
  std::vector<std::string> cells = {row.solver};
  const Evaluation& evaluation = report.evaluation;
  cells.push_back(evaluation.rmse_m ? Fixed(1e3 * *evaluation.rmse_m, 2) : "–");
  cells.push_back(evaluation.rmse_px ? Fixed(*evaluation.rmse_px, 2) : "–");
  cells.push_back(Off(row.from_first, false));
  cells.push_back(Off(row.from_first, true));
  if (report.covariance) {
    const Vector6d variance = report.covariance->diagonal();
    cells.push_back(Fixed(1e3 * std::sqrt(variance.tail<3>().sum()), 1));
    cells.push_back(Fixed(kDegPerRad * std::sqrt(variance.head<3>().sum()), 3));
  } else {
    cells.insert(cells.end(), {"–", "–"});
  }
  if (has_truth) {
    cells.push_back(Off(row.from_truth, false));
    cells.push_back(Off(row.from_truth, true));
  }
  return cells;
}

}  // namespace

PageTable SigmaTable(const CalibrationResult& result) {
  PageTable table{.header = {"1 sigma", "about x [deg]", "about y", "about z", "along x [mm]",
                             "along y", "along z"},
                  .note =
                      "x right, y down, z forward, in the camera frame. The result's sigma is "
                      "the solver's, enlarged to what the scatter of the views shows."};
  if (result.covariance) {
    table.rows.push_back(SigmaRow("the result", result.covariance->diagonal().cwiseSqrt()));
  }
  if (!result.trust) {
    if (table.rows.empty()) table.note = "The uncertainty is unknown.";
    return table;
  }
  const TrustFigures& trust = *result.trust;
  if (trust.solver_sigma) {
    table.rows.push_back(SigmaRow("the solver's noise model", *trust.solver_sigma));
  }
  if (trust.bootstrap_sigma) {
    table.rows.push_back(SigmaRow("bootstrap over the views", *trust.bootstrap_sigma));
  }
  if (trust.jackknife_sigma) {
    table.rows.push_back(SigmaRow("jackknife (leave-one-view-out)", *trust.jackknife_sigma));
  }
  return table;
}

std::optional<PageCorrelation> CorrelationOf(const CalibrationResult& result) {
  if (!result.covariance) return std::nullopt;
  const Vector6d sigma = result.covariance->diagonal().cwiseSqrt();
  if (!(sigma.minCoeff() > 0.0) || !sigma.allFinite()) return std::nullopt;
  const Matrix6d by = sigma.cwiseInverse().asDiagonal();
  const Matrix6d values = by * *result.covariance * by;
  if (!values.allFinite()) return std::nullopt;
  return PageCorrelation{.names = {"rot x", "rot y", "rot z", "x", "y", "z"}, .values = values};
}

PageTable NoiseTable(const CalibrationResult& result, const Calibration* calibration) {
  PageTable table{.header = {"Quantity", "Value", "1 sigma", "Prior"}};
  if (result.lidar) {
    table.rows.push_back({"range of one return",
                          Fixed(1e3 * result.lidar->range_sigma_m, 1) + " mm", "–",
                          "estimated from the scans"});
  }
  if (calibration == nullptr) {
    table.note =
        "Result files do not contain the nuisance parameters: sextant calibrate --report "
        "shows them.";
    return table;
  }
  const SolveReport* report = calibration->report();
  if (report == nullptr) return table;
  const LidarErrorModel& errors = calibration->problem.lidar_errors;
  if (report->noise) AddNoise(*report->noise, table);
  AddFit(*report, table);
  AddEstimated(report->extras, errors, table);
  if (report->camera) AddEstimated(report->camera->estimated, errors, table);
  if (!report->board_views.empty()) AddErrorModel(errors, table);
  table.note = "Estimated together with the pose, whose sigma accounts for them.";
  return table;
}

PageTable ComparisonTable(const Calibration* calibration) {
  if (calibration == nullptr) {
    return {.note =
                "Result files do not contain the data: sextant calibrate --report compares "
                "solvers."};
  }
  if (calibration->comparison.empty()) return {.note = "There was nothing to give to a solver."};
  const std::vector<ComparisonRow> rows = ComparisonFor(*calibration);
  const bool has_truth =
      std::any_of(rows.begin(), rows.end(), [](const auto& row) { return row.from_truth; });
  PageTable table{.header = {"Solver", "Off [mm]", "Off [px]", "From the first [mm]", "[deg]",
                             "1 sigma [mm]", "[deg]"}};
  if (has_truth) table.header.insert(table.header.end(), {"Error [mm]", "[deg]"});
  table.note =
      "On the same data. Off: RMS over all corners, those that a robust solver leaves out "
      "included. Sigmas are over all axes; those of solvers other than the first are not "
      "enlarged to the scatter of the views.";
  for (const ComparisonRow& row : rows) {
    if (row.report) {
      table.rows.push_back(ComparisonCells(row, has_truth));
    } else {
      table.note += fmt::format(" No answer of {}: {}.", row.solver, row.report.error().message);
    }
  }
  return table;
}

}  // namespace sextant
