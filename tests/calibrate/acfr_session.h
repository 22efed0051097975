// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "calibrate/calibrate.h"
#include "io/cameras/camera_file.h"

namespace sextant::test {

/// The board of acfr/cam_lidar_calibration.
inline Board AcfrBoard() {
  Board board{.id = 0, .top_right_m = 0.61, .right_bottom_m = 0.85};
  board.checker = BoardChecker{.inner_columns = 5, .inner_rows = 7, .square_m = 0.095};
  return board;
}

/// The images of the data set and their full scans, with the board described as given.
inline Expected<ObservedSession> ObserveAcfr(const std::filesystem::path& folder,
                                             const Board& board) {
  SEXTANT_ASSIGN_OR_RETURN(const Camera camera, ReadCamera(folder / "camera_info.yaml"));
  const std::vector<std::string> images = {(folder / "images" / "*.png").string()};
  const std::vector<std::string> clouds = {(folder / "full" / "*.pcd").string()};
  SEXTANT_ASSIGN_OR_RETURN(const Session session, SessionOfFiles(images, clouds));
  CalibrateOptions options;
  options.boards = {board};
  options.camera = camera;
  return ObserveSession(session, options);
}

/// With the board as it is, observed once per process.
inline const Expected<ObservedSession>& AcfrSession(const std::filesystem::path& folder) {
  static const Expected<ObservedSession> session = ObserveAcfr(folder, AcfrBoard());
  return session;
}

}  // namespace sextant::test
