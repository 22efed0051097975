// SPDX-License-Identifier: Apache-2.0
#include "report/collect/page_plots.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/units.h"
#include "geometry/board_check.h"
#include "report/collect/page_views.h"
#include "solvers/core/board_view_check.h"

namespace sextant {
namespace {

// A board of a kept view, as the camera saw it.
struct KeptBoard {
  const ResultView* view;
  const ResultBoardView* seen;
  const Board* board;
  double range_m;
  double angle_deg;  // Between its normal and the line of sight: 0 if it faces the camera.
};

std::vector<KeptBoard> KeptBoards(const CalibrationResult& result) {
  std::vector<KeptBoard> boards;
  for (const ResultView& view : result.views) {
    if (!view.kept) continue;
    for (const ResultBoardView& seen : view.boards) {
      const Board* board = FindBoard(result.boards, seen.board);
      if (board == nullptr || !seen.cam_from_board) continue;
      const Eigen::Vector3d& place = seen.cam_from_board->translation;
      const Eigen::Vector3d normal = seen.cam_from_board->rotation * Eigen::Vector3d::UnitZ();
      const double along = std::abs(normal.dot(place.normalized()));
      boards.push_back(
          {&view, &seen, board, place.norm(), kDegPerRad * std::acos(std::clamp(along, 0.0, 1.0))});
    }
  }
  return boards;
}

// Whether a point is inside a closed outline, by the crossings of a ray.
bool Holds(const std::vector<Eigen::Vector2d>& outline, const Eigen::Vector2d& at) {
  bool is_inside = false;
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Eigen::Vector2d& a = outline[i];
    const Eigen::Vector2d& b = outline[(i + 1) % outline.size()];
    if ((a.y() > at.y()) == (b.y() > at.y())) continue;
    const double x = a.x() + (at.y() - a.y()) / (b.y() - a.y()) * (b.x() - a.x());
    if (at.x() < x) is_inside = !is_inside;
  }
  return is_inside;
}

// The share of square cells, an eighth of the image wide, of which an outline holds one of 4 x 4
// places.
double CoveredShare(const PageCoverage& coverage) {
  constexpr int kColumns = 8;
  const double cell = static_cast<double>(coverage.width_px) / kColumns;
  const int rows = std::max(1, static_cast<int>(std::ceil(coverage.height_px / cell)));
  int covered = 0;
  for (int i = 0; i < kColumns * rows; ++i) {
    bool is_covered = false;
    for (int k = 0; k < 16 && !is_covered; ++k) {
      const Eigen::Vector2d at(cell * (i % kColumns + (k % 4 + 0.5) / 4.0),
                               cell * (i / kColumns + (k / 4 + 0.5) / 4.0));
      is_covered = std::any_of(coverage.outlines.begin(), coverage.outlines.end(),
                               [&](const auto& outline) { return Holds(outline, at); });
    }
    covered += is_covered ? 1 : 0;
  }
  return static_cast<double>(covered) / (kColumns * rows);
}

// One point for each corner: `x` of it against its residual in mm; two series where some views
// disagree with the others.
template <class X>
std::vector<PageSeries> ResidualSeries(const CalibrationResult& result, X x) {
  const std::vector<int> listed = result.trust ? result.trust->outlier_views : std::vector<int>{};
  const std::set<int> outliers(listed.begin(), listed.end());
  std::vector<PageSeries> series = {{.name = "views that agree"},
                                    {.name = "views that disagree with the others"}};
  for (const KeptBoard& seen : KeptBoards(result)) {
    PageSeries& into = series[outliers.count(seen.view->view)];
    for (std::size_t i = 0; i < seen.seen->residuals_m.size(); ++i) {
      into.points.emplace_back(x(seen, i), 1e3 * seen.seen->residuals_m[i]);
    }
  }
  if (series[1].points.empty()) series.pop_back();
  return series;
}

double RadiusOf(const Camera& camera, const KeptBoard& seen, std::size_t corner) {
  const std::vector<Eigen::Vector2d> corners = CornersInBoard(*seen.board);
  if (corner >= corners.size()) return NAN;
  const Eigen::Vector3d on_board(corners[corner].x(), corners[corner].y(), 0.0);
  const auto pixel = Project(camera, *seen.seen->cam_from_board * on_board);
  return pixel ? (*pixel - Eigen::Vector2d(camera.cx_px, camera.cy_px)).norm() : NAN;
}

}  // namespace

