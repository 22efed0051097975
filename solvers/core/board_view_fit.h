// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/rigid3d.h"

namespace sextant {

/// How many observations of a kind the answer rests on, of how many that there were.
struct ObservationCount {
  int used = 0;
  int of = 0;
};

/// How the answer of a solver that works on raw observations explains one BoardView.
struct BoardViewFit {
  int view = 0;
  int board = 0;
  bool used = false;  ///< False: it tells nothing of cam_from_lidar, or contradicts the rest.
  Rigid3d cam_from_board{};    ///< As estimated along with the extrinsic.
  ObservationCount printed{};  ///< BoardPoints, each as a whole.
  ObservationCount face{};
  ObservationCount edges{};
  double rms = 0.0;  ///< Of the whitened residuals that were used; 1 where the noise is as stated.
};

}  // namespace sextant
