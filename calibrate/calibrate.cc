// SPDX-License-Identifier: Apache-2.0
#include "calibrate/calibrate.h"

#include <fmt/core.h>

#include "base/text/printable.h"
#include "calibrate/configuration.h"
#include "calibrate/observe/probe_size.h"
#include "calibrate/trust/diagnose.h"
#include "calibrate/trust/information.h"
#include "calibrate/trust/make_result.h"
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
  add(DescribeAmbiguity(assembly.matching, match));
  for (const std::filesystem::path& file : calibration.observed.session.files.without_partner) {
    warnings.push_back(fmt::format("without a partner: {}", Printable(file.string(), 300)));
  }
  const SolveReport* report = calibration.report();
  const Rigid3d& pose =
      report != nullptr ? report->cam_from_lidar : assembly.matching.cam_from_lidar;
  add(Diagnose(calibration.observed.views, assembly, pose));
  add(Describe(DiagnosePairs(assembly.problem)));
  return warnings;
}

// The answer with what each view contributes to it, and with how far the views contradict it.
CalibrationResult CheckedResult(const Solver& solver, const SolveReport& report,
                                const CalibrateOptions& options, Calibration& calibration) {
  const Assembly& assembly = calibration.assembly;
  const std::uint64_t seed = options.observe.search.seed;
  CalibrationResult result = MakeResult(
      calibration.observed.views, assembly, report,
      {.seed = seed,
       .configuration = ConfigurationLines(calibration.observed, options, solver.spec().name),
       .warnings = calibration.warnings});
  AddInformation(assembly.problem, result);
  if (options.bootstrap_samples == 0) return result;
  const Expected<Trust> trust = AssessTrust(assembly.problem, solver, report,
                                            {.bootstrap_samples = options.bootstrap_samples,
                                             .seed = seed,
                                             .together = ViewsThatShare(assembly.repeated),
                                             .progress = options.progress});
  if (!trust) return result;
  AddTrust(*trust, result);
  calibration.trust = *trust;
  return result;
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
  calibration.comparison =
      Compare(calibration.assembly.problem, solvers,
              calibration.observed.session.true_cam_from_lidar, options.progress);
  calibration.warnings = WarningsFor(calibration, match);
  const Expected<SolveReport>& report = calibration.comparison.front().report;
  if (!report) {
    calibration.result = tl::unexpected<Error>(NoPose(calibration, options, report.error()));
    return calibration;
  }
  calibration.result = CheckedResult(*solvers.front(), *report, options, calibration);
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
  const CalibrationProblem& problem = calibration.assembly.problem;
  return {.problem = problem,
          .true_cam_from_lidar = calibration.observed.session.true_cam_from_lidar,
          .comment =
              fmt::format("sextant calibrate: {} boards in {} views, initial pose by their match",
                          problem.board_views.size(), calibration.observed.views.size())};
}

}  // namespace sextant
