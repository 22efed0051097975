// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <span>

#include "geometry/camera.h"
#include "geometry/rigid3d.h"
#include "solvers/kernels/pixel_terms.h"

namespace sextant {

struct P3pConsensusOptions {
  double max_squared = 9.210340371976184;  ///< Largest r^2 of an inlier [sigma^2].
  double confidence = 0.999;
  int max_samples = 10000;
  int local_rounds = 10;  ///< Rounds of least squares on the inliers of a new best pose; 0: none.
  std::uint64_t seed = 1;
};

struct P3pConsensus {
  Rigid3d cam_from_lidar;
  double cost = 0.0;  ///< sum_i min(r_i^2, max_squared)
  int samples = 0;    ///< Number of triples drawn.
  bool found = false;
};

/// Random sample consensus (Fischler and Bolles 1981) on pixels of a pinhole camera. Draws triples
/// in batches of eight and solves them by SolveP3pBatch. The MSAC cost of a pose (Torr and
/// Zisserman 2000) is summed over eight terms at a time in random order, until it exceeds the best
/// cost or the sequential test of Matas and Chum 2005 rejects the pose. Least squares on the
/// inliers follows where the best pose of a batch is a new best (Lebeda, Matas and Chum 2012). Ends
/// when a triple of inliers has been drawn with `confidence`.
///
/// The result is a minimum of the cost, to a step of 1e-10 rad and m, unless local_rounds is 0. The
/// same seed gives the same bits. Allocates before the search only.
P3pConsensus FindP3pConsensus(PixelTermsView terms, const Camera& camera,
                              const P3pConsensusOptions& options);

}  // namespace sextant
