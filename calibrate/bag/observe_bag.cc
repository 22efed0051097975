// SPDX-License-Identifier: Apache-2.0
#include "calibrate/bag/observe_bag.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <map>
#include <utility>

#include "calibrate/bag/bag_image.h"
#include "calibrate/bag/bag_streams.h"
#include "calibrate/match/motion.h"
#include "io/bag/messages.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

double Seconds(std::int64_t ns) { return 1e-9 * static_cast<double>(ns); }

// The pairs of topics of images and of scans, the first few by name.
std::string KnownTopics(const Bag& bag) {
  constexpr std::size_t kMaxListed = 20;
  std::vector<std::string> images;
  std::vector<std::string> clouds;
  for (const BagTopic& topic : bag.topics()) {
    const bool is_cloud = topic.kind == MessageKind::kPointCloud;
    const bool is_image =
        topic.kind == MessageKind::kImage || topic.kind == MessageKind::kEncodedImage;
    if (is_cloud || is_image) (is_cloud ? clouds : images).push_back(Printable(topic.name, 100));
  }
  if (images.empty() || clouds.empty()) return {};
  const std::size_t pairs = images.size() * clouds.size();
  std::string known;
  for (std::size_t i = 0; i < std::min(pairs, kMaxListed); ++i) {
    known += fmt::format("{}{} with {}", i == 0 ? "" : "; ", images[i % images.size()],
                         clouds[i / images.size()]);
  }
  return known + (pairs > kMaxListed ? fmt::format("; and {} more", pairs - kMaxListed) : "");
}

// The pairing of the named topics, or the only one.
Expected<const BagPairing*> ChoosePairing(const Bag& bag, const BagStreams& all) {
  const std::string known = KnownTopics(bag);
  if (known.empty()) {
    return MakeError(ErrorCode::kMissingData,
                     "the recording has no topic of images (Image, CompressedImage) beside one of "
                     "scans (PointCloud2, Livox CustomMsg)");
  }
  if (all.pairings.size() == 1) return &all.pairings.front();
  return MakeError(ErrorCode::kMissingData,
                   fmt::format("{} topics fit: name one of images with --image-topic and one of "
                               "scans with --cloud-topic; there are: {}",
                               all.pairings.empty() ? "no" : "several", known));
}

// The smallest difference in time between an image and a scan. Requires stamps of both.
std::int64_t NearestGap(std::vector<std::int64_t> images, std::vector<std::int64_t> scans) {
  std::ranges::sort(images);
  std::int64_t smallest = std::abs(images.front() - scans.front());
  for (const std::int64_t scan : scans) {
    const auto after = std::ranges::lower_bound(images, scan);
    if (after != images.end()) smallest = std::min(smallest, *after - scan);
    if (after != images.begin()) smallest = std::min(smallest, scan - *(after - 1));
  }
  return smallest;
}

tl::unexpected<Error> NoCommonStamps(const BagStream& images, const BagStream& scans,
                                     double tolerance_s) {
  if (images.stamps_ns.empty() || scans.stamps_ns.empty()) {
    return MakeError(ErrorCode::kMissingData,
                     fmt::format("the recording has {} images and {} scans of these topics",
                                 images.stamps_ns.size(), scans.stamps_ns.size()));
  }
  return MakeError(
      ErrorCode::kMissingData,
      fmt::format(
          "the time stamps do not match: no image is within {} s of a scan, the nearest are "
          "{:.3f} s apart. Are both sensors' clocks the same? A wider --tolerance pairs "
          "them, which is right only if the board is still",
          tolerance_s, Seconds(NearestGap(images.stamps_ns, scans.stamps_ns))));
}

// The CameraInfo topic in the namespace of the images, or the only one.
std::optional<std::size_t> InfoTopic(const Bag& bag, const std::string& images) {
  const std::string home = images.substr(0, images.rfind('/') + 1);
  std::vector<std::size_t> infos;
  for (std::size_t i = 0; i < bag.topics().size(); ++i) {
    if (bag.topics()[i].kind != MessageKind::kCameraInfo) continue;
    if (bag.topics()[i].name.starts_with(home)) return i;
    infos.push_back(i);
  }
  if (infos.size() != 1) return std::nullopt;
  return infos.front();
}

Expected<std::optional<Camera>> CameraIn(const Bag& bag, const std::string& images) {
  const std::optional<std::size_t> topic = InfoTopic(bag, images);
  if (!topic) return std::optional<Camera>();
  std::optional<Camera> camera;
  SEXTANT_RETURN_IF_ERROR(
      bag.Read({*topic}, [&camera](const BagMessage& message) -> Expected<void> {
        if (camera) return {};
        SEXTANT_ASSIGN_OR_RETURN(const CameraInfoMessage info, DecodeCameraInfo(message));
        camera = info.camera;
        return {};
      }));
  return camera;
}

// A copy of a message that stays valid after Bag::Read moves on.
struct MessageCopy {
  BagMessage message{};
  std::string data{};

  BagMessage Get() const {
    BagMessage copy = message;
    copy.data = data;
    return copy;
  }
};

struct PendingMoment {
  std::size_t index = 0;
  std::optional<MessageCopy> image{};
  std::optional<MessageCopy> cloud{};
};

Expected<cv::Mat> DecodeAny(const BagMessage& message) {
  if (message.topic->kind == MessageKind::kEncodedImage) {
    SEXTANT_ASSIGN_OR_RETURN(const EncodedImageMessage image, DecodeEncodedImage(message));
    return ToMat(image);
  }
  SEXTANT_ASSIGN_OR_RETURN(const ImageMessage image, DecodeImage(message));
  return ToMat(image);
}

