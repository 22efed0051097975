// SPDX-License-Identifier: Apache-2.0
#include "report/collect/view_media.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "io/images/image_codec.h"
#include "report/hidden_returns.h"
#include "report/projected_scan.h"

namespace sextant {
namespace {

bool IsNearBoard(const Eigen::Vector3d& point, const std::vector<Neighbourhood>& boards) {
  return std::any_of(boards.begin(), boards.end(), [&](const Neighbourhood& board) {
    return (point - board.center).norm() < board.radius_m;
  });
}

// At most `max` of the items, evenly.
template <class Item>
std::vector<Item> Every(const std::vector<Item>& items, std::size_t max) {
  if (items.size() <= max) return items;
  std::vector<Item> kept;
  for (std::size_t i = 0; i < max; ++i) kept.push_back(items[i * items.size() / max]);
  return kept;
}

// The JPEG, smaller and smaller until it fits.
std::string EncodeWithin(const cv::Mat& image, std::size_t max_bytes) {
  constexpr int kMaxWidth = 1600;
  constexpr int kQuality = 82;
  double scale = std::min(1.0, static_cast<double>(kMaxWidth) / image.cols);
  for (int i = 0; i < 8; ++i) {
    cv::Mat smaller;
    cv::resize(image, smaller, {}, scale, scale, cv::INTER_AREA);
    const Expected<std::string> jpeg = EncodeImage(".jpg", smaller, kQuality);
    if (!jpeg) return {};
    if (jpeg->size() <= max_bytes) return *jpeg;
    const double share = static_cast<double>(max_bytes) / static_cast<double>(jpeg->size());
    scale *= std::max(0.3, 0.95 * std::sqrt(share));
    if (scale * std::min(image.cols, image.rows) < 8.0) return {};
  }
  return {};
}

bool IsInImage(const Eigen::Vector2d& pixel, int width, int height) {
  return pixel.x() > -0.5 && pixel.y() > -0.5 && pixel.x() < width - 0.5 &&
         pixel.y() < height - 0.5;
}

// Seen returns within the image, from far to near.
std::vector<ProjectedReturn> SeenReturns(const MediaSource& source, const PagePhoto& photo) {
  const PointCloud& scan = source.cloud;
  const std::vector<ProjectedReturn> all = ProjectScan(scan, source.camera, source.cam_from_lidar);
  const std::vector<bool> hidden = HiddenReturns(all, SpacingOf(scan, source.camera));
  std::vector<ProjectedReturn> seen;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (!hidden[i] && IsInImage(all[i].pixel, photo.width_px, photo.height_px)) {
      seen.push_back(all[i]);
    }
  }
  return seen;
}

void AddDots(const std::vector<ProjectedReturn>& seen, PagePhoto& photo) {
  if (seen.empty()) return;
  const auto at = [&](double share) {
    return seen[static_cast<std::size_t>(share * static_cast<double>(seen.size() - 1))].range_m;
  };
  photo.farthest_m = at(0.02);
  photo.nearest_m = at(0.98);
  const double decades = std::log(std::max(1.001, photo.farthest_m / photo.nearest_m));
  for (const ProjectedReturn& one : seen) {
    const double share = std::log(photo.farthest_m / one.range_m) / decades;
    photo.dots.push_back({.pixel = one.pixel.cast<float>(),
                          .nearness = static_cast<float>(std::clamp(share, 0.0, 1.0))});
  }
}

// Indices of the chosen returns.
std::vector<std::size_t> ChooseReturns(const MediaSource& source, std::size_t max) {
  constexpr double kFarthest_m = 60.0;
  std::vector<std::size_t> on_boards;
  std::vector<std::size_t> others;
  const std::vector<Eigen::Vector3d>& points = source.cloud.points;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].allFinite()) continue;
    const double range = points[i].norm();
    if (range < 0.01 || range > kFarthest_m) continue;
    (IsNearBoard(points[i], source.boards) ? on_boards : others).push_back(i);
  }
  std::vector<std::size_t> chosen = Every(on_boards, max / 2);
  const std::vector<std::size_t> rest = Every(others, max - chosen.size());
  chosen.insert(chosen.end(), rest.begin(), rest.end());
  return chosen;
}