std::vector<PageCoverage> CoverageOf(const CalibrationResult& result) {
  if (!result.camera || result.camera->width_px <= 0 || result.camera->height_px <= 0) return {};
  PageCoverage coverage{.camera = result.camera_frame,
                        .width_px = result.camera->width_px,
                        .height_px = result.camera->height_px};
  for (const KeptBoard& seen : KeptBoards(result)) {
    const auto outline = OutlineInImage(*result.camera, *seen.board, *seen.seen->cam_from_board);
    if (!outline.empty()) coverage.outlines.push_back(outline);
  }
  coverage.share = CoveredShare(coverage);
  return {coverage};
}

std::vector<PagePlot> CoveragePlots(const CalibrationResult& result) {
  PageSeries places{.name = "boards"};
  for (const KeptBoard& seen : KeptBoards(result)) {
    places.points.emplace_back(seen.range_m, seen.angle_deg);
  }
  return {{.title = "Ranges and tilts of the boards",
           .x_label = "range from the camera [m]",
           .y_label = "angle to the line of sight [deg]",
           .series = {places},
           .note = "Boards both near and far, and tilted by 20 to 50 degrees both ways, determine "
                   "the translation along the line of sight and the rotation about it."}};
}

std::vector<PagePlot> ResidualPlots(const CalibrationResult& result) {
  const char* y = "corner off [mm]";
  std::vector<PagePlot> plots = {
      {.title = "Against range",
       .x_label = "range from the camera [m]",
       .y_label = y,
       .series =
           ResidualSeries(result, [](const KeptBoard& seen, std::size_t) { return seen.range_m; }),
       .note = "A rise with the range is a wrong size of the board, or a wrong focal length."},
      {.title = "Against angle",
       .x_label = "angle to the line of sight [deg]",
       .y_label = y,
       .series = ResidualSeries(result,
                                [](const KeptBoard& seen, std::size_t) { return seen.angle_deg; }),
       .note = "A rise with the angle is a board that is not flat, or edges that the beam blurs."}};
  if (!result.camera) return plots;
  plots.push_back(
      {.title = "Against the distance from the principal point",
       .x_label = "distance in the image [px]",
       .y_label = y,
       .series = ResidualSeries(result,
                                [&](const KeptBoard& seen, std::size_t corner) {
                                  return RadiusOf(*result.camera, seen, corner);
                                }),
       .note = "A rise towards the edge of the image is a distortion that the camera file does not "
               "describe."});
  return plots;
}

std::vector<PagePlot> SigmaPlots(const CalibrationResult& result) {
  std::vector<PageSeries> turn = {{.name = "about right (x)", .is_line = true},
                                  {.name = "about down (y)", .is_line = true},
                                  {.name = "about forward (z)", .is_line = true}};
  std::vector<PageSeries> shift = {{.name = "right (x)", .is_line = true},
                                   {.name = "down (y)", .is_line = true},
                                   {.name = "forward (z)", .is_line = true}};
  double count = 0.0;
  for (const ResultView& view : result.views) {
    if (!view.kept) continue;
    count += 1.0;
    if (!view.sigma_so_far) continue;
    for (Eigen::Index k = 0; k < 3; ++k) {
      const auto i = static_cast<std::size_t>(k);
      turn[i].points.emplace_back(count, kDegPerRad * (*view.sigma_so_far)(k));
      shift[i].points.emplace_back(count, 1e3 * (*view.sigma_so_far)(k + 3));
    }
  }
  const char* x = "number of views";
  return {{.title = "Translation after each view",
           .x_label = x,
           .y_label = "1 sigma [mm]",
           .series = shift,
           .is_log_y = true,
           .note = "In the axes of the camera. A line that has become flat gains little from more "
                   "views of the same kind."},
          {.title = "Rotation after each view",
           .x_label = x,
           .y_label = "1 sigma [deg]",
           .series = turn,
           .is_log_y = true,
           .note = "In the axes of the camera."}};
}

}  // namespace sextant
