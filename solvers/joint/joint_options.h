// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "base/options.h"

namespace sextant {

enum class JointLoss { kNone, kHuber, kCauchy };
enum class JointBoardSize { kGiven, kScale, kSides };
enum class JointNoiseLevel { kEstimated, kStated };

/// The options of `joint`.
struct JointOptions {
  JointLoss pixel_loss = JointLoss::kCauchy;
  JointLoss face_loss = JointLoss::kCauchy;
  JointLoss edge_loss = JointLoss::kCauchy;
  double loss_scale = 3.0;
  double cut = 4.0;
  JointNoiseLevel noise = JointNoiseLevel::kEstimated;
  bool range_bias = false;
  JointBoardSize board_size = JointBoardSize::kGiven;
  unsigned intrinsics = 0;  ///< IntrinsicKind bits.
  int max_iterations = 100;
  double step_tolerance = 1e-10;
};

OptionSet<JointOptions> JointOptionSet();

}  // namespace sextant
