// SPDX-License-Identifier: Apache-2.0
#include "features/camera/apriltag_detector.h"

#include <algorithm>
#include <mutex>

#include "features/camera/contrast_regions.h"
#include "features/camera/image_noise.h"
#include "features/camera/tags/apriltag_family.h"

namespace sextant {
namespace {

struct AprilTagOptions {
  std::size_t family = 0;
  int threads = 1;
  double decimate = 1.0;
  double blur_px = 0.0;
  bool refine_edges = true;
  int hamming = -1;
  double min_margin = 0.0;
};

OptionSet<AprilTagOptions> Options() {
  OptionSet<AprilTagOptions> options;
  options.Choice("family", &AprilTagOptions::family, AprilTagFamilyNames(), "what is looked for")
      .Count("threads", &AprilTagOptions::threads, 1, 256, "threads for one image")
      .Real("decimate", &AprilTagOptions::decimate, "1", 1.0, 16.0,
            "quads are looked for in the image reduced by this: 1, 1.5 or a whole number")
      .Real("blur_px", &AprilTagOptions::blur_px, "px", -10.0, 10.0,
            "sigma of the blur before quads are looked for; negative sharpens")
      .Choice("refine_edges", &AprilTagOptions::refine_edges, {"false", "true"},
              "snap the edges to gradients of the full image")
      .Count("hamming", &AprilTagOptions::hamming, -1, 2,
             "wrong bits that are corrected; -1: one, and two where the noise explains them, "
             "as far as the table takes less than 32 MB")
      .Real("min_margin", &AprilTagOptions::min_margin, "grey levels", 0.0, 255.0,
            "minimum decision margin of a tag");
  return options;
}

// The largest number of corrected bits, up to 2, whose table takes less than 32 MB. The library
// makes a table with three slots of 16 bytes for each code with each set of wrong bits.
int AffordableHamming(const apriltag_family_t& family) {
  constexpr double kMaxBytes = 32e6;
  const double bits = family.nbits;
  const double bytes_per_set = 48.0 * family.ncodes;
  if (bytes_per_set * (1.0 + bits + 0.5 * bits * (bits - 1.0)) < kMaxBytes) return 2;
  return bytes_per_set * (1.0 + bits) < kMaxBytes ? 1 : 0;
}

// By default two wrong bits count as those of a tag only if its contrast is so low that noise may
// have changed them: real photos have quads of high contrast that are two bits from a code.
bool IsBelieved(const AprilTagOptions& options, const apriltag_detection_t& tag,
                double noise_grey) {
  constexpr double kMaxMarginOverNoise = 4.0;
  return options.hamming >= 0 || tag.hamming < 2 ||
         static_cast<double>(tag.decision_margin) < kMaxMarginOverNoise * noise_grey;
}

// The library's detector, which processes one image at a time.
class Engine {
 public:
  Engine(const AprilTagOptions& options, const std::vector<std::string>& families)
      : detector_(apriltag_detector_create(), apriltag_detector_destroy) {
    for (const std::string& name : families) {
      families_.push_back(MakeAprilTagFamily(name));
      apriltag_family_t& family = *families_.back();
      const int hamming = options.hamming < 0 ? AffordableHamming(family) : options.hamming;
      apriltag_detector_add_family_bits(detector_.get(), &family, hamming);
    }
    detector_->nthreads = options.threads;
    detector_->quad_decimate = static_cast<float>(options.decimate);
    detector_->quad_sigma = static_cast<float>(options.blur_px);
    detector_->refine_edges = options.refine_edges;
  }
  ~Engine() { apriltag_detector_clear_families(detector_.get()); }
  Engine(const Engine&) = delete;
  Engine& operator=(const Engine&) = delete;

  zarray_t* Detect(const cv::Mat& grey, int min_range) {
    detector_->qtp.min_white_black_diff = min_range;
    image_u8_t image = {grey.cols, grey.rows, static_cast<std::int32_t>(grey.step), grey.data};
    return apriltag_detector_detect(detector_.get(), &image);
  }