Expected<PointCloud> DecodeScan(const BagMessage& message) {
  SEXTANT_ASSIGN_OR_RETURN(CloudMessage cloud, DecodePointCloud(message));
  return std::move(cloud.cloud);
}

// Collects messages until a batch of moments is complete, then visits the batch on all cores.
class Batches {
 public:
  Batches(const BagPlan& plan, const MomentVisitor& visit) : plan_(plan), visit_(visit) {
    for (std::size_t i = 0; i < plan.moments.size(); ++i) {
      moment_of_image_[plan.moments[i].image] = i;
      moment_of_cloud_[plan.moments[i].cloud] = i;
    }
  }

  void Take(const BagMessage& message) {
    const bool is_image = message.topic_index == plan_.image_topic;
    const std::size_t number = is_image ? images_++ : clouds_++;
    const auto& moments = is_image ? moment_of_image_ : moment_of_cloud_;
    const auto found = moments.find(number);
    if (found == moments.end()) return;
    PendingMoment& moment = waiting_[found->second];
    moment.index = found->second;
    (is_image ? moment.image : moment.cloud) = MessageCopy{message, std::string(message.data)};
    if (!moment.image || !moment.cloud) return;
    whole_.push_back(std::move(moment));
    waiting_.erase(found->second);
    if (whole_.size() == kBatch) Work();
  }

  void Work() {
    tbb::parallel_for(std::size_t{0}, whole_.size(), [this](std::size_t i) {
      visit_(whole_[i].index, DecodeAny(whole_[i].image->Get()),
             DecodeScan(whole_[i].cloud->Get()));
    });
    whole_.clear();
  }

 private:
  static constexpr std::size_t kBatch = 64;

  const BagPlan& plan_;
  const MomentVisitor& visit_;
  std::map<std::size_t, std::size_t> moment_of_image_;
  std::map<std::size_t, std::size_t> moment_of_cloud_;
  std::map<std::size_t, PendingMoment> waiting_;
  std::vector<PendingMoment> whole_;
  std::size_t images_ = 0;  // Number of the next image, and below of the next scan.
  std::size_t clouds_ = 0;
};

std::vector<SessionView> ViewsOf(const BagPlan& plan) {
  std::vector<SessionView> views(plan.moments.size());
  for (std::size_t i = 0; i < views.size(); ++i) {
    const BagMoment& moment = plan.moments[i];
    views[i].cloud_time_s = Seconds(moment.stamp_ns);
    views[i].image_time_s = Seconds(moment.stamp_ns + moment.difference_ns);
    views[i].name =
        fmt::format("{:.3f} s", Seconds(moment.stamp_ns - plan.moments.front().stamp_ns));
  }
  return views;
}

Expected<Observation> Examine(const Observer& observer, const Expected<cv::Mat>& image,
                              const Expected<PointCloud>& cloud) {
  if (!image) return tl::unexpected<Error>(image.error());
  if (!cloud) return tl::unexpected<Error>(cloud.error());
  return observer.Observe(*image, *cloud);
}

}  // namespace

Expected<BagPlan> PlanBag(const Bag& bag, const BagSource& source) {
  const auto tolerance_ns = static_cast<std::int64_t>(1e9 * source.tolerance_s);
  SEXTANT_ASSIGN_OR_RETURN(const BagStreams all, ReadStreams(bag, tolerance_ns,
                                                             {.image_topic = source.image_topic,
                                                              .cloud_topic = source.cloud_topic}));
  SEXTANT_ASSIGN_OR_RETURN(const BagPairing* pairing, ChoosePairing(bag, all));
  const BagStream& images = all.streams[pairing->images];
  const BagStream& scans = all.streams[pairing->scans];
  const std::vector<StampPair>& pairs = pairing->pairs.pairs;
  if (pairs.empty()) return NoCommonStamps(images, scans, source.tolerance_s);
  BagPlan plan{.image_topic = images.topic, .cloud_topic = scans.topic};
  const std::size_t count = std::min(pairs.size(), source.max_views);
  for (std::size_t k = 0; k < count; ++k) {
    const StampPair& pair = pairs[k * pairs.size() / count];
    plan.moments.push_back({.image = pair.second,
                            .cloud = pair.first,
                            .stamp_ns = scans.stamps_ns[pair.first],
                            .difference_ns = pair.difference_ns});
  }
  // A camera that was never calibrated fills its messages with zeros: the user may have a file.
  const auto camera = CameraIn(bag, bag.topics()[plan.image_topic].name);
  if (camera) plan.camera = *camera;
  if (!camera) plan.camera_fault = camera.error().message;
  return plan;
}

Expected<void> VisitMoments(const Bag& bag, const BagPlan& plan, const MomentVisitor& visit) {
  Batches batches(plan, visit);
  SEXTANT_RETURN_IF_ERROR(bag.Read({plan.image_topic, plan.cloud_topic},
                                   [&batches](const BagMessage& message) -> Expected<void> {
                                     batches.Take(message);
                                     return {};
                                   }));
  batches.Work();
  return {};
}

Expected<std::vector<SessionView>> ObserveBag(const Bag& bag, const BagPlan& plan,
                                              const Observer& observer,
                                              const std::function<void()>& step) {
  std::vector<SessionView> views = ViewsOf(plan);
  SEXTANT_RETURN_IF_ERROR(VisitMoments(
      bag, plan,
      [&](std::size_t i, const Expected<cv::Mat>& image, const Expected<PointCloud>& cloud) {
        views[i].seen = Examine(observer, image, cloud);
        if (step) step();
      }));
  std::vector<double> times_s;
  for (const BagMoment& moment : plan.moments) times_s.push_back(Seconds(moment.stamp_ns));
  LeaveOutMotion(views, times_s, observer.camera());
  return views;
}

}  // namespace sextant
