// SPDX-License-Identifier: Apache-2.0
#include "io/boards/board_templates.h"

#include <fmt/core.h>

#include <array>

#include "base/nearest_name.h"
#include "io/blocks/grid_targets.h"

namespace sextant {
namespace {

// Four round holes and four tags, whose ids are 1, 2, 4, 3 clockwise from the top left.
Board FourHoles() {
  Board board{.top_right_m = 1.4, .right_bottom_m = 1.0};
  constexpr std::array kIds = {1, 2, 4, 3};
  constexpr std::array kRight = {-1, 1, 1, -1};
  constexpr std::array kDown = {-1, -1, 1, 1};
  for (std::size_t i = 0; i < kIds.size(); ++i) {
    board.round_holes.push_back(
        {.radius_m = 0.12, .center_in_board_m = {0.25 * kRight[i], 0.2 * kDown[i]}});
    board.tags.push_back({.family = "aruco_6x6_250",
                          .id = kIds[i],
                          .edge_m = 0.2,
                          .center_in_board_m = {0.55 * kRight[i], 0.35 * kDown[i]}});
  }
  return board;
}

// Three round holes and four tags, 5 cm from the corners.
Board ThreeHoles() {
  Board board{.top_right_m = 1.2, .right_bottom_m = 0.8};
  const std::array<Eigen::Vector2d, 3> holes = {
      Eigen::Vector2d(-0.15, -0.15), Eigen::Vector2d(0.15, 0.15), Eigen::Vector2d(-0.15, 0.15)};
  for (const Eigen::Vector2d& center : holes) {
    board.round_holes.push_back({.radius_m = 0.12, .center_in_board_m = center});
  }
  const std::array<Eigen::Vector2d, 4> tags = {
      Eigen::Vector2d(-0.46, -0.26), Eigen::Vector2d(0.46, -0.26), Eigen::Vector2d(0.46, 0.26),
      Eigen::Vector2d(-0.46, 0.26)};
  for (int i = 0; i < 4; ++i) {
    board.tags.push_back({.family = "aruco_6x6_250",
                          .id = i + 1,
                          .edge_m = 0.18,
                          .center_in_board_m = tags[static_cast<std::size_t>(i)]});
  }
  return board;
}

// Kalibr's example.
Board SixBySix() {
  const AprilGrid grid{.columns = 6, .rows = 6, .tag_m = 0.088, .spacing = 0.3};
  Board board{.top_right_m = 0.8, .right_bottom_m = 0.8};
  AddTo(grid, board);
  return board;
}

// OpenCV's example, enlarged to A2.
Board FiveBySeven() {
  const CharucoGrid grid{
      .columns = 5, .rows = 7, .square_m = 0.07, .marker_m = 0.05, .family = "aruco_6x6_250"};
  Board board{.top_right_m = 0.42, .right_bottom_m = 0.594};
  AddTo(grid, board);
  return board;
}

struct BoardTemplate {
  const char* name;
  Board (*make)();
};

constexpr std::array kTemplates = {
    BoardTemplate{"fast_calib", FourHoles}, BoardTemplate{"velo2cam", FourHoles},
    BoardTemplate{"multisensor_calibration", ThreeHoles}, BoardTemplate{"aprilgrid", SixBySix},
    BoardTemplate{"charuco", FiveBySeven}};

}  // namespace

const std::vector<std::string>& BoardTemplateNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const BoardTemplate& entry : kTemplates) list.emplace_back(entry.name);
    return list;
  }();
  return names;
}

Expected<Board> FindBoardTemplate(std::string_view name) {
  for (const BoardTemplate& entry : kTemplates) {
    if (name != entry.name) continue;
    Board board = entry.make();
    board.name = entry.name;
    return board;
  }
  return MakeError(ErrorCode::kUnknownName, fmt::format("no board template '{}'; {}", name,
                                                        SuggestName(name, BoardTemplateNames())));
}

}  // namespace sextant