std::vector<std::uint8_t> IntensitiesOf(const PointCloud& cloud,
                                        const std::vector<std::size_t>& chosen) {
  if (cloud.intensity.size() != cloud.points.size() || chosen.empty()) return {};
  std::vector<float> sorted;
  for (const std::size_t i : chosen) {
    if (std::isfinite(cloud.intensity[i])) sorted.push_back(cloud.intensity[i]);
  }
  if (sorted.empty()) return {};
  std::sort(sorted.begin(), sorted.end());
  const float low = sorted[sorted.size() / 50];
  const float high = sorted[sorted.size() - 1 - sorted.size() / 50];
  if (!(high > low)) return {};
  std::vector<std::uint8_t> levels;
  for (const std::size_t i : chosen) {
    const float share = (cloud.intensity[i] - low) / (high - low);
    const float level = std::isfinite(share) ? 255.0F * std::clamp(share, 0.0F, 1.0F) : 0.0F;
    levels.push_back(static_cast<std::uint8_t>(std::lround(level)));
  }
  return levels;
}

std::array<std::uint8_t, 3> ColourAt(const MediaSource& source, const Eigen::Vector3d& point) {
  constexpr std::array<std::uint8_t, 3> kOutside = {96, 96, 96};
  const cv::Mat& image = source.image;
  const auto pixel = Project(source.camera, source.cam_from_lidar * point);
  if (!pixel || !IsInImage(*pixel, image.cols, image.rows)) return kOutside;
  const auto& bgr = image.at<cv::Vec3b>(static_cast<int>(std::lround(pixel->y())),
                                        static_cast<int>(std::lround(pixel->x())));
  return {bgr[2], bgr[1], bgr[0]};
}

}  // namespace

// Three quarters of the page's limit for all views, of which base 64 takes four characters for
// three bytes; ten bytes for a return, and about nine characters for a dot.
MediaBudget BudgetFor(std::size_t views) {
  const std::size_t share =
      std::min<std::size_t>(800'000, kMaxPageBytes / 4 * 3 / std::max<std::size_t>(1, views));
  return {.jpeg_bytes = share / 2 * 3 / 4, .returns = share * 35 / 100 / 14, .dots = share / 75};
}

cv::Mat AsColour(const cv::Mat& image) {
  cv::Mat eight = image;
  if (image.depth() == CV_16U) image.convertTo(eight, CV_8U, 1.0 / 257.0);
  if (eight.channels() != 1) return eight;
  cv::Mat colour;
  cv::cvtColor(eight, colour, cv::COLOR_GRAY2BGR);
  return colour;
}

std::optional<PagePhoto> MakePhoto(const MediaSource& source, const MediaBudget& budget) {
  const cv::Mat& image = source.image;
  if (image.empty() || image.type() != CV_8UC3) return std::nullopt;
  PagePhoto photo{.jpeg = EncodeWithin(image, budget.jpeg_bytes),
                  .width_px = source.camera.width_px > 0 ? source.camera.width_px : image.cols,
                  .height_px = source.camera.height_px > 0 ? source.camera.height_px : image.rows};
  if (photo.jpeg.empty()) return std::nullopt;
  AddDots(Every(SeenReturns(source, photo), budget.dots), photo);
  return photo;
}

PageScan MakeScan(const MediaSource& source, const MediaBudget& budget) {
  const PointCloud& cloud = source.cloud;
  const std::vector<std::size_t> chosen = ChooseReturns(source, budget.returns);
  PageScan scan{.intensity = IntensitiesOf(cloud, chosen),
                .returns = static_cast<int>(cloud.points.size())};
  const bool has_photo = source.image.type() == CV_8UC3 && !source.image.empty();
  for (const std::size_t i : chosen) {
    scan.in_base.push_back(cloud.points[i].cast<float>());
    if (has_photo) scan.colour.push_back(ColourAt(source, cloud.points[i]));
  }
  return scan;
}

}  // namespace sextant
