// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "calibrate/observe/probe_size.h"
#include "calibrate/session/observe_files.h"
#include "calibrate/session/session.h"
#include "calibrate/trust/diagnose.h"
#include "calibrate/trust/information.h"
#include "calibrate/trust/make_result.h"
#include "calibrate/trust/trust.h"
#include "cli/calibrate_options.h"
#include "cli/calibrate_source.h"
#include "cli/catalogue.h"
#include "cli/commands.h"
#include "cli/load.h"
#include "cli/pose_argument.h"
#include "cli/progress.h"
#include "cli/search_options.h"
#include "eval/diagnostics/pair_diagnostics.h"
#include "eval/metrics/compare.h"
#include "io/boards/board_file.h"
#include "io/cameras/camera_file.h"
#include "io/clouds/cloud_file.h"
#include "io/problems/problem_yaml.h"
#include "io/results/calibration_result.h"
#include "io/text/text_file.h"
#include "report/calibrate_text.h"
#include "report/report_text.h"

namespace sextant::cli {
namespace {

constexpr std::size_t kLineWidth = 100;

// Everything that is settled before an image is opened.
struct Job {
  Session session;
  std::vector<Board> boards;
  std::optional<Camera> camera;
  std::vector<SolverPtr> solvers;
  MatchSettings match;
  ObserveOptions observe;
  double tolerance_s = 0.05;
};

Expected<std::vector<std::filesystem::path>> Files(const std::vector<std::string>& names) {
  std::vector<std::filesystem::path> files;
  for (const std::string& name : names) {
    SEXTANT_ASSIGN_OR_RETURN(const auto some, ExpandPattern(name));
    files.insert(files.end(), some.begin(), some.end());
  }
  return files;
}

Expected<Session> SessionOf(const CalibrateOptions& options) {
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
  SEXTANT_ASSIGN_OR_RETURN(const auto images, Files(options.images));
  SEXTANT_ASSIGN_OR_RETURN(const auto clouds, Files(options.clouds));
  return Session{.files = PairFiles(images, clouds)};
}

Expected<std::vector<SolverPtr>> SolversOf(const std::string& list) {
  const SolverRegistry registry = AllSolvers();
  const bool has_joint = std::ranges::any_of(
      registry.entries(), [](const SolverEntry& entry) { return entry.name == "joint"; });
  // A beam's spot widens outlines by a percent or two, which joint would take for nearness.
  const std::string usual = has_joint ? "joint(gnc(kabsch),board_size=scale)" : "gnc(kabsch)";
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<SpecNode> specs,
                           ParseSpecList(list.empty() ? usual : list));
  std::vector<SolverPtr> solvers;
  for (const SpecNode& spec : specs) {
    SEXTANT_ASSIGN_OR_RETURN(SolverPtr solver, registry.Make(spec));
    solvers.push_back(std::move(solver));
  }
  return solvers;
}

Expected<void> ReadBoardsAndCamera(const CalibrateOptions& options, Job& job) {
  const std::filesystem::path boards_path =
      options.boards_path.empty() ? job.session.boards : std::filesystem::path(options.boards_path);
  const std::filesystem::path camera_path =
      options.camera_path.empty() ? job.session.camera : std::filesystem::path(options.camera_path);
  if (boards_path.empty() || (camera_path.empty() && job.session.bag.empty())) {
    return MakeError(ErrorCode::kInvalidOption,
                     fmt::format("{} is missing: the session does not name the {}",
                                 boards_path.empty() ? "--board" : "--camera",
                                 boards_path.empty() ? "boards" : "camera"));
  }
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<Board> boards, ReadBoards(boards_path));
  job.boards = boards;
  if (camera_path.empty()) return {};
  SEXTANT_ASSIGN_OR_RETURN(const Camera camera, ReadCamera(camera_path));
  job.camera = camera;
  return {};
}

Expected<Job> MakeJob(const CalibrateOptions& options) {
  Job job;
  SEXTANT_ASSIGN_OR_RETURN(Session session, SessionOf(options));
  job.session = std::move(session);
  if (!options.image_topic.empty()) job.session.image_topic = options.image_topic;
  if (!options.cloud_topic.empty()) job.session.cloud_topic = options.cloud_topic;
  job.tolerance_s = options.tolerance_s;
  SEXTANT_RETURN_IF_ERROR(ReadBoardsAndCamera(options, job));
  SEXTANT_ASSIGN_OR_RETURN(std::vector<SolverPtr> solvers, SolversOf(options.solvers));
  job.solvers = std::move(solvers);
  job.match.initial = job.session.initial_cam_from_lidar;
  if (!options.initial.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(const Rigid3d initial, PoseFromArgument("--initial", options.initial));
    job.match.initial = initial;
  }
  SEXTANT_ASSIGN_OR_RETURN(const BoardSearchOptions search, SearchOptionsFrom(options.search));
  job.observe = {.detector = options.detector, .extractor = options.extractor, .search = search};
  return job;
}

