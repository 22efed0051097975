// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <string>
#include <vector>

#include "calibrate/match/assemble.h"
#include "calibrate/observe/observe.h"
#include "geometry/camera.h"
#include "geometry/point_cloud.h"
#include "io/bag/bag.h"

namespace sextant {

struct BagSource {
  std::string image_topic{};    ///< Empty: the only topic of images.
  std::string cloud_topic{};    ///< Empty: the only topic of scans.
  double tolerance_s = 0.05;    ///< Largest difference in time between an image and its scan.
  std::size_t max_views = 400;  ///< If there are more, they are selected evenly.
};

/// An image and a scan of a recording that form a view.
struct BagMoment {
  std::size_t image = 0;           ///< Number of the message within its topic.
  std::size_t cloud = 0;           ///< Number of the message within its topic.
  std::int64_t stamp_ns = 0;       ///< Stamp of the scan.
  std::int64_t difference_ns = 0;  ///< Stamp of the image minus stamp of the scan.
};

/// Which messages of a recording are observed.
struct BagPlan {
  std::size_t image_topic = 0;  ///< Index into Bag::topics(), as is cloud_topic.
  std::size_t cloud_topic = 0;
  std::vector<BagMoment> moments{};  ///< In ascending order of the scans' stamps.
  std::optional<Camera> camera{};    ///< From CameraInfo messages beside the images, where present.
  std::string camera_fault{};        ///< Why those that are present give no camera; else empty.
};

/// Chooses topics and pairs their messages. Errors: kMissingData without images or scans, with
/// several topics of them and none named, with no topic of the given name, and where no image is
/// within the tolerance of a scan (with the smallest difference in time); those of the messages.
Expected<BagPlan> PlanBag(const Bag& bag, const BagSource& source);

/// The image and the scan of a moment, by its index in the plan, or why they cannot be decoded.
using MomentVisitor = std::function<void(std::size_t moment, const Expected<cv::Mat>& image,
                                         const Expected<PointCloud>& cloud)>;

/// Decodes every moment and passes it on, on all cores and in no certain order. Only the messages
/// of one batch (64 moments) are in memory at a time. Errors: those of Bag::Read.
Expected<void> VisitMoments(const Bag& bag, const BagPlan& plan, const MomentVisitor& visit);

/// Observes every moment, on all cores, and excludes boards in motion (LeaveOutMotion). The views
/// are in the order of the plan. `step` is called after each, from any thread, and may be empty.
/// Memory is that of VisitMoments. Errors: those of Bag::Read;
/// a message that cannot be decoded gives a view with that error.
Expected<std::vector<SessionView>> ObserveBag(const Bag& bag, const BagPlan& plan,
                                              const Observer& observer,
                                              const std::function<void()>& step);

}  // namespace sextant
