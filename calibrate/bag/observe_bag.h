// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/match/assemble.h"
#include "calibrate/observe/observe.h"
#include "geometry/camera.h"
#include "io/bag/bag.h"

namespace sextant {

struct BagSource {
  std::string image_topic{};  ///< Empty: the only one.
  std::string cloud_topic{};
  double tolerance_s = 0.05;     ///< Between an image and its scan.
  std::size_t most_views = 400;  ///< Of more pairs, as many are taken evenly.
};

/// An image and a scan of a recording that belong together.
struct BagMoment {
  std::size_t image = 0;  ///< Number of the message within its topic.
  std::size_t cloud = 0;
  std::int64_t stamp_ns = 0;       ///< Of the scan.
  std::int64_t difference_ns = 0;  ///< Image less scan.
};

/// What of a recording is looked at.
struct BagPlan {
  std::size_t image_topic = 0;  ///< Into Bag::topics().
  std::size_t cloud_topic = 0;
  std::vector<BagMoment> moments{};  ///< By ascending stamp of the scan.
  std::optional<Camera> camera{};    ///< Of the CameraInfo beside the images, where there is one.
};

/// Errors: kMissingData where there are no images or no scans, several topics of them and none
/// named, none of that name, or no image within the tolerance of a scan (with how far apart the
/// nearest are); those of the messages.
Expected<BagPlan> PlanBag(const Bag& bag, const BagSource& source);

/// Examines every moment, on all cores, in their order; motion is left out (LeaveOutMotion).
/// `step` is called after each. Memory: what the messages of some moments take.
/// Errors: those of Bag::Read; a message that cannot be decoded is a view with that error.
Expected<std::vector<SessionView>> ObserveBag(const Bag& bag, const BagPlan& plan,
                                              const Observer& observer,
                                              const std::function<void()>& step);

}  // namespace sextant
