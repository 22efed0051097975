// SPDX-License-Identifier: Apache-2.0
#include <tbb/task_arena.h>

#include <array>
#include <mutex>
#include <utility>

#include "calibrate/match/assemble.h"
#include "calibrate/observe_session.h"
#include "calibrate/session/session.h"
#include "eval/experiment/kinds/real_data.h"
#include "eval/experiment/kinds/real_trials.h"
#include "io/boards/board_file.h"
#include "io/cameras/camera_file.h"

namespace sextant {
namespace {

// What the boards' extraction gives, once for all trials.
Expected<CalibrationProblem> ObserveDataSet(const RealDataSet& set) {
  const std::array<std::string, 1> images = {(set.data / set.manifest.images).string()};
  const std::array<std::string, 1> scans = {(set.data / set.manifest.scans).string()};
  SEXTANT_ASSIGN_OR_RETURN(const Session session, SessionOfFiles(images, scans));
  CalibrateOptions options;
  SEXTANT_ASSIGN_OR_RETURN(options.boards, ReadBoards(set.Find(set.manifest.boards)));
  SEXTANT_ASSIGN_OR_RETURN(const Camera camera, ReadCamera(set.Find(set.manifest.camera)));
  options.camera = camera;
  SEXTANT_ASSIGN_OR_RETURN(const ObservedSession observed, ObserveSession(session, options));
  SEXTANT_ASSIGN_OR_RETURN(Assembly assembly,
                           Assemble(observed.views, observed.boards, observed.camera));
  return std::move(assembly.problem);
}

/// The trials of a recording, whose boards are found in the first one: that takes seconds a view,
/// and reading an experiment file should not.
class RealViewsTrials final : public Trials {
 public:
  RealViewsTrials(RealDataSet set, const RealSettings& settings, std::vector<SolverPtr> solvers,
                  std::string condition)
      : set_(std::move(set)),
        settings_(settings),
        solvers_(std::move(solvers)),
        condition_(std::move(condition)) {
    for (const SolverPtr& solver : solvers_) names_.push_back(solver->spec().name);
  }

  const std::vector<std::string>& subjects() const override { return names_; }

  void Run(const TrialId& id, TrialRows& rows) const override {
    std::call_once(observed_, [this] {
      // Isolated: a thread that waits there must not take another trial, which waits for this.
      Expected<CalibrationProblem> seen =
          tbb::this_task_arena::isolate([this] { return ObserveDataSet(set_); });
      trials_ = std::move(seen).and_then([this](CalibrationProblem&& problem) {
        return MakeRealTrials(std::move(problem), set_.manifest.reference, settings_, solvers_,
                              condition_);
      });
    });
    if (trials_) return (*trials_)->Run(id, rows);
    for (std::size_t k = 0; k < names_.size(); ++k) {
      MeasureNoAnswer(set_.manifest.reference.has_value(), rows.Add(static_cast<int>(k)));
    }
  }

 private:
  RealDataSet set_;
  RealSettings settings_;
  std::vector<SolverPtr> solvers_;
  std::string condition_;
  std::vector<std::string> names_;
  mutable std::once_flag observed_;
  mutable Expected<TrialsPtr> trials_;
};

Expected<TrialsPtr> MakeRealViewsTrials(const KindArguments& arguments) {
  SEXTANT_ASSIGN_OR_RETURN(const RealSettings settings,
                           RealParameters().Parse(arguments.parameters));
  SEXTANT_ASSIGN_OR_RETURN(RealDataSet set, OpenRealData(settings.manifest, arguments.folder));
  if (set.manifest.images.empty()) {
    return MakeError(ErrorCode::kInvalidInput,
                     set.manifest.name + " has correspondences: use the kind real_pairs");
  }
  return std::make_shared<RealViewsTrials>(std::move(set), settings, arguments.solvers,
                                           arguments.condition);
}

}  // namespace

TrialKind RealViewsKind() {
  return {.name = "real_views",
          .summary =
              "images and scans of a real data set, whose boards are found once; views "
              "resampled",
          .skips_absent_data = true,
          .parameters = RealParameters().Describe(),
          .metrics = RealMetrics(),
          .trials_per_block = 10,
          .make = MakeRealViewsTrials};
}

}  // namespace sextant
