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

/// A detector of tags or checkerboards in images. Immutable and thread-safe.
///
/// Corners are in our pixel convention, whatever that of the library is: each detector's header
/// states the measured offset that it corrects.
class TagDetector {
 public:
  virtual ~TagDetector() = default;
  TagDetector(const TagDetector&) = delete;
  TagDetector& operator=(const TagDetector&) = delete;

  /// Canonical name, from which MakeTagDetector makes the same detector.
  const std::string& name() const { return name_; }

  /// All detections, possibly none. Errors: those of ToGrey; kInvalidInput with the library's own
  /// message if it refuses the image.
  Expected<Detections> Detect(const cv::Mat& image) const;

 protected:
  explicit TagDetector(std::string name) : name_(std::move(name)) {}

 private:
  virtual Detections DoDetect(const cv::Mat& grey) const = 0;

  std::string name_;
};

using TagDetectorPtr = std::shared_ptr<const TagDetector>;

/// An entry of the catalogue of detectors.
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

/// Makes a detector from its name and options: "aruco(dictionary=6x6_250,refine=subpix)".
/// Errors: kParse, kUnknownName (with a suggestion), kInvalidOption.
Expected<TagDetectorPtr> MakeTagDetector(std::string_view spec);

/// The spec of the default detector of a family: "aruco(dictionary=6x6_250)" for "aruco_6x6_250",
/// "apriltag(family=tag36h11)" for "tag36h11". Error: kUnknownName.
Expected<std::string> DetectorSpecFor(std::string_view family);

}  // namespace sextant
