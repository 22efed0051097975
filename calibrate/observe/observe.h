// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <string>
#include <vector>

#include "base/error.h"
#include "calibrate/observe/board_placement.h"
#include "features/camera/find_boards.h"
#include "features/lidar/board_finder.h"
#include "geometry/board.h"
#include "geometry/board_view.h"
#include "geometry/camera.h"
#include "geometry/lidar_pattern.h"
#include "geometry/point_cloud.h"

namespace sextant {

/// A board in an image, with its pose.
struct CameraSighting {
  int board = 0;  ///< Index into Observer::boards().
  std::vector<BoardPoints> printed{};
  BoardPose pose{};
  /// Outer corners in the camera frame by `pose`, and by pose.ambiguous_with where there is one;
  /// both have the same covariance.
  PointsInCam corners{};
  std::vector<Eigen::Vector3d> other_corners{};
  std::string left_out{};  ///< Why this sighting is excluded; empty: it is used.
};

/// A patch of a scan that may be one of the boards.
struct LidarSighting {
  std::vector<BoardPlacement> placements{};  ///< Best first; at least one.
  LidarPlane plane{};
  std::vector<EdgePoint> edges{};
  std::vector<Eigen::Vector3d> face{};  ///< Returns inside the outline [m].
  std::vector<int> face_rings{};        ///< As in BoardView.
  double range_sigma_m = 0.0;           ///< Standard deviation of the face's ranges.
  /// Lengths of sides 0 to 3 in the numbering of the best placement, by lines fitted without the
  /// known size; empty where a side has too few edge points.
  std::vector<double> measured_sides_m{};
};

/// A board that was not found in the image or in the scan, and why.
struct MissingBoard {
  int board = -1;      ///< Index into the boards; -1: unknown, as scans do not identify boards.
  bool image = false;  ///< Missing in the image; false: in the scan.
  std::string why{};   ///< One line.
};

/// The boards in an image and a scan of one moment.
struct Observation {
  std::vector<CameraSighting> in_image{};
  std::vector<LidarSighting> in_scan{};
  std::vector<MissingBoard> missing{};
  LidarPattern lidar{};  ///< Rings and sampling, estimated from the scan.
};

struct ObserveOptions {
  std::string detector{};  ///< A name for BoardFinder; empty: the default of each tag family.
  std::string extractor = "rectangle";  ///< One of CornerExtractors().
  BoardSearchOptions search{};
};

/// Finds known boards in images and scans. Immutable and thread-safe.
class Observer {
 public:
  /// Errors: those of BoardFinder::Make; kUnknownName for the extractor; kInvalidInput for no board
  /// and for boards without a size.
  static Expected<Observer> Make(std::vector<Board> boards, const Camera& camera,
                                 const ObserveOptions& options = {});

  const std::vector<Board>& boards() const { return finder_.boards(); }
  const Camera& camera() const { return *finder_.camera(); }
  const ObserveOptions& options() const { return options_; }

  /// Errors: those of BoardFinder::Find and ScanRings::Build; kMirrored for an image that has a tag
  /// of the boards only in its mirror image. A board that is not found is no
  /// error; it is listed in Observation::missing.
  Expected<Observation> Observe(const cv::Mat& image, const PointCloud& cloud) const;

  /// One of the two parts, added to `observation`. A scan needs no camera.
  Expected<void> ObserveImage(const cv::Mat& image, Observation& observation) const;
  Expected<void> ObserveScan(const PointCloud& cloud, Observation& observation) const;

 private:
  Observer(BoardFinder finder, ObserveOptions options)
      : finder_(std::move(finder)), options_(std::move(options)) {}

  BoardFinder finder_;
  ObserveOptions options_;
};

}  // namespace sextant
