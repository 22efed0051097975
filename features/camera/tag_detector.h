// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <memory>
#include <opencv2/core/mat.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "base/error.h"
#include "base/options.h"
#include "features/camera/detection.h"

namespace sextant {

/// A way to find tags or checkerboards in an image. Immutable and thread-safe.
///
/// Whatever a library's own origin and habit, corners are in our pixels: each detector's header has
/// the measured difference that it takes away.
class TagDetector {
 public:
  virtual ~TagDetector() = default;
  TagDetector(const TagDetector&) = delete;
  TagDetector& operator=(const TagDetector&) = delete;

  const std::string& name() const { return name_; }  ///< Canonical: makes the same one again.

  /// All that is found, which may be nothing. Errors: those of ToGrey; kInvalidInput with the
  /// library's own words where it refuses the image.
  Expected<Detections> Detect(const cv::Mat& image) const;

 protected:
  explicit TagDetector(std::string name) : name_(std::move(name)) {}

 private:
  virtual Detections DoDetect(const cv::Mat& grey) const = 0;

  std::string name_;
};

using TagDetectorPtr = std::shared_ptr<const TagDetector>;

/// One line of the catalogue of detectors.
struct TagDetectorEntry {
  std::string name;
  std::string summary;
  std::string example;
  std::vector<OptionDoc> options;
  std::function<Expected<TagDetectorPtr>(const std::string& name, const OptionValues& options)>
      make;
};

/// aruco, apriltag and checkerboard.
const std::vector<TagDetectorEntry>& TagDetectorEntries();

/// A detector by name and options: "aruco(dictionary=6x6_250,refine=subpix)".
/// Errors: kParse, kUnknownName (names the nearest known one), kInvalidOption.
Expected<TagDetectorPtr> MakeTagDetector(std::string_view spec);

/// The spec of the detector that finds a family with its own defaults: "aruco(dictionary=6x6_250)"
/// for "aruco_6x6_250", "apriltag(family=tag36h11)" for "tag36h11". Error: kUnknownName.
Expected<std::string> DetectorSpecFor(std::string_view family);

}  // namespace sextant