Expected<RecordedViews> Look(const Job& job) {
  if (!job.session.bag.empty()) {
    return LookAtRecording(job.session, {.boards = job.boards,
                                         .camera = job.camera,
                                         .observe = job.observe,
                                         .tolerance_s = job.tolerance_s});
  }
  SEXTANT_ASSIGN_OR_RETURN(const Observer observer,
                           Observer::Make(job.boards, *job.camera, job.observe));
  const std::vector<FilePair>& pairs = job.session.files.pairs;
  if (pairs.empty()) {
    return MakeError(ErrorCode::kMissingData,
                     fmt::format("no image belongs to a scan: {} files have no partner; they are "
                                 "paired by what their names have of their own",
                                 job.session.files.without_partner.size()));
  }
  Progress progress("views", static_cast<long>(pairs.size()));
  return RecordedViews{.camera = *job.camera,
                       .views = ObserveFiles(observer, pairs, [&progress] { progress.Step(); })};
}

std::vector<std::string> FindingsOf(const Job& job, const std::vector<SessionView>& views,
                                    const Assembly& assembly, const SolveReport* report) {
  std::vector<std::string> lines = DescribeAmbiguity(assembly.matching, job.match);
  for (const std::filesystem::path& file : job.session.files.without_partner) {
    lines.push_back(fmt::format("without a partner: {}", file.string()));
  }
  const Rigid3d& pose =
      report != nullptr ? report->cam_from_lidar : assembly.matching.cam_from_lidar;
  for (const std::string& line : Diagnose(views, assembly, pose)) lines.push_back(line);
  for (const std::string& line : Describe(DiagnosePairs(assembly.problem))) lines.push_back(line);
  return lines;
}

std::string FindingsText(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += "  " + line + "\n";
  return text.empty() ? text : "\nWhat the data says of itself:\n" + text;
}

// Everything that shapes the answer besides the measurements; its hash tells runs apart.
std::vector<std::string> ConfigurationOf(const CalibrateOptions& options, const Job& job) {
  std::vector<std::string> lines = {
      fmt::format("solver: {}", job.solvers.front()->spec().name),
      fmt::format("extractor: {}", options.extractor),
      fmt::format("detector: {}", options.detector.empty() ? "usual" : options.detector)};
  for (const std::string& line : ConfigurationOf(options.search)) lines.push_back(line);
  if (job.match.initial) {
    const Eigen::Quaterniond& q = job.match.initial->rotation;
    lines.push_back(
        fmt::format("initial_quaternion_wxyz: {} {} {} {}", q.w(), q.x(), q.y(), q.z()));
  }
  if (!job.session.bag.empty()) lines.push_back(fmt::format("tolerance_s: {}", job.tolerance_s));
  for (const Board& board : job.boards) {
    lines.push_back(
        fmt::format("board {}: {} x {} m", board.id, board.top_right_m, board.right_bottom_m));
  }
  return lines;
}

// What is on the screen and in the files.
int DeliverResult(const CalibrateOptions& options, const CalibrationResult& result,
                  const std::string& text) {
  if (!options.out_path.empty()) {
    if (Expected<void> ok = WriteFileAtomically(options.out_path, FormatCalibrationResult(result));
        !ok) {
      return Refuse("calibrate", ok.error());
    }
  }
  const std::string where = options.out_path.empty()
                                ? std::string()
                                : fmt::format("\nThe result is in {}.\n", options.out_path);
  return Deliver("calibrate", options.json_path, text + where, FormatCalibrationResultJson(result),
                 kAnswered);
}

Expected<void> WriteProblem(const CalibrateOptions& options, const Job& job,
                            const Assembly& assembly, std::size_t views) {
  if (options.problem_path.empty()) return {};
  const ProblemFile file{
      .problem = assembly.problem,
      .true_cam_from_lidar = job.session.true_cam_from_lidar,
      .comment =
          fmt::format("sextant calibrate: {} boards in {} views, initial pose by their match",
                      assembly.problem.board_views.size(), views)};
  return WriteFileAtomically(options.problem_path, FormatProblemYaml(file));
}

