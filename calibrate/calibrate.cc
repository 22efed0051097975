// SPDX-License-Identifier: Apache-2.0
#include "calibrate/calibrate.h"

#include <fmt/core.h>

#include "base/text/path_text.h"
#include "calibrate/configuration.h"
#include "calibrate/observe/probe_size.h"
#include "calibrate/trust/diagnose.h"
#include "calibrate/trust/evidence.h"
#include "calibrate/trust/information.h"
#include "calibrate/trust/left_out.h"
#include "calibrate/trust/make_result.h"
#include "calibrate/trust/scale_fit.h"
#include "eval/diagnostics/pair_diagnostics.h"
#include "io/clouds/cloud_file.h"
#include "solvers/builtin_solvers.h"

namespace sextant {
namespace {

// Boards of other sizes in the first scans that show none of the expected ones, one line each.
std::vector<std::string> OtherSizes(const ObservedSession& observed,
                                    const BoardSearchOptions& search) {
  constexpr int kMaxScans = 3;
  int scans = 0;
  for (const SessionView& view : observed.views) {
    if (!view.seen || !view.seen->in_scan.empty() || view.cloud_path.empty()) continue;
    std::vector<PhotoRange> in_image;
    for (const CameraSighting& sighting : view.seen->in_image) {
      in_image.push_back({sighting.board, sighting.pose.cam_from_board.translation.norm()});
    }
    if (in_image.empty()) continue;
    if (++scans > kMaxScans) break;
    const Expected<PointCloud> cloud = ReadCloud(view.cloud_path);
    if (!cloud) continue;
    std::vector<std::string> lines = ProbeSizes(*cloud, observed.boards, in_image, search);
    if (!lines.empty()) return lines;
  }
  return {};
}

// Why there is no pose, in terms of views and boards: the solver's own words are for those who
// chose it.
Error NoPose(const Calibration& calibration, const CalibrateOptions& options, const Error& error) {
  const Matching& matching = calibration.assembly.matching;
  std::string text = fmt::format(
      "no pose: the {} boards seen by both sensors do not fit together under one pose of the "
      "camera "
      "and the LiDAR. Check that each photo and its scan are of one moment, that no board moved "
      "meanwhile, that the camera file belongs to these photos, and the sizes in the board file; "
      "then add views with the board in other places",
      matching.kept.size());
  if (!options.solvers.empty()) text += ". The solver reports: " + error.message;
  return {error.code, std::move(text)};
}

std::vector<std::string> WarningsFor(const Calibration& calibration, const MatchSettings& match) {
  const Assembly& assembly = calibration.assembly;
  std::vector<std::string> warnings = calibration.observed.notes;
  const auto add = [&warnings](const std::vector<std::string>& lines) {
    warnings.insert(warnings.end(), lines.begin(), lines.end());
  };
  const auto named = [&](std::vector<std::string> lines) {
    for (std::string& line : lines) line = WithViewNames(line, calibration.observed.views);
    return lines;
  };
  add(named(DescribeAmbiguity(assembly.matching, match)));
  for (const std::filesystem::path& file : calibration.observed.session.files.without_partner) {
    warnings.push_back(fmt::format("without a partner: {}", PathText(file)));
  }
  const SolveReport* report = calibration.report();
  const Rigid3d& pose =
      report != nullptr ? report->cam_from_lidar : assembly.matching.cam_from_lidar;
  add(Diagnose(calibration.observed.views, assembly, pose));
  add(named(Describe(DiagnosePairs(assembly.problem))));
  return warnings;
}

// How far the views contradict the answer; its covariance is enlarged to that.
std::optional<Trust> CheckAnswer(const Solver& solver, const CalibrateOptions& options,
                                 const Calibration& calibration, SolveReport& report) {
  if (options.bootstrap_samples == 0) return std::nullopt;
  const Expected<Trust> trust =
      AssessTrust(calibration.problem, solver, report,
                  {.bootstrap_samples = options.bootstrap_samples,
                   .seed = options.observe.search.seed,
                   .together = ViewsThatShare(calibration.assembly.repeated),
                   .progress = options.progress});
  if (!trust) return std::nullopt;
  report.covariance = trust->covariance;
  return *trust;
}

// The answer with its verdict, and with what each view contributes to it.
CalibrationResult CheckedResult(const Solver& solver, const CalibrateOptions& options,
                                SolveReport& report, Calibration& calibration) {
  const Assembly& assembly = calibration.assembly;
  calibration.trust = CheckAnswer(solver, options, calibration, report);
  if (report.covariance) {
    report.covariance =
        WithRangeDisagreement(*report.covariance, assembly.problem, report.cam_from_lidar);
  }
  CalibrationResult result = MakeResult(
      calibration.observed.views, assembly, report,
      {.seed = options.observe.search.seed,
       .configuration = ConfigurationLines(calibration.observed, options, solver.spec().name),
       .warnings = calibration.warnings});
  if (calibration.trust) AddTrust(*calibration.trust, result);
  calibration.warnings = result.warnings;
  AddInformation(assembly.problem, result);
  const MatchSettings match = MatchSettingsFor(calibration.observed.session, options);
  result.verdict =
      JudgeResult(FiguresOf({.views = calibration.observed.views,
                             .assembly = assembly,
                             .report = report,
                             .trust = calibration.trust ? &*calibration.trust : nullptr,
                             .rough_pose = match.initial}),
                  options.need);
  return result;
}

// What the first solver leaves out of its answer is left out of all that follows.
void Solve(const std::vector<SolverPtr>& solvers, const CalibrateOptions& options,
           Calibration& calibration) {
  calibration.problem = calibration.assembly.problem;
  calibration.comparison =
      Compare(calibration.problem, solvers, calibration.observed.session.true_cam_from_lidar,
              options.progress);
  for (ComparisonRow& row : calibration.comparison) {
    if (!row.report) continue;
    for (std::string& line : row.report->warnings) {
      line = WithViewNames(line, calibration.observed.views);
    }
  }
  Expected<SolveReport>& report = calibration.comparison.front().report;
  if (report) LeaveOut(*report, calibration.assembly);
}

}  // namespace

SolverPtr DefaultSolver() { return *BuiltinSolvers().Make("joint(gnc(kabsch))"); }

const SolveReport* Calibration::report() const {
  if (comparison.empty() || !comparison.front().report) return nullptr;
  return &*comparison.front().report;
}

Calibration CalibrateObserved(ObservedSession observed, const CalibrateOptions& options) {
  Calibration calibration{.observed = std::move(observed)};
  const MatchSettings match = MatchSettingsFor(calibration.observed.session, options);
  Expected<Assembly> assembly = Assemble(calibration.observed.views, calibration.observed.boards,
                                         calibration.observed.camera, match);
  if (!assembly) {
    Error error = assembly.error();
    for (const std::string& line : OtherSizes(calibration.observed, options.observe.search)) {
      error.AddLine(line);
    }
    for (const std::string& note : calibration.observed.notes) error.AddLine(note);
    calibration.result = tl::unexpected<Error>(std::move(error));
    return calibration;
  }
  calibration.assembly = std::move(*assembly);
  const std::vector<SolverPtr> solvers =
      options.solvers.empty() ? std::vector<SolverPtr>{DefaultSolver()} : options.solvers;
  Solve(solvers, options, calibration);
  calibration.warnings = WarningsFor(calibration, match);
  Expected<SolveReport>& report = calibration.comparison.front().report;
  if (!report) {
    calibration.result = tl::unexpected<Error>(NoPose(calibration, options, report.error()));
    return calibration;
  }
  calibration.result = CheckedResult(*solvers.front(), options, *report, calibration);
  calibration.warnings = calibration.result->warnings;
  return calibration;
}

Expected<Calibration> Calibrate(const Session& session, const CalibrateOptions& options) {
  SEXTANT_ASSIGN_OR_RETURN(ObservedSession observed, ObserveSession(session, options));
  return CalibrateObserved(std::move(observed), options);
}

Expected<Calibration> Calibrate(std::span<const Frame> frames, const CalibrateOptions& options) {
  SEXTANT_ASSIGN_OR_RETURN(ObservedSession observed, ObserveFrames(frames, options));
  return CalibrateObserved(std::move(observed), options);
}

ProblemFile ProblemFileOf(const Calibration& calibration) {
  const CalibrationProblem& problem = calibration.problem;
  return {.problem = problem,
          .true_cam_from_lidar = calibration.observed.session.true_cam_from_lidar,
          .comment =
              fmt::format("sextant calibrate: {} boards in {} views, initial pose by their match",
                          problem.board_views.size(), calibration.observed.views.size())};
}

}  // namespace sextant
