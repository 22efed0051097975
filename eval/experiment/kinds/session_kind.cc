// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <memory>
#include <string>
#include <utility>

#include "base/units.h"
#include "calibrate/calibrate.h"
#include "eval/experiment/definition/parameter_set.h"
#include "eval/experiment/kinds/problem_trials.h"
#include "eval/experiment/kinds/session_simulation.h"
#include "eval/metrics/bounds.h"
#include "geometry/so3.h"

namespace sextant {
namespace {

struct SessionTrialSettings : SessionSettings, PoseLimits {
  int bootstrap = 100;
};

// Metrics after PoseMetrics(), in this order.
enum SessionMeasured : int {
  kVerdictGood = kPoseMetricCount,
  kVerdictCare,
  kVerdictNotUsable,
  kGoodButWrong,
  kCauseNamed,
  kViewsUsed,
  kStatedDeg,
  kStatedMm,
};

const std::vector<Metric>& SessionMetrics() {
  static const std::vector<Metric> metrics = [] {
    std::vector<Metric> all = PoseMetrics();
    all.push_back({"good", "1 if the verdict is GOOD"});
    all.push_back({"care", "1 if the verdict is USABLE WITH CARE"});
    all.push_back({"not_usable", "1 if the verdict is NOT USABLE, or there is no pose"});
    all.push_back({"good_but_wrong", "1 if the verdict is GOOD, but the pose is overconfident"});
    all.push_back({"cause_named",
                   "1 if verdict, advice or warnings name the fault; none where the verdict is "
                   "GOOD or there is no fault"});
    all.push_back({"views_used", "number of views that the answer rests on"});
    all.push_back({"stated_deg", "stated RMS error of the rotation"});
    all.push_back({"stated_mm", "stated RMS error of the translation"});
    return all;
  }();
  return metrics;
}

const ParameterSet<SessionTrialSettings>& SessionParameters() {
  static const ParameterSet<SessionTrialSettings> set = [] {
    ParameterSet<SessionTrialSettings> options;
    options
        .Text("scene", &SessionSettings::scene, "path",
              "scene file, relative to the experiment's folder; its first board is carried around")
        .Text("lidar_model", &SessionSettings::lidar_model, "name", "empty: as in the scene")
        .Count("views", &SessionSettings::views, 1, 100, "number of photos and scans")
        .Real("nearest_m", &SessionSettings::nearest_m, "m", 0.3, 100.0,
              "minimum distance of the board from the camera")
        .Real("farthest_m", &SessionSettings::farthest_m, "m", 0.3, 100.0,
              "maximum distance of the board from the camera")
        .Real("yaw_deg", &SessionSettings::yaw_deg, "deg", 0.0, 60.0,
              "maximum turn of the board away from the line of sight")
        .Real("pitch_deg", &SessionSettings::pitch_deg, "deg", 0.0, 60.0,
              "maximum tilt forwards or backwards")
        .Real("roll_deg", &SessionSettings::roll_deg, "deg", -180.0, 180.0,
              "rotation in the board's plane; at 45 a square board has a corner up")
        .Real("roll_spread_deg", &SessionSettings::roll_spread_deg, "deg", 0.0, 180.0,
              "maximum difference from it")
        .Count("bootstrap", &SessionTrialSettings::bootstrap, 0, 1000, "samples of the bootstrap")
        .Choice("fault", &SessionSettings::fault, SessionFaultNames(),
                "what is wrong with each session or its files");
    return AddPoseLimits(options);
  }();
  return set;
}

// A checkerboard looks the same upside down: the true pose with corner 0 as the detector chose it.
Rigid3d AsNumbered(const Rigid3d& cam_from_board, const Rigid3d& seen) {
  const Eigen::Quaterniond half_turn(0.0, 0.0, 0.0, 1.0);
  const Rigid3d turned = cam_from_board * Rigid3d{half_turn, Eigen::Vector3d::Zero()};
  const bool is_turned = RotationDistance(turned.rotation, seen.rotation) <
                         RotationDistance(cam_from_board.rotation, seen.rotation);
  return is_turned ? turned : cam_from_board;
}

class SessionTrials final : public Trials {
 public:
  SessionTrials(const SessionTrialSettings& settings, SessionSimulator simulator,
                std::vector<SolverPtr> solvers)
      : settings_(settings), simulator_(std::move(simulator)), solvers_(std::move(solvers)) {
    for (const SolverPtr& solver : solvers_) names_.push_back(solver->spec().name);
  }

  const std::vector<std::string>& subjects() const override { return names_; }

  Expected<CalibrationProblem> ProblemOf(const TrialId& id) const override {
    SEXTANT_ASSIGN_OR_RETURN(const RecordedSession session, simulator_.Record(id.seed));
    SEXTANT_ASSIGN_OR_RETURN(const ObservedSession observed, Observe(session));
    return Assemble(observed.views, observed.boards, observed.camera).map([](Assembly&& assembly) {
      return std::move(assembly.problem);
    });
  }

  void Run(const TrialId& id, TrialRows& rows) const override {
    const Expected<RecordedSession> session = simulator_.Record(id.seed);
    const Expected<ObservedSession> observed =
        session ? Observe(*session) : tl::unexpected<Error>(session.error());
    for (std::size_t k = 0; k < solvers_.size(); ++k) {
      MetricValues values = rows.Add(static_cast<int>(k));
      if (!observed) continue;
      const Calibration calibration = CalibrateObserved(*observed, OptionsFor(k));
      Measure(*session, calibration, values);
    }
  }

