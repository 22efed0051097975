// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "simulator/camera/render.h"
#include "simulator/scene/scene.h"

namespace sextant::test {

/// A board in front of a camera at the world's origin; under EvenLight() white has 250 grey levels,
/// black 20 and the background 90, all without rounding.
inline sextant::Scene OneBoardScene(const Camera& camera, Board board,
                                    const Rigid3d& cam_from_board) {
  SceneBoard scene_board{.board = std::move(board), .world_from_board = cam_from_board};
  scene_board.white.albedo = 250.0 / 255.0;
  scene_board.black.albedo = 20.0 / 255.0;
  sextant::Scene scene;
  scene.name = "one board";
  scene.cameras = {{.intrinsics = camera}};
  scene.boards = {std::move(scene_board)};
  scene.background_albedo = 90.0 / 255.0;
  return scene;
}

/// Uniform light from all directions.
inline ImageOptions EvenLight() { return {.lighting = {.ambient = 1.0}}; }

}  // namespace sextant::test
