// SPDX-License-Identifier: Apache-2.0
#include "report/overlay.h"

#include <fmt/core.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "calibrate/observe/photo_file.h"
#include "report/fixed_point.h"

namespace sextant {
namespace {

constexpr double kMagnification = 10.0;
const cv::Scalar kMeasured(0, 200, 0);
const cv::Scalar kProjected(0, 0, 255);
const cv::Scalar kResidual(0, 220, 255);
const cv::Scalar kLeftOut(160, 160, 160);

struct Mark {
  Eigen::Vector2d measured;
  Eigen::Vector2d projected;
  bool used = true;
};

// The inliers of a report count the pairs of one kind, and only these are drawn.
std::vector<Mark> MarksOf(const CalibrationProblem& problem, const SolveReport& report,
                          const DataNeeds& needs) {
  const Camera& camera = report.camera ? report.camera->camera : *problem.camera;
  const auto used = [&report](std::size_t i) {
    return report.inliers.empty() ||
           std::binary_search(report.inliers.begin(), report.inliers.end(), static_cast<int>(i));
  };
  const bool of_points = needs.pairs_3d3d > 0 || problem.pairs_2d3d.empty();
  std::vector<Mark> marks;
  for (std::size_t i = 0; !of_points && i < problem.pairs_2d3d.size(); ++i) {
    const Pair2d3d& pair = problem.pairs_2d3d[i];
    const auto projected = Project(camera, report.cam_from_lidar * pair.point_in_lidar);
    if (projected) marks.push_back({pair.pixel, *projected, used(i)});
  }
  for (std::size_t i = 0; of_points && i < problem.pairs_3d3d.size(); ++i) {
    const Pair3d3d& pair = problem.pairs_3d3d[i];
    const auto measured = Project(camera, pair.point_in_cam);
    const auto projected = Project(camera, report.cam_from_lidar * pair.point_in_lidar);
    if (measured && projected) marks.push_back({*measured, *projected, used(i)});
  }
  return marks;
}

void DrawMark(const Mark& mark, cv::Mat& canvas) {
  const Eigen::Vector2d tip = mark.measured + kMagnification * (mark.projected - mark.measured);
  cv::line(canvas, FixedPoint(mark.measured), FixedPoint(tip), mark.used ? kResidual : kLeftOut, 2,
           cv::LINE_AA, kFixedPointShift);
  cv::circle(canvas, FixedPoint(mark.measured), 7 << kFixedPointShift,
             mark.used ? kMeasured : kLeftOut, 2, cv::LINE_AA, kFixedPointShift);
  for (const Eigen::Vector2d& arm : {Eigen::Vector2d(5, 5), Eigen::Vector2d(5, -5)}) {
    cv::line(canvas, FixedPoint(mark.projected - arm), FixedPoint(mark.projected + arm),
             mark.used ? kProjected : kLeftOut, 2, cv::LINE_AA, kFixedPointShift);
  }
}

void DrawLegend(const std::string& text, cv::Mat& canvas) {
  int baseline = 0;
  const cv::Size size = cv::getTextSize(text, cv::FONT_HERSHEY_SIMPLEX, 0.6, 1, &baseline);
  cv::rectangle(canvas, {0, 0}, {size.width + 20, size.height + baseline + 12}, {0, 0, 0},
                cv::FILLED);
  cv::putText(canvas, text, {10, size.height + 8}, cv::FONT_HERSHEY_SIMPLEX, 0.6, {255, 255, 255},
              1, cv::LINE_AA);
}

}  // namespace

Expected<void> DrawOverlay(const CalibrationProblem& problem, const SolveReport& report,
                           const DataNeeds& needs, const std::filesystem::path& image,
                           const std::filesystem::path& out) {
  if (!problem.camera) {
    return MakeError(ErrorCode::kMissingData, "an overlay needs the camera: give --camera");
  }
  SEXTANT_ASSIGN_OR_RETURN(const cv::Mat read, ReadColourImage(image));
  cv::Mat canvas = read;
  const Camera& camera = *problem.camera;
  const bool size_known = camera.width_px > 0 && camera.height_px > 0;
  if (size_known && (canvas.cols != camera.width_px || canvas.rows != camera.height_px)) {
    return MakeError(
        ErrorCode::kInvalidInput,
        fmt::format("{}: the image has {} x {} pixels, expected the camera's {} x {}",
                    image.string(), canvas.cols, canvas.rows, camera.width_px, camera.height_px));
  }
  const std::vector<Mark> marks = MarksOf(problem, report, needs);
  if (marks.empty()) {
    return MakeError(ErrorCode::kMissingData, "no pair projects into the image: nothing to draw");
  }
  for (const Mark& mark : marks) DrawMark(mark, canvas);
  double squares = 0.0;
  for (const Mark& mark : marks) squares += (mark.projected - mark.measured).squaredNorm();
  DrawLegend(
      fmt::format("{}: o measured  x LiDAR point, RMSE {:.2f} px, residuals x{:.0f}", report.solver,
                  std::sqrt(squares / static_cast<double>(marks.size())), kMagnification),
      canvas);
  return WriteImage(canvas, out);
}

}  // namespace sextant
