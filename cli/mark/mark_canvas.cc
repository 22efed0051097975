// SPDX-License-Identifier: Apache-2.0
#include "cli/mark/mark_canvas.h"

#include <fmt/core.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>

#include "cli/mark/mark_panels.h"
#include "report/fixed_point.h"

namespace sextant::cli {
namespace {

// One for each edge, from the top-left clockwise; as blue, green, red.
const cv::Scalar kEdgeColors[] = {{120, 220, 90}, {90, 200, 255}, {230, 140, 255}, {255, 190, 100}};
const cv::Scalar kCanvas(30, 26, 24);
const cv::Scalar kDrawing(255, 255, 255);
const cv::Scalar kMarkedCorner(60, 60, 255);
const cv::Scalar kShadow(0, 0, 0);

void Dot(cv::Mat& canvas, const Eigen::Vector2d& at, double radius, const cv::Scalar& color) {
  cv::circle(canvas, FixedPoint(at), cvRound(radius * (1 << kFixedPointShift)), color, cv::FILLED,
             cv::LINE_AA, kFixedPointShift);
}

void Line(cv::Mat& canvas, const Eigen::Vector2d& a, const Eigen::Vector2d& b,
          const cv::Scalar& color, int thickness) {
  cv::line(canvas, FixedPoint(a), FixedPoint(b), color, thickness, cv::LINE_AA, kFixedPointShift);
}

void Label(cv::Mat& canvas, const Eigen::Vector2d& at, const std::string& text,
           const cv::Scalar& color) {
  const cv::Point p(cvRound(std::clamp(at.x(), -1e4, 1e4)), cvRound(std::clamp(at.y(), -1e4, 1e4)));
  cv::putText(canvas, text, p, cv::FONT_HERSHEY_SIMPLEX, 0.5, kShadow, 3, cv::LINE_AA);
  cv::putText(canvas, text, p, cv::FONT_HERSHEY_SIMPLEX, 0.5, color, 1, cv::LINE_AA);
}

bool IsOn(const cv::Mat& canvas, const Eigen::Vector2d& at) {
  return at.x() > -8.0 && at.y() > -8.0 && at.x() < canvas.cols + 8.0 && at.y() < canvas.rows + 8.0;
}

// Dots grow with the scale of the picture, but not so far that they hide each other.
double DotRadius(double scale) { return std::clamp(0.9 + 0.5 * scale, 1.0, 3.5); }

void DrawPhoto(const cv::Mat& photo, const MarkViewport& view, double brightness, cv::Mat& canvas) {
  const double s = view.scale();
  const cv::Matx23d canvas_from_pixel(s, 0.0, view.offset().x(), 0.0, s, view.offset().y());
  const int filter = s > 4.0 ? cv::INTER_NEAREST : cv::INTER_LINEAR;
  cv::Mat shown = canvas.clone();
  cv::warpAffine(photo, shown, canvas_from_pixel, canvas.size(), filter, cv::BORDER_TRANSPARENT);
  cv::addWeighted(shown, brightness, canvas, 1.0 - brightness, 0.0, canvas);
}

void DrawScan(const std::vector<ProjectedReturn>& returns, const MarkViewport& view,
              cv::Mat& canvas) {
  const RangeColors colors(returns);
  const double radius = DotRadius(view.scale());
  for (const ProjectedReturn& r : returns) {
    const Eigen::Vector2d at = view.ToCanvas(r.pixel);
    if (IsOn(canvas, at)) Dot(canvas, at, radius, colors.Of(r.range_m));
  }
}

void DrawQuadrilateral(const Quadrilateral& quadrilateral, const MarkViewport& view,
                       const cv::Scalar& color, cv::Mat& canvas) {
  std::vector<cv::Point> corners;
  for (const Eigen::Vector2d& pixel : quadrilateral)
    corners.push_back(FixedPoint(view.ToCanvas(pixel)));
  cv::Mat filled = canvas.clone();
  cv::fillPoly(filled, std::vector<std::vector<cv::Point>>{corners}, color, cv::LINE_AA,
               kFixedPointShift);
  cv::addWeighted(filled, 0.22, canvas, 0.78, 0.0, canvas);
  cv::polylines(canvas, corners, true, color, 1, cv::LINE_AA, kFixedPointShift);
}

// The returns inside an area, with a white rim. The rims are drawn first, because neighbours touch.
void DrawReturnsIn(const Quadrilateral& area, const MarkSession& session, const MarkViewport& view,
                   cv::Mat& canvas) {
  std::vector<ProjectedReturn> inside;
  for (const ProjectedReturn& r : session.returns()) {
    if (IsOn(canvas, view.ToCanvas(r.pixel)) && Contains(area, r.pixel)) inside.push_back(r);
  }
  const RangeColors colors(session.returns());
  const double radius = DotRadius(view.scale());
  for (const ProjectedReturn& r : inside) {
    Dot(canvas, view.ToCanvas(r.pixel), radius + 1.5, kDrawing);
  }
  for (const ProjectedReturn& r : inside) {
    Dot(canvas, view.ToCanvas(r.pixel), radius, colors.Of(r.range_m));
  }
}

void DrawBoards(const MarkSession& session, const MarkViewport& view, cv::Mat& canvas) {
  for (const MarkedBoard& board : session.marks().boards) {
    for (std::size_t i = 0; i < board.edges.size(); ++i) {
      DrawQuadrilateral(board.edges[i], view, kEdgeColors[i], canvas);
    }
    for (const Quadrilateral& edge : board.edges) DrawReturnsIn(edge, session, view, canvas);
    for (std::size_t i = 0; i < board.edges.size(); ++i) {
      Label(canvas, view.ToCanvas(CenterOf(board.edges[i])) - Eigen::Vector2d(12, -5),
            fmt::format("{}.{}", board.id, i + 1), kDrawing);
    }
  }
}

void DrawUnfinished(const MarkController& controller, cv::Mat& canvas) {
  const MarkViewport& view = controller.viewport();
  std::vector<Eigen::Vector2d> drawn;
  for (const Eigen::Vector2d& pixel : controller.session().marks().unfinished) {
    drawn.push_back(view.ToCanvas(pixel));
  }
  for (std::size_t i = 0; i + 1 < drawn.size(); ++i) {
    Line(canvas, drawn[i], drawn[i + 1], kDrawing, 1);
  }
  if (!drawn.empty() && controller.cursor()) {
    Line(canvas, drawn.back(), *controller.cursor(), kDrawing, 1);
    if (drawn.size() == 3) Line(canvas, *controller.cursor(), drawn.front(), kDrawing, 1);
  }
  for (const Eigen::Vector2d& at : drawn) Dot(canvas, at, 3.5, kDrawing);
}

void DrawCorners(const MarkSession& session, const MarkViewport& view, cv::Mat& canvas) {
  for (const ClickedCorner& corner : session.marks().corners) {
    const Eigen::Vector2d at = view.ToCanvas(corner.pixel);
    for (const auto& [color, thickness] : {std::pair(kShadow, 3), std::pair(kMarkedCorner, 1)}) {
      for (const Eigen::Vector2d& arm : {Eigen::Vector2d(9, 0), Eigen::Vector2d(0, 9)}) {
        Line(canvas, at - arm, at - 0.25 * arm, color, thickness);
        Line(canvas, at + 0.25 * arm, at + arm, color, thickness);
      }
    }
    Label(canvas, at + Eigen::Vector2d(8, -8), fmt::format("{}:{}", corner.board, corner.corner),
          kDrawing);
  }
}

// Thin lines through the pointer, to place it to a pixel.
void DrawCrosshair(const MarkController& controller, cv::Mat& canvas) {
  if (!controller.cursor()) return;
  const Eigen::Vector2d& at = *controller.cursor();
  const cv::Scalar color(110, 110, 110);
  Line(canvas, {0.0, at.y()}, {at.x() - 14.0, at.y()}, color, 1);
  Line(canvas, {at.x() + 14.0, at.y()}, {canvas.cols - 1.0, at.y()}, color, 1);
  Line(canvas, {at.x(), 0.0}, {at.x(), at.y() - 14.0}, color, 1);
  Line(canvas, {at.x(), at.y() + 14.0}, {at.x(), canvas.rows - 1.0}, color, 1);
}

}  // namespace

void MarkCanvas::DrawBase(const MarkController& controller) {
  const MarkViewport& view = controller.viewport();
  const Eigen::Vector3d now(view.scale(), view.offset().x(), view.offset().y());
  if (!base_.empty() && now == base_view_ && controller.layers() == base_layers_) return;
  base_view_ = now;
  base_layers_ = controller.layers();
  base_ =
      cv::Mat(cvRound(view.canvas_size().y()), cvRound(view.canvas_size().x()), CV_8UC3, kCanvas);
  const bool with_scan = base_layers_ != MarkLayers::kPhoto;
  if (!photo_.empty() && base_layers_ != MarkLayers::kScan) {
    DrawPhoto(photo_, view, with_scan ? 0.55 : 1.0, base_);
  }
  if (with_scan) DrawScan(controller.session().returns(), view, base_);
}

cv::Mat MarkCanvas::Draw(const MarkController& controller) {
  DrawBase(controller);
  cv::Mat canvas = base_.clone();
  const MarkViewport& view = controller.viewport();
  if (base_layers_ != MarkLayers::kPhoto) DrawBoards(controller.session(), view, canvas);
  DrawCorners(controller.session(), view, canvas);
  DrawCrosshair(controller, canvas);
  DrawUnfinished(controller, canvas);
  DrawMarkPanels(controller, !photo_.empty(), kMarkBar_px, canvas);
  return canvas;
}

}  // namespace sextant::cli
