// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "calibrate/calibrate.h"
#include "calibrate/session/session.h"
#include "cli/calibrate_options.h"
#include "cli/load.h"
#include "cli/pose_argument.h"
#include "cli/progress.h"
#include "cli/search_options.h"
#include "io/problems/problem_yaml.h"
#include "io/results/calibration_result.h"
#include "io/text/text_file.h"
#include "report/calibrate_text.h"
#include "solvers/all/all_solvers.h"

namespace sextant::cli {
namespace {

Expected<Session> ChosenSession(const CalibrateOptions& options) {
  const bool has_files = !options.images.empty() || !options.clouds.empty();
  if (has_files != options.session.empty()) {
    return MakeError(ErrorCode::kInvalidOption,
                     "expected a SESSION (file, folder or recording), or --image and --cloud");
  }
  if (!has_files) return ReadSession(options.session, options.camera_name);
  if (options.images.empty() || options.clouds.empty()) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("{} is missing: expected --image and --cloud together",
                                 options.images.empty() ? "--image" : "--cloud"));
  }
  return SessionOfFiles(options.images, options.clouds);
}

// The session with what the arguments override.
Expected<Session> SessionFrom(const CalibrateOptions& options) {
  SEXTANT_ASSIGN_OR_RETURN(Session session, ChosenSession(options));
  if (!options.boards_path.empty()) session.boards = options.boards_path;
  if (!options.camera_path.empty()) session.camera = options.camera_path;
  if (!options.image_topic.empty()) session.image_topic = options.image_topic;
  if (!options.cloud_topic.empty()) session.cloud_topic = options.cloud_topic;
  const bool has_boards = !session.boards.empty();
  if (!has_boards || (session.camera.empty() && session.bag.empty())) {
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format("{} is missing: the session does not name the {}",
                    has_boards ? "--camera" : "--board", has_boards ? "camera" : "boards"));
  }
  return session;
}

Expected<std::vector<SolverPtr>> SolversFrom(const std::string& list) {
  std::vector<SolverPtr> solvers;
  if (list.empty()) return solvers;
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<SpecNode> specs, ParseSpecList(list));
  const SolverRegistry registry = AllSolvers();
  for (const SpecNode& spec : specs) {
    SEXTANT_ASSIGN_OR_RETURN(SolverPtr solver, registry.Make(spec));
    solvers.push_back(std::move(solver));
  }
  return solvers;
}

Expected<sextant::CalibrateOptions> SettingsFrom(const CalibrateOptions& options) {
  sextant::CalibrateOptions settings{
      .observe = {.detector = options.detector, .extractor = options.extractor},
      .tolerance_s = options.tolerance_s,
      .bootstrap_samples = options.bootstrap,
      .search_description = ConfigurationOf(options.search)};
  SEXTANT_ASSIGN_OR_RETURN(settings.solvers, SolversFrom(options.solvers));
  if (!options.initial.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(settings.match.initial,
                             PoseFromArgument("--initial", options.initial));
  }
  SEXTANT_ASSIGN_OR_RETURN(settings.observe.search, SearchOptionsFrom(options.search));
  return settings;
}

Expected<Calibration> CalibrateWithProgress(const CalibrateOptions& options) {
  SEXTANT_ASSIGN_OR_RETURN(const Session session, SessionFrom(options));
  SEXTANT_ASSIGN_OR_RETURN(sextant::CalibrateOptions settings, SettingsFrom(options));
  std::unique_ptr<Progress> progress;
  settings.progress = [&progress](std::size_t done, std::size_t total) {
    if (done == 0) progress = std::make_unique<Progress>("views", static_cast<long>(total));
    progress->Set(static_cast<long>(done));
    if (done == total) progress.reset();
  };
  return Calibrate(session, settings);
}

Expected<void> WriteFiles(const CalibrateOptions& options, const Calibration& calibration) {
  const bool has_problem = !calibration.assembly.rows.empty();
  if (has_problem && !options.problem_path.empty()) {
    SEXTANT_RETURN_IF_ERROR(
        WriteFileAtomically(options.problem_path, FormatProblemYaml(ProblemFileOf(calibration))));
  }
  if (!calibration.result || options.out_path.empty()) return {};
  return WriteFileAtomically(options.out_path, FormatCalibrationResult(*calibration.result));
}

}  // namespace

int RunCalibrate(const CalibrateOptions& options) {
  const Expected<Calibration> calibration = CalibrateWithProgress(options);
  if (!calibration) return Refuse("calibrate", calibration.error());
  if (Expected<void> ok = WriteFiles(options, *calibration); !ok) {
    return Refuse("calibrate", ok.error());
  }
  std::string text = DescribeCalibration(*calibration);
  if (!calibration->result) {
    fmt::print("{}", text);
    return Refuse("calibrate", calibration->result.error(), kNoAnswer);
  }
  if (!options.out_path.empty()) text += fmt::format("\nThe result is in {}.\n", options.out_path);
  return Deliver("calibrate", options.json_path, text,
                 FormatCalibrationResultJson(*calibration->result), kAnswered);
}

}  // namespace sextant::cli