 private:
  static Expected<ObservedSession> Observe(const RecordedSession& session) {
    std::vector<Frame> frames;
    for (std::size_t i = 0; i < session.images.size(); ++i) {
      frames.push_back({std::to_string(i + 1), session.images[i], session.scans[i]});
    }
    CalibrateOptions options;
    options.boards = {session.board};
    options.camera = session.camera;
    return ObserveFrames(frames, options);
  }

  CalibrateOptions OptionsFor(std::size_t solver) const {
    CalibrateOptions options;
    options.solvers = {solvers_[solver]};
    options.bootstrap_samples = settings_.bootstrap;
    return options;
  }

  void Measure(const RecordedSession& session, const Calibration& calibration,
               MetricValues& values) const {
    KnownProblem known;
    known.cam_from_lidar = session.cam_from_lidar;
    const SolveReport* report = calibration.report();
    if (report == nullptr || !calibration.result) {
      MeasurePose(known, tl::unexpected<Error>(Error(ErrorCode::kMissingData, "no pose")),
                  settings_, values);
    } else {
      MeasurePose(known, *report, settings_, values);
      MeasureStated(*report, values);
      MeasureBound(session, calibration.problem, values);
    }
    MeasureVerdict(session, calibration, values);
  }

  static void MeasureStated(const SolveReport& report, MetricValues& values) {
    if (!report.covariance) return;
    const RmsError stated = RmsOf(*report.covariance);
    values.Set(kStatedDeg, kDegPerRad * stated.rotation_rad);
    values.Set(kStatedMm, kMmPerM * stated.translation_m);
  }

  // The bound of the assembled views, with the sensor's true white noise and the true spread of its
  // rings' offsets; all else that is unknown to the solver is unknown here, too.
  void MeasureBound(const RecordedSession& session, CalibrationProblem problem,
                    MetricValues& values) const {
    if (!values.Wants(kBoundRotationDeg) && !values.Wants(kBoundTranslationMm)) return;
    problem.lidar_errors.ring_offset_sigma_m = simulator_.lidar().ring_bias_sigma_m;
    problem.lidar_errors.view_shift_sigma_m = 0.0;
    std::vector<Rigid3d> cam_from_board;
    for (BoardView& view : problem.board_views) {
      view.range_sigma_m = simulator_.lidar().range_sigma_m;
      cam_from_board.push_back(AsNumbered(
          session.cam_from_board[static_cast<std::size_t>(view.view)], view.cam_from_board));
    }
    const Expected<Matrix6d> bound =
        CramerRaoBoundOfSession(problem, session.cam_from_lidar, cam_from_board);
    if (!bound) return;
    const RmsError rms = RmsOf(*bound);
    values.Set(kBoundRotationDeg, kDegPerRad * rms.rotation_rad);
    values.Set(kBoundTranslationMm, kMmPerM * rms.translation_m);
  }

  void MeasureVerdict(const RecordedSession& session, const Calibration& calibration,
                      MetricValues& values) const {
    const auto& result = calibration.result;
    const bool is_judged = result && result->verdict;
    const Usability usability = is_judged ? result->verdict->usability : Usability::kNotUsable;
    const auto is = [&](Usability which) { return usability == which ? 1.0 : 0.0; };
    values.Set(kVerdictGood, is(Usability::kGood));
    values.Set(kVerdictCare, is(Usability::kUsableWithCare));
    values.Set(kVerdictNotUsable, is(Usability::kNotUsable));
    const bool is_wrong =
        result && result->covariance &&
        IsOverconfident(result->cam_from_lidar, *result->covariance, session.cam_from_lidar);
    values.Set(kGoodButWrong, usability == Usability::kGood && is_wrong ? 1.0 : 0.0);
    if (result) values.Set(kViewsUsed, ViewsUsed(*result));
    if (usability == Usability::kGood) return;
    if (const auto named = NamesCause(settings_.fault, WordsOf(calibration))) {
      values.Set(kCauseNamed, *named ? 1.0 : 0.0);
    }
  }

  static double ViewsUsed(const CalibrationResult& result) {
    return static_cast<double>(std::ranges::count(result.views, true, &ResultView::kept));
  }

  static std::string WordsOf(const Calibration& calibration) {
    std::string words;
    if (!calibration.result) words = calibration.result.error().message;
    if (calibration.result && calibration.result->verdict) {
      words = calibration.result->verdict->reason + "\n" + calibration.result->verdict->next;
    }
    for (const std::string& line : calibration.warnings) words += "\n" + line;
    return words;
  }

  SessionTrialSettings settings_;
  SessionSimulator simulator_;
  std::vector<SolverPtr> solvers_;
  std::vector<std::string> names_;
};

Expected<TrialsPtr> MakeSessionTrials(const KindArguments& arguments) {
  SEXTANT_ASSIGN_OR_RETURN(const SessionTrialSettings settings,
                           SessionParameters().Parse(arguments.parameters));
  SEXTANT_ASSIGN_OR_RETURN(SessionSimulator simulator,
                           SessionSimulator::Make(settings, arguments.folder));
  return std::make_shared<SessionTrials>(settings, std::move(simulator), arguments.solvers);
}

}  // namespace

TrialKind SessionKind() {
  return {.name = "session",
          .summary =
              "whole rendered sessions, from photos and scans to the verdict; one LiDAR unit a "
              "session",
          .parameters = SessionParameters().Describe(),
          .metrics = SessionMetrics(),
          .trials_per_block = 1,
          .make = MakeSessionTrials};
}

}  // namespace sextant
