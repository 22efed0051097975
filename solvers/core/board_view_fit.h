// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "geometry/rigid3d.h"

namespace sextant {

/// The number of observations of one kind, and how many of them the answer is based on.
struct ObservationCount {
  int used = 0;
  int of = 0;
};

/// How well the answer of a solver of raw observations explains one BoardView.
struct BoardViewFit {
  int view = 0;
  int board = 0;
  bool used = false;         ///< False: no information on cam_from_lidar, or contradicts the rest.
  Rigid3d cam_from_board{};  ///< Estimated together with the extrinsic.
  ObservationCount printed{};  ///< Counts whole BoardPoints.
  ObservationCount face{};
  ObservationCount edges{};
  double rms = 0.0;  ///< RMS of the whitened residuals used; 1 where the noise is as stated.
};

}  // namespace sextant
