// SPDX-License-Identifier: Apache-2.0
#include "report/collect/page_views.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "base/units.h"
#include "geometry/board_check.h"
#include "report/collect/utc_text.h"
#include "report/collect/view_media.h"
#include "solvers/core/board_view_check.h"

namespace sextant {
namespace {

std::vector<Eigen::Vector3d> OuterCorners(const Board& board, const Rigid3d& b_from_board) {
  std::vector<Eigen::Vector3d> corners;
  for (const Eigen::Vector2d& corner : CornersInBoard(board)) {
    if (corners.size() == kCornersPerBoard) break;
    corners.emplace_back(b_from_board * Eigen::Vector3d(corner.x(), corner.y(), 0.0));
  }
  return corners;
}

std::string NameOf(const Board& board) {
  return board.name.empty() ? fmt::format("{}", board.id)
                            : fmt::format("{} ({})", board.id, board.name);
}

void AddByCamera(const CalibrationResult& result, const Board& board, const Rigid3d& cam_from_board,
                 PageBoard& page) {
  page.range_m = cam_from_board.translation.norm();
  page.by_camera = OuterCorners(board, result.cam_from_lidar.Inverse() * cam_from_board);
  if (result.camera) page.camera_in_px = OutlineInImage(*result.camera, board, cam_from_board);
}

void AddByLidar(const CalibrationResult& result, const Board& board,
                const Rigid3d& lidar_from_board, PageBoard& page) {
  page.by_lidar = OuterCorners(board, lidar_from_board);
  if (result.camera) {
    page.lidar_in_px =
        OutlineInImage(*result.camera, board, result.cam_from_lidar * lidar_from_board);
  }
}

PageBoard BoardOf(const CalibrationResult& result, const ResultBoardView& seen) {
  PageBoard page{.name = fmt::format("{}", seen.board),
                 .residuals_m = seen.residuals_m,
                 .residuals_px = seen.residuals_px};
  const Board* board = FindBoard(result.boards, seen.board);
  if (board == nullptr) return page;
  page.name = NameOf(*board);
  if (seen.cam_from_board) AddByCamera(result, *board, *seen.cam_from_board, page);
  if (seen.lidar_from_board) AddByLidar(result, *board, *seen.lidar_from_board, page);
  return page;
}

// What each sensor saw in a view that was left out, each sighting on its own.
std::vector<PageBoard> SightingsOf(const CalibrationResult& result, const Observation& seen) {
  std::vector<PageBoard> pages;
  for (const CameraSighting& sighting : seen.in_image) {
    const Board& board = result.boards[static_cast<std::size_t>(sighting.board)];
    AddByCamera(result, board, sighting.pose.cam_from_board, pages.emplace_back());
    pages.back().name = NameOf(board);
  }
  for (const LidarSighting& sighting : seen.in_scan) {
    const BoardPlacement& placed = sighting.placements.front();
    const Board& board = result.boards[static_cast<std::size_t>(placed.board)];
    AddByLidar(result, board, placed.lidar_from_board, pages.emplace_back());
    pages.back().name = NameOf(board);
  }
  return pages;
}

// Requires a result of this calibration, whose views and boards are its own.
void AddFromCalibration(const CalibrationResult& result, const Calibration& calibration,
                        std::vector<PageView>& pages) {
  const std::vector<SessionView>& views = calibration.observed.views;
  for (std::size_t i = 0; i < pages.size() && i < views.size(); ++i) {
    if (pages[i].boards.empty() && views[i].seen) {
      pages[i].boards = SightingsOf(result, *views[i].seen);
    }
  }
  for (const BoardRow& row : calibration.assembly.rows) {
    if (row.why.empty() || row.board < 0 || row.view >= pages.size()) continue;
    PageView& page = pages[row.view];
    if (!page.is_kept) continue;  // Its reason is that of all its boards.
    const Board& board = result.boards[static_cast<std::size_t>(row.board)];
    page.reason += fmt::format("{}board {} {}: {}", page.reason.empty() ? "" : "; ", board.id,
                               ToString(row.fate), row.why);
  }
}

PageView ViewWithoutMedia(const CalibrationResult& result, const ResultView& view) {
  PageView page{.name = view.name.empty() ? fmt::format("{}", view.view) : view.name,
                .is_kept = view.kept,
                .reason = view.reason,
                .time = view.image_time_s ? UtcText(*view.image_time_s) : std::string(),
                .rmse_m = view.rmse_m,
                .rmse_px = view.rmse_px,
                .held_out_m = view.held_out_m,
                .sigma_so_far = view.sigma_so_far};
  for (const ResultBoardView& seen : view.boards) page.boards.push_back(BoardOf(result, seen));
  return page;
}

void AddMedia(const CalibrationResult& result, const Frame& frame, const MediaBudget& budget,
              PageView& page) {
  const cv::Mat image = AsColour(frame.image);
  // A camera whose file has no image size has that of the image.
  Camera camera = *result.camera;
  if (camera.width_px == 0) camera.width_px = image.cols;
  if (camera.height_px == 0) camera.height_px = image.rows;
  MediaSource source{.image = image,
                     .cloud = frame.cloud,
                     .camera = camera,
                     .cam_from_lidar = result.cam_from_lidar};
  for (const PageBoard& board : page.boards) {
    const std::vector<Eigen::Vector3d>& corners =
        board.by_lidar.empty() ? board.by_camera : board.by_lidar;
    if (corners.size() != kCornersPerBoard) continue;
    const Eigen::Vector3d center = 0.5 * (corners[0] + corners[2]);
    source.boards.push_back({center, 1.2 * (corners[0] - center).norm()});
  }
  page.photo = MakePhoto(source, budget);
  page.scan = MakeScan(source, budget);
  if (!page.photo) page.no_photo = "The photo cannot be shown.";
}

// Pixels of the image's outline, clockwise from the top left, as many on each side.
std::vector<Eigen::Vector2d> BorderOf(const Camera& camera) {
  constexpr int kPerSide = 8;
  const Eigen::Vector2d size(camera.width_px - 1.0, camera.height_px - 1.0);
  const std::array<Eigen::Vector2d, 4> corners = {Eigen::Vector2d::Zero(),
                                                  Eigen::Vector2d(size.x(), 0.0), size,
                                                  Eigen::Vector2d(0.0, size.y())};
  std::vector<Eigen::Vector2d> border;
  for (std::size_t side = 0; side < 4; ++side) {
    for (int k = 0; k < kPerSide; ++k) {
      const double share = static_cast<double>(k) / kPerSide;
      border.emplace_back((1.0 - share) * corners[side] + share * corners[(side + 1) % 4]);
    }
  }
  return border;
}

PageTable FactsOf(const Camera& camera) {
  static constexpr std::array<const char*, 5> kModels = {
      "pinhole", "Brown-Conrady", "equidistant (fisheye)", "omnidirectional", "double sphere"};
  const auto model = static_cast<std::size_t>(camera.model);
  return {
      .rows = {{"model", model < kModels.size() ? kModels[model] : "other"},
               {"image", camera.width_px > 0
                             ? fmt::format("{} x {} px", camera.width_px, camera.height_px)
                             : std::string("size not stated")},
               {"focal lengths", fmt::format("{:.1f}, {:.1f} px", camera.fx_px, camera.fy_px)},
               {"principal point", fmt::format("{:.1f}, {:.1f} px", camera.cx_px, camera.cy_px)}},
      .words = 2};
}

PageTable FactsOf(const LidarPattern& lidar) {
  PageTable facts{.words = 2};
  if (!lidar.elevations_rad.empty()) {
    facts.rows.push_back(
        {"rings", fmt::format("{}, elevations {:.1f} to {:.1f} deg", lidar.elevations_rad.size(),
                              kDegPerRad * lidar.elevations_rad.front(),
                              kDegPerRad * lidar.elevations_rad.back())});
  }
  facts.rows.push_back(
      {"azimuth step", fmt::format("{:.3f} deg", kDegPerRad * lidar.azimuth_step_rad)});
  facts.rows.push_back({"noise of a range", fmt::format("{:.1f} mm", 1e3 * lidar.range_sigma_m)});
  facts.note = "Estimated from the scans.";
  return facts;
}

}  // namespace

std::vector<Eigen::Vector2d> OutlineInImage(const Camera& camera, const Board& board,
                                            const Rigid3d& cam_from_board) {
  constexpr int kPieces = 8;
  constexpr double kFar_px = 1e5;
  const std::vector<Eigen::Vector3d> corners = OuterCorners(board, cam_from_board);
  std::vector<Eigen::Vector2d> outline;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d& next = corners[(i + 1) % corners.size()];
    for (int k = 0; k < kPieces; ++k) {
      const double share = static_cast<double>(k) / kPieces;
      const auto pixel = Project(camera, (1.0 - share) * corners[i] + share * next);
      if (!pixel || pixel->cwiseAbs().maxCoeff() > kFar_px) return {};
      outline.push_back(*pixel);
    }
  }
  return outline;
}

