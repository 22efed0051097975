// SPDX-License-Identifier: Apache-2.0
#include "features/camera/aruco_detector.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "features/camera/contrast_regions.h"
#include "features/camera/tag_reading.h"
#include "features/camera/tags/aruco_dictionary.h"
#include "features/camera/tags/opencv_aruco.h"

namespace sextant {
namespace {

enum class Refinement { kNone, kSubpix, kContour, kAprilTag };

constexpr std::string_view kFamilyPrefix = "aruco_";
constexpr const char* kFileOption = "file";

// The names without their prefix: "6x6_250" for "aruco_6x6_250".
const std::vector<std::string>& DictionaryChoices() {
  static const std::vector<std::string> choices = [] {
    std::vector<std::string> names;
    for (const std::string& name : ArucoDictionaryNames()) {
      names.push_back(name.substr(kFamilyPrefix.size()));
    }
    return names;
  }();
  return choices;
}

struct ArucoOptions {
  std::size_t dictionary = 0;
  Refinement refine = Refinement::kNone;
  int window_px = 5;
  double min_perimeter = 0.03;
  double error_correction = 0.6;
  int decimate = 1;
};

OptionSet<ArucoOptions> ArucoOptionSet() {
  OptionSet<ArucoOptions> options;
  options.Choice("dictionary", &ArucoOptions::dictionary, DictionaryChoices(), "what is looked for")
      .Choice("refine", &ArucoOptions::refine, {"none", "subpix", "contour", "apriltag"},
              "how OpenCV refines corners")
      .Count("window_px", &ArucoOptions::window_px, 1, 50, "half the window of subpix [px]")
      .Real("min_perimeter", &ArucoOptions::min_perimeter, "image sides", 0.001, 4.0,
            "minimum perimeter of a tag, in longer sides of the image")
      .Real("error_correction", &ArucoOptions::error_correction, "1", 0.0, 1.0,
            "fraction of the correctable bits that is corrected")
      .Count("decimate", &ArucoOptions::decimate, 1, 8,
             "the image is reduced by this before tags are looked for");
  return options;
}

// Measured against rendered tags, see docs/detectors.md.
Quad Normalised(const Quad& corners, Refinement refine) {
  constexpr double kNoneInward = 0.445;
  constexpr double kContourInward = 0.49;
  constexpr double kSubpixInward = 0.08;
  constexpr double kAprilTagShift_px = 0.445;
  switch (refine) {
    case Refinement::kNone:
      return MoveEdgesOut(corners, kNoneInward);
    case Refinement::kContour:
      return MoveEdgesOut(corners, kContourInward);
    case Refinement::kSubpix:
      return MoveEdgesOut(corners, kSubpixInward);
    case Refinement::kAprilTag:
      break;
  }
  Quad moved = corners;
  for (Eigen::Vector2d& corner : moved) corner.array() -= kAprilTagShift_px;
  return moved;
}

class ArucoDetector final : public TagDetector {
 public:
  ArucoDetector(std::string name, std::string family, cv::aruco::Dictionary dictionary,
                const ArucoOptions& options)
      : TagDetector(std::move(name)),
        family_(std::move(family)),
        dictionary_(std::move(dictionary)),
        parameters_(ArucoParameters()),
        refine_(options.refine),
        decimate_(options.decimate) {
    parameters_.cornerRefinementMethod = static_cast<int>(options.refine);
    parameters_.cornerRefinementWinSize = options.window_px;
    parameters_.minMarkerPerimeterRate = options.min_perimeter;
    parameters_.errorCorrectionRate = options.error_correction;
    parameters_.markerBorderBits = ArucoBorderCells(family_);
  }

 private:
  Detections DoDetect(const cv::Mat& grey) const override {
    cv::Mat reduced = grey;
    if (decimate_ > 1) {
      const cv::Size size(grey.cols / decimate_, grey.rows / decimate_);
      cv::resize(grey(cv::Rect(cv::Point(), size * decimate_)), reduced, size, 0.0, 0.0,
                 cv::INTER_AREA);
    }
    Detections found;
    for (const cv::Rect& region : ContrastRegions(reduced)) {
      for (const auto& [id, corners] : DetectIn(reduced, region)) {
        found.tags.push_back(Read(grey, id, corners));
      }
    }
    return found;
  }

  using Find = std::pair<int, Quad>;

  // Corners in pixels of `image`.
  std::vector<Find> DetectIn(const cv::Mat& image, const cv::Rect& region) const {
    // OpenCV's perimeters are relative to the sides of the image that it is given.
    const double sides = static_cast<double>(std::max(image.cols, image.rows)) /
                         std::max(region.width, region.height);
    cv::aruco::DetectorParameters parameters = parameters_;
    parameters.minMarkerPerimeterRate *= sides;
    parameters.maxMarkerPerimeterRate *= sides;
    const Eigen::Vector2d origin(region.x, region.y);
    std::vector<Find> finds;
    for (const OpenCvTag& tag : DetectAruco(image(region), dictionary_, parameters)) {
      Quad quad;
      for (std::size_t k = 0; k < 4; ++k) {
        quad[k] = Eigen::Vector2d(tag.corners_px[k].x, tag.corners_px[k].y) + origin;
      }
      finds.emplace_back(tag.id, Normalised(quad, refine_));
    }
    return finds;
  }

  TagDetection Read(const cv::Mat& grey, int id, Quad corners) const {
    // The centre of a reduced pixel is the centre of the pixels that it replaces.
    for (Eigen::Vector2d& corner : corners) {
      corner = corner * decimate_ + Eigen::Vector2d::Constant(0.5 * (decimate_ - 1));
    }
    const TagReading reading =
        ReadTag(grey, corners, MakeArucoPattern(dictionary_, id, parameters_.markerBorderBits));
    return {.family = family_,
            .id = id,
            .corners_px = corners,
            .decision_margin = reading.margin,
            .hamming = reading.wrong_cells};
  }

  std::string family_;
  cv::aruco::Dictionary dictionary_;
  cv::aruco::DetectorParameters parameters_;
  Refinement refine_;
  int decimate_;
};

Expected<TagDetectorPtr> Make(const std::string& name, const OptionValues& values) {
  SEXTANT_ASSIGN_OR_RETURN(const ArucoOptions options, ArucoOptionSet().Parse(values));
  bool names_dictionary = false;
  std::string file;
  for (const auto& [option, text] : values) {
    if (option == kFileOption) file = text;
    if (option == "dictionary") names_dictionary = true;
  }
  if (names_dictionary == !file.empty()) {
    return MakeError(ErrorCode::kInvalidOption,
                     "detector 'aruco' needs either a dictionary or the file of one, as in "
                     "aruco(dictionary=6x6_250)");
  }
  if (!file.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(const auto own, ReadArucoDictionary(file));
    return std::make_shared<ArucoDetector>(name, file, own, options);
  }
  const std::string& family = ArucoDictionaryNames()[options.dictionary];
  return std::make_shared<ArucoDetector>(name, family, *FindArucoDictionary(family), options);
}

}  // namespace

TagDetectorEntry ArucoDetectorEntry() {
  std::vector<OptionDoc> options = ArucoOptionSet().Describe();
  options.front().default_value = "none: required";
  options.push_back({.name = kFileOption,
                     .default_value = "none",
                     .unit = "path",
                     .meaning = "a dictionary in OpenCV's format, instead of `dictionary`"});
  return {.name = "aruco",
          .summary = "OpenCV's aruco module",
          .example = "aruco(dictionary=6x6_250,refine=subpix)",
          .options = std::move(options),
          .make = Make};
}

}  // namespace sextant
