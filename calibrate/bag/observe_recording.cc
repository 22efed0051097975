// SPDX-License-Identifier: Apache-2.0
#include "calibrate/bag/observe_recording.h"

#include <fmt/core.h>

#include <memory>

namespace sextant {

Expected<RecordedViews> ObserveRecording(const std::filesystem::path& path,
                                         const RecordingOptions& options,
                                         const ProgressCallback& progress) {
  SEXTANT_ASSIGN_OR_RETURN(const std::unique_ptr<Bag> bag, OpenBag(path));
  const Expected<BagPlan> plan = PlanBag(*bag, options.source);
  if (!plan) {
    return MakeError(plan.error().code, fmt::format("{}: {}", path.string(), plan.error().message));
  }
  if (!options.camera && !plan->camera) {
    const std::string why =
        plan->camera_fault.empty()
            ? fmt::format("no CameraInfo beside {}", bag->topics()[plan->image_topic].name)
            : plan->camera_fault;
    return MakeError(ErrorCode::kMissingData,
                     fmt::format("{}: {}: give the intrinsics with --camera", path.string(), why));
  }
  RecordedViews recorded{.camera = options.camera ? *options.camera : *plan->camera};
  SEXTANT_ASSIGN_OR_RETURN(const Observer observer,
                           Observer::Make(options.boards, recorded.camera, options.observe));
  ProgressCounter counter(progress, "views", plan->moments.size());
  SEXTANT_ASSIGN_OR_RETURN(std::vector<SessionView> views,
                           ObserveBag(*bag, *plan, observer, [&counter] { counter.Step(); }));
  counter.Finish();
  recorded.views = std::move(views);
  if (bag->cut()) recorded.note = fmt::format("{}: {}", path.string(), DescribeCut(*bag));
  return recorded;
}

}  // namespace sextant
