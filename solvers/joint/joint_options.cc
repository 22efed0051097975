// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/joint_options.h"

namespace sextant {

OptionSet<JointOptions> JointOptionSet() {
  const std::vector<std::string> losses = {"none", "huber", "cauchy"};
  OptionSet<JointOptions> options;
  options
      .Choice("pixel_loss", &JointOptions::pixel_loss, losses,
              "robust loss before the cut, on each tag or checkerboard as a whole")
      .Choice("face_loss", &JointOptions::face_loss, losses, "on each return from a board's face")
      .Choice("edge_loss", &JointOptions::edge_loss, losses, "on each ray past a board's edge")
      .Real("loss_scale", &JointOptions::loss_scale, "sigma", 1e-3, 1e6,
            "transition point of the losses")
      .Real("cut", &JointOptions::cut, "sigma", 0.0, 1e6,
            "the answer is least squares of the residuals within; 0: the minimum of the losses")
      .Choice("noise", &JointOptions::noise, {"estimated", "stated"},
              "of each kind of observation: estimated from the residuals, or as the views state it")
      .Choice("range_bias", &JointOptions::range_bias, {"false", "true"},
              "the constant that the LiDAR adds to every range may be as large as 0.1 m")
      .Choice("board_size", &JointOptions::board_size, {"given", "scale", "sides"},
              "also estimates the outlines: one scale of all boards, or both sides of each")
      .Set("intrinsics", &JointOptions::intrinsics, {"focal", "center", "distortion"},
           "estimated along with the poses")
      .Count("max_iterations", &JointOptions::max_iterations, 1, 1'000'000,
             "limit in each of a few rounds; reaching it is the error kNoConvergence")
      .Real("step_tolerance", &JointOptions::step_tolerance, "rad and m", 1e-15, 1.0,
            "the iteration ends with steps smaller than this");
  return options;
}

}  // namespace sextant
