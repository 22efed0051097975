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
  int board = 0;  ///< Place within the boards that were looked for.
  std::vector<BoardPoints> printed{};
  BoardPose pose{};
  /// Outer corners in the camera frame: those of `pose`, and of pose.ambiguous_with where there is
  /// one, with the same covariance.
  PointsInCam corners{};
  std::vector<Eigen::Vector3d> other_corners{};
  std::string left_out{};  ///< Why it is not to be used although it was seen; empty: it is.
};

/// Something in a scan that may be one of the boards.
struct LidarSighting {
  std::vector<BoardPlacement> placements{};  ///< Best first; at least one.
  LidarPlane plane{};
  std::vector<EdgePoint> edges{};
  std::vector<Eigen::Vector3d> face{};  ///< Returns from within the outline [m].
  double range_sigma_m = 0.0;           ///< Of the face's returns, along their rays.
  /// Lengths of its sides 0 to 3 as the best placement numbers them, by edge lines that do not know
  /// its size; empty where a side has too few edge points.
  std::vector<double> measured_sides_m{};
};

/// A board that a sensor does not show, and why.
struct MissingBoard {
  int board = -1;      ///< Place within the boards; -1: the scan does not tell which.
  bool image = false;  ///< It is the image that lacks it; else the scan.
  std::string why{};   ///< One line.
};

/// What the two sensors saw at one moment.
struct Observation {
  std::vector<CameraSighting> in_image{};
  std::vector<LidarSighting> in_scan{};
  std::vector<MissingBoard> missing{};
  LidarPattern lidar{};  ///< As the scan shows it.
};

struct ObserveOptions {
  std::string detector{};               ///< As BoardFinder takes it; empty: the usual ones.
  std::string extractor = "rectangle";  ///< Of CornerExtractors().
  BoardSearchOptions search{};
};

/// Looks for the same boards in images and scans. Immutable and thread-safe.
class Observer {
 public:
  /// Errors: those of BoardFinder::Make; kUnknownName for the extractor; kInvalidInput for no board
  /// and for boards without a size.
  static Expected<Observer> Make(std::vector<Board> boards, const Camera& camera,
                                 const ObserveOptions& options = {});

  const std::vector<Board>& boards() const { return finder_.boards(); }
  const Camera& camera() const { return *finder_.camera(); }
  const ObserveOptions& options() const { return options_; }

  /// Errors: those of BoardFinder::Find and ScanRings::Build. A board that is not seen is none: it
  /// is in `missing`.
  Expected<Observation> Observe(const cv::Mat& image, const PointCloud& cloud) const;

 private:
  Observer(BoardFinder finder, ObserveOptions options)
      : finder_(std::move(finder)), options_(std::move(options)) {}
  Expected<void> LookInImage(const cv::Mat& image, Observation& observation) const;
  Expected<void> LookInScan(const PointCloud& cloud, Observation& observation) const;

  BoardFinder finder_;
  ObserveOptions options_;
};

}  // namespace sextant
