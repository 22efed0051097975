// SPDX-License-Identifier: Apache-2.0
#include "report/scan_on_image.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "report/fixed_point.h"
#include "report/hidden_returns.h"
#include "report/projected_scan.h"

namespace sextant {
namespace {

bool IsWithin(const Eigen::Vector2d& pixel, const cv::Mat& canvas) {
  return pixel.x() > -0.5 && pixel.y() > -0.5 && pixel.x() < canvas.cols - 0.5 &&
         pixel.y() < canvas.rows - 0.5;
}

// Grey and darker, so that colours stand out.
void MakePale(cv::Mat& canvas) {
  cv::Mat grey;
  cv::cvtColor(canvas, grey, cv::COLOR_BGR2GRAY);
  cv::cvtColor(grey, canvas, cv::COLOR_GRAY2BGR);
  canvas.convertTo(canvas, -1, 0.6, 20.0);
}

// The colour for a range; share 0 is near and blue, 1 is far and red.
cv::Vec3b ColourOf(double share) {
  static const cv::Mat table = [] {
    cv::Mat levels(1, 256, CV_8U);
    for (int i = 0; i < 256; ++i) levels.at<std::uint8_t>(i) = static_cast<std::uint8_t>(i);
    cv::Mat colours;
    cv::applyColorMap(levels, colours, cv::COLORMAP_TURBO);
    return colours;
  }();
  return table.at<cv::Vec3b>(
      static_cast<int>(std::lround(30.0 + 215.0 * std::clamp(share, 0.0, 1.0))));
}

// `returns` are sorted from far to near.
void SetColourRange(const std::vector<ProjectedReturn>& returns, ScanOnImage& drawn) {
  if (returns.empty()) return;
  const std::size_t last = returns.size() - 1;
  const auto place = [last](double share) {
    return last - static_cast<std::size_t>(share * static_cast<double>(last));
  };
  drawn.nearest_m = returns[place(0.02)].range_m;
  drawn.farthest_m = returns[place(0.98)].range_m;
}

// Where there are more returns than a scan has, keeps the nearest one in each square of a quarter
// of a return's diameter: it covers nearly all of the others.
void Thin(const cv::Mat& canvas, double diameter, std::vector<ProjectedReturn>& returns) {
  constexpr std::size_t kMaxDrawn = 1'000'000;
  if (returns.size() <= kMaxDrawn) return;
  const double side = std::max(1.0, 0.25 * diameter);
  const auto columns = static_cast<std::size_t>(canvas.cols / side) + 2;
  const auto rows = static_cast<std::size_t>(canvas.rows / side) + 2;
  std::vector<bool> is_taken(columns * rows, false);
  std::size_t kept = returns.size();
  for (std::size_t i = returns.size(); i-- > 0;) {
    const Eigen::Vector2d at = (returns[i].pixel.array() + 0.5) / side;
    const std::size_t square =
        columns * static_cast<std::size_t>(at.y()) + static_cast<std::size_t>(at.x());
    if (is_taken[square]) continue;
    is_taken[square] = true;
    returns[--kept] = returns[i];
  }
  returns.erase(returns.begin(), returns.begin() + static_cast<std::ptrdiff_t>(kept));
}

double ShareOf(double range_m, const ScanOnImage& drawn) {
  // Logarithmic, because a metre matters more at two metres than at twenty.
  return std::log(range_m / drawn.nearest_m) /
         std::log(std::max(1.001, drawn.farthest_m / drawn.nearest_m));
}

// A colour bar in the lower left corner, with the ranges at its ends and in its middle.
void DrawScale(const ScanOnImage& drawn, cv::Mat& canvas) {
  const double unit = std::max(12.0, canvas.rows / 40.0);
  const int width = cvRound(12.0 * unit);
  const cv::Point corner(cvRound(unit), canvas.rows - cvRound(1.6 * unit));
  for (int x = 0; x < width; ++x) {
    const cv::Vec3b c = ColourOf(static_cast<double>(x) / width);
    cv::line(canvas, corner + cv::Point(x, 0), corner + cv::Point(x, cvRound(0.6 * unit)),
             cv::Scalar(c[0], c[1], c[2]));
  }
  const cv::Scalar white(255, 255, 255);
  DrawLabel(fmt::format("{:.1f}", drawn.nearest_m), corner - cv::Point(0, cvRound(0.4 * unit)),
            0.9 * unit, white, canvas);
  DrawLabel(fmt::format("{:.1f}", std::sqrt(drawn.nearest_m * drawn.farthest_m)),
            corner + cv::Point(width / 2 - cvRound(0.8 * unit), -cvRound(0.4 * unit)), 0.9 * unit,
            white, canvas);
  DrawLabel(fmt::format("{:.1f} m", drawn.farthest_m),
            corner + cv::Point(width - cvRound(2.4 * unit), -cvRound(0.4 * unit)), 0.9 * unit,
            white, canvas);
}

}  // namespace

ScanOnImage DrawScanOnImage(const PointCloud& scan, const Camera& camera,
                            const Rigid3d& cam_from_lidar, const ScanStyle& style,
                            cv::Mat& canvas) {
  MakePale(canvas);
  std::vector<ProjectedReturn> returns = ProjectScan(scan, camera, cam_from_lidar);
  const std::vector<bool> hidden = HiddenReturns(returns, SpacingOf(scan, camera));
  ScanOnImage drawn{.returns = static_cast<int>(scan.points.size())};
  std::size_t shown = 0;
  for (std::size_t i = 0; i < returns.size(); ++i) {
    if (!IsWithin(returns[i].pixel, canvas)) continue;
    ++drawn.in_view;
    drawn.hidden += hidden[i] ? 1 : 0;
    if (!hidden[i] || style.all_returns) returns[shown++] = returns[i];
  }
  returns.resize(shown);
  SetColourRange(returns, drawn);
  const double diameter =
      style.point_px > 0.0 ? style.point_px : std::max(3.0, canvas.cols / 320.0);
  Thin(canvas, diameter, returns);
  for (const ProjectedReturn& r : returns) {
    const cv::Vec3b c = ColourOf(ShareOf(r.range_m, drawn));
    cv::circle(canvas, FixedPoint(r.pixel), cvRound(0.5 * diameter * (1 << kFixedPointShift)),
               cv::Scalar(c[0], c[1], c[2]), cv::FILLED, cv::LINE_AA, kFixedPointShift);
  }
  if (shown > 0) DrawScale(drawn, canvas);
  return drawn;
}

void DrawOutline(const std::vector<Eigen::Vector3d>& corners_in_cam, const Camera& camera,
                 const cv::Scalar& colour, cv::Mat& canvas) {
  constexpr int kPieces = 16;
  const int thickness = std::max(2, canvas.cols / 640);
  for (std::size_t k = 0; k < corners_in_cam.size(); ++k) {
    const Eigen::Vector3d& a = corners_in_cam[k];
    const Eigen::Vector3d& b = corners_in_cam[k / 4 * 4 + (k + 1) % 4];
    std::optional<Eigen::Vector2d> last = Project(camera, a);
    for (int i = 1; i <= kPieces; ++i) {
      const double share = static_cast<double>(i) / kPieces;
      const std::optional<Eigen::Vector2d> next = Project(camera, (1.0 - share) * a + share * b);
      if (last && next) {
        cv::line(canvas, FixedPoint(*last), FixedPoint(*next), colour, thickness, cv::LINE_AA,
                 kFixedPointShift);
      }
      last = next;
    }
  }
}

void DrawLabel(const std::string& text, const cv::Point& at, double height_px,
               const cv::Scalar& colour, cv::Mat& canvas) {
  // The font's capitals are 22 pixels high at scale 1.
  const double scale = height_px / 22.0;
  const int thickness = std::max(1, cvRound(1.6 * scale));
  cv::putText(canvas, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, cv::Scalar(0, 0, 0),
              thickness + std::max(2, cvRound(3.0 * scale)), cv::LINE_AA);
  cv::putText(canvas, text, at, cv::FONT_HERSHEY_SIMPLEX, scale, colour, thickness, cv::LINE_AA);
}

}  // namespace sextant
