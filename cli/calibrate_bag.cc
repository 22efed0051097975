// SPDX-License-Identifier: Apache-2.0
#include <fmt/core.h>

#include "calibrate/bag/observe_bag.h"
#include "cli/calibrate_source.h"
#include "cli/progress.h"

namespace sextant::cli {

Expected<RecordedViews> LookAtRecording(const Session& session, const ObserveRecording& how) {
  SEXTANT_ASSIGN_OR_RETURN(const std::unique_ptr<Bag> bag, OpenBag(session.bag));
  const Expected<BagPlan> plan = PlanBag(*bag, {.image_topic = session.image_topic,
                                                .cloud_topic = session.cloud_topic,
                                                .tolerance_s = how.tolerance_s});
  if (!plan) {
    return MakeError(plan.error().code,
                     fmt::format("{}: {}", session.bag.string(), plan.error().message));
  }
  const std::string& images = (bag)->topics()[plan->image_topic].name;
  RecordedViews recorded;
  if (!how.camera && !plan->camera) {
    return MakeError(ErrorCode::kMissingData,
                     fmt::format("{}: no CameraInfo beside {}: give the intrinsics with --camera",
                                 session.bag.string(), images));
  }
  recorded.camera = how.camera ? *how.camera : *plan->camera;
  SEXTANT_ASSIGN_OR_RETURN(const Observer observer,
                           Observer::Make(how.boards, recorded.camera, how.observe));
  Progress progress("views", static_cast<long>(plan->moments.size()));
  Expected<std::vector<SessionView>> views =
      ObserveBag(*bag, *plan, observer, [&progress] { progress.Step(); });
  if (!views) return tl::unexpected<Error>(views.error());
  recorded.views = std::move(*views);
  recorded.summary = fmt::format("{} with {}: {} pairs", images,
                                 (bag)->topics()[plan->cloud_topic].name, plan->moments.size());
  return recorded;
}

}  // namespace sextant::cli