std::string ErrorAgainstTruth(const Job& job, const SolveReport& report) {
  if (!job.session.true_cam_from_lidar) return {};
  const PoseDistance error =
      DistanceBetween(report.cam_from_lidar, *job.session.true_cam_from_lidar);
  std::string text =
      fmt::format("  error against the truth    {:.4f} deg, {:.2f} mm",
                  error.rotation_rad * 180.0 / std::numbers::pi, 1e3 * error.translation_m);
  if (report.covariance) {
    const Vector6d variance = report.covariance->diagonal();
    text += fmt::format(" (1 sigma over all axes {:.4f} deg, {:.2f} mm)",
                        std::sqrt(variance.head<3>().sum()) * 180.0 / std::numbers::pi,
                        1e3 * std::sqrt(variance.tail<3>().sum()));
  }
  return text + "\n";
}

// What each view tells of the answer, and what the views say of it when held against each other.
void CrossValidate(const CalibrateOptions& options, const Assembly& assembly, const Solver& solver,
                   const SolveReport& report, CalibrationResult& result) {
  AddInformation(assembly.problem, result);
  if (options.bootstrap == 0) return;
  const Expected<Trust> trust =
      AssessTrust(assembly.problem, solver, report,
                  {.bootstrap_samples = options.bootstrap, .seed = options.search.seed});
  if (trust) AddTrust(*trust, result);
}

// What the first scans that show no board show instead.
std::string OtherSizes(const Job& job, const std::vector<SessionView>& views) {
  constexpr int kMaxScans = 3;
  int looked = 0;
  for (const SessionView& view : views) {
    if (!view.seen || !view.seen->in_scan.empty() || view.cloud_path.empty()) continue;
    if (++looked > kMaxScans) break;
    const Expected<PointCloud> cloud = ReadCloud(view.cloud_path);
    if (!cloud) continue;
    const std::vector<std::string> lines = ProbeSizes(*cloud, job.boards, job.observe.search);
    if (!lines.empty()) return fmt::format("  {}\n", fmt::join(lines, "\n  "));
  }
  return {};
}

}  // namespace

int RunCalibrate(const CalibrateOptions& options) {
  const Expected<Job> job = MakeJob(options);
  if (!job) return Refuse("calibrate", job.error());
  const Expected<RecordedViews> seen = Look(*job);
  if (!seen) return Refuse("calibrate", seen.error());
  const std::vector<SessionView>& views = seen->views;
  const Expected<Assembly> assembly = Assemble(views, job->boards, seen->camera, job->match);
  if (!assembly) {
    Refuse("calibrate", assembly.error());
    fmt::print(stderr, "{}", OtherSizes(*job, views));
    return kNoAnswer;
  }
  if (Expected<void> ok = WriteProblem(options, *job, *assembly, views.size()); !ok) {
    return Refuse("calibrate", ok.error());
  }
  const std::vector<ComparisonRow> rows =
      Compare(assembly->problem, job->solvers, job->session.true_cam_from_lidar);
  const SolveReport* report = rows.front().report ? &*rows.front().report : nullptr;
  const std::vector<std::string> findings = FindingsOf(*job, views, *assembly, report);
  if (report == nullptr) {
    fmt::print("{}\n{}", DescribeViews(views, *assembly, nullptr, {}), FindingsText(findings));
    return Refuse("calibrate", rows.front().report.error(), kNoAnswer);
  }
  CalibrationResult result = MakeResult(views, *assembly, *report,
                                        {.seed = options.search.seed,
                                         .configuration = ConfigurationOf(options, *job),
                                         .warnings = findings});
  CrossValidate(options, *assembly, *job->solvers.front(), *report, result);
  std::string text = DescribeViews(views, *assembly, report, result.views) + "\n";
  text += DescribeAnswer(*report);
  text += ErrorAgainstTruth(*job, *report);
  if (rows.size() > 1) text += "\n" + DescribeComparison(rows);
  text += FindingsText(result.warnings);
  text += "\n" + Wrapped(result.closing, kLineWidth);
  if (result.trust) text += "\n" + Wrapped(result.trust->verdict, kLineWidth);
  return DeliverResult(options, result, text);
}

}  // namespace sextant::cli