PageSensor PageCameraOf(const std::string& name, const Camera& camera) {
  PageSensor page{.name = name, .is_camera = true, .facts = FactsOf(camera)};
  for (const Eigen::Vector2d& pixel : BorderOf(camera)) {
    if (const auto ray = Unproject(camera, pixel)) page.frustum.push_back(0.5 * *ray);
  }
  return page;
}

std::vector<PageSensor> PageSensorsOf(const CalibrationResult& result) {
  PageSensor camera{.name = result.camera_frame, .is_camera = true};
  if (result.camera) camera = PageCameraOf(result.camera_frame, *result.camera);
  camera.base_from_sensor = result.cam_from_lidar.Inverse();
  PageSensor lidar{.name = result.lidar_frame, .base_from_sensor = Rigid3d{}};
  if (result.lidar) lidar.facts = FactsOf(*result.lidar);
  return {std::move(lidar), std::move(camera)};
}

std::vector<PageView> PageViewsOf(const CalibrationResult& result, const Calibration* calibration,
                                  const FrameSource& frames) {
  const MediaBudget budget = BudgetFor(result.views.size());
  std::vector<PageView> pages(result.views.size());
  for (std::size_t i = 0; i < pages.size(); ++i) {
    pages[i] = ViewWithoutMedia(result, result.views[i]);
    pages[i].no_photo = "There is no photo and no scan of this view.";
  }
  if (calibration != nullptr) AddFromCalibration(result, *calibration, pages);
  if (!result.camera || !frames) return pages;
  const Expected<void> ok = frames(result.views, [&](std::size_t i, const Expected<Frame>& frame) {
    if (i >= pages.size()) return;
    pages[i].no_photo = frame ? "" : frame.error().message;
    if (frame) AddMedia(result, *frame, budget, pages[i]);
  });
  if (ok) return pages;
  for (PageView& page : pages) {
    if (!page.photo && !page.scan) page.no_photo = ok.error().message;
  }
  return pages;
}

}  // namespace sextant
