// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>
#include <vector>

#include "geometry/camera.h"
#include "geometry/point_cloud.h"
#include "geometry/rigid3d.h"
#include "report/page/page.h"

namespace sextant {

/// A page stays below this size, whatever the number of views.
inline constexpr std::size_t kMaxPageBytes = 25'000'000;

/// How much of a view the page can hold.
struct MediaBudget {
  std::size_t jpeg_bytes = 0;
  std::size_t returns = 0;  ///< In three dimensions.
  std::size_t dots = 0;     ///< On the photo.
};
MediaBudget BudgetFor(std::size_t views);

/// Where the returns matter most: around a board, in the LiDAR frame [m].
struct Neighbourhood {
  Eigen::Vector3d center = Eigen::Vector3d::Zero();
  double radius_m = 0.0;
};

struct MediaSource {
  const cv::Mat& image;  ///< BGR of 8 bits (AsColour).
  const PointCloud& cloud;
  const Camera& camera;
  Rigid3d cam_from_lidar{};
  std::vector<Neighbourhood> boards{};
};

/// A grey or BGR image of 8 or 16 bits as BGR of 8 bits.
cv::Mat AsColour(const cv::Mat& image);

/// The photo as a JPEG of bounded size with the returns that it shows, from far to near; without
/// those that something nearer hides from the camera (HiddenReturns). None if it cannot be encoded.
std::optional<PagePhoto> MakePhoto(const MediaSource& source, const MediaBudget& budget);

/// The returns within 60 m, at most budget.returns of them: up to half of these from the boards,
/// the others evenly from the whole scan.
PageScan MakeScan(const MediaSource& source, const MediaBudget& budget);

}  // namespace sextant