 private:
  std::vector<AprilTagFamily> families_;
  std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector_;
};

// The minimum range of grey levels in 12 x 12 pixels for which the library thresholds them. White
// noise in 144 pixels ranges over 5.2 sigma; on a tag's edge the tag's contrast is added. From 6.5
// sigma on, noise is no longer traced, while every tag that the library finds in that noise at all
// (contrast of 3 sigma) is still found. The maximum limits the effect of texture, which is the
// likelier cause of higher noise estimates.
int MinRange(double noise_grey) {
  constexpr double kSigmas = 6.5;
  constexpr int kDefault = 5;
  constexpr int kMax = 32;
  return std::clamp(static_cast<int>(kSigmas * noise_grey), kDefault, kMax);
}

// Whether the library works on unfiltered pixels: it decimates by skipping pixels, which keeps
// their noise, and the tiles of the decimated image are those of the whole image.
bool UsesRawPixels(const AprilTagOptions& options) {
  const double decimate = options.decimate;
  return (decimate == 1.0 || decimate == 2.0 || decimate == 4.0) && options.blur_px == 0.0;
}

std::vector<cv::Rect> RegionsOf(const AprilTagOptions& options, const cv::Mat& grey) {
  if (UsesRawPixels(options)) return ContrastRegions(grey);
  return {cv::Rect(0, 0, grey.cols, grey.rows)};
}

// The library's corners go counter-clockwise as seen, from the tag's own bottom-left.
TagDetection FromLibrary(const AprilTagOptions& options, const apriltag_detection_t& tag) {
  // Measured against rendered tags, see docs/detectors.md.
  const double shift_px = options.refine_edges ? 0.5 : 0.445 - 0.075 * (options.decimate - 1.0);
  TagDetection detection{.family = tag.family->name,
                         .id = tag.id,
                         .corners_px = {},
                         .decision_margin = static_cast<double>(tag.decision_margin),
                         .hamming = tag.hamming};
  for (std::size_t k = 0; k < 4; ++k) {
    const double* corner = tag.p[3 - k];
    detection.corners_px[k] = Eigen::Vector2d(corner[0], corner[1]).array() - shift_px;
  }
  return detection;
}

void DetectIn(Engine& engine, const AprilTagOptions& options, const cv::Mat& grey,
              const cv::Rect& region, std::vector<TagDetection>& tags) {
  const cv::Mat part = grey(region);
  const double noise_grey = UsesRawPixels(options) ? EstimateNoiseGrey(part) : 0.0;
  const std::unique_ptr<zarray_t, void (*)(zarray_t*)> quads(
      engine.Detect(part, MinRange(noise_grey)), apriltag_detections_destroy);
  for (int i = 0; i < zarray_size(quads.get()); ++i) {
    apriltag_detection_t* tag = nullptr;
    zarray_get(quads.get(), i, &tag);
    if (tag->decision_margin < options.min_margin) continue;
    if (!IsBelieved(options, *tag, noise_grey)) continue;
    tags.push_back(FromLibrary(options, *tag));
    for (Eigen::Vector2d& corner : tags.back().corners_px) {
      corner += Eigen::Vector2d(region.x, region.y);
    }
  }
}

class AprilTagDetector final : public TagDetector {
 public:
  AprilTagDetector(std::string name, const AprilTagOptions& options)
      : TagDetector(std::move(name)), options_(options) {
    idle_.push_back(MakeEngine());
  }

 private:
  std::unique_ptr<Engine> MakeEngine() const {
    return std::make_unique<Engine>(options_, std::vector{AprilTagFamilyNames()[options_.family]});
  }

  Detections DoDetect(const cv::Mat& grey) const override {
    std::unique_ptr<Engine> engine = Take();
    Detections found;
    for (const cv::Rect& region : RegionsOf(options_, grey)) {
      DetectIn(*engine, options_, grey, region, found.tags);
    }
    const std::lock_guard lock(mutex_);
    idle_.push_back(std::move(engine));
    return found;
  }

  std::unique_ptr<Engine> Take() const {
    {
      const std::lock_guard lock(mutex_);
      if (!idle_.empty()) {
        std::unique_ptr<Engine> engine = std::move(idle_.back());
        idle_.pop_back();
        return engine;
      }
    }
    return MakeEngine();
  }

  AprilTagOptions options_;
  mutable std::mutex mutex_;
  mutable std::vector<std::unique_ptr<Engine>> idle_;  ///< One per thread that ever ran at once.
};

}  // namespace

std::vector<TagDetection> DetectAllAprilTags(const cv::Mat& grey) {
  const AprilTagOptions options{.hamming = 0};
  Engine engine(options, AprilTagFamilyNames());
  std::vector<TagDetection> tags;
  for (const cv::Rect& region : RegionsOf(options, grey)) {
    DetectIn(engine, options, grey, region, tags);
  }
  return tags;
}

TagDetectorEntry AprilTagDetectorEntry() {
  return {
      .name = "apriltag",
      .summary = "the AprilTag 3 library",
      .example = "apriltag(family=tag36h11,decimate=2)",
      .options = Options().Describe(),
      .make = [](const std::string& name, const OptionValues& values) -> Expected<TagDetectorPtr> {
        SEXTANT_ASSIGN_OR_RETURN(const AprilTagOptions options, Options().Parse(values));
        return std::make_shared<AprilTagDetector>(name, options);
      }};
}

}  // namespace sextant
