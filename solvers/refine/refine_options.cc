// SPDX-License-Identifier: Apache-2.0
#include "solvers/refine/refine_options.h"

#include <fmt/core.h>

#include "solvers/core/inner_solver.h"
#include "solvers/kernels/pair_terms.h"

namespace sextant {
namespace {

Expected<RefineOn> ResolveOn(const SolverArguments& arguments, RefineOn on) {
  if (on != RefineOn::kAuto) return on;
  const DataNeeds& needs = arguments.inner->spec().needs;
  if (needs.pairs_3d3d > 0 && needs.pairs_2d3d > 0) return RefineOn::kBoth;
  if (needs.pairs_3d3d > 0) return RefineOn::k3d3d;
  if (needs.pairs_2d3d > 0) return RefineOn::k2d3d;
  return MakeError(ErrorCode::kInvalidOption,
                   fmt::format("refine: '{}' works on point sets; state on which pairs to refine: "
                               "on=3d3d, on=2d3d or on=both",
                               arguments.inner->spec().name));
}

}  // namespace

RobustLoss RefineOptions::Loss() const {
  // Above most residuals of inliers, whose root mean square is sqrt(3) or sqrt(2).
  constexpr double kScales[] = {2.0, 2.0, 3.0, 6.0, 3.0};
  const double scale = loss_scale > 0.0 ? loss_scale : kScales[static_cast<std::size_t>(loss)];
  return {loss, scale, loss_shape};
}

OptionSet<RefineOptions> RefineOptionSet() {
  OptionSet<RefineOptions> options;
  options
      .Choice("on", &RefineOptions::on, {"auto", "3d3d", "2d3d", "both"},
              "the residuals; auto: those of the inner solver")
      .Choice("loss", &RefineOptions::loss, {"none", "huber", "cauchy", "tukey", "barron"},
              "robust loss on each pair")
      .Real("loss_scale", &RefineOptions::loss_scale, "sigma", 0.0, 1e6,
            "transition point of the loss; 0: huber 2, cauchy 3, tukey 6, barron 3")
      .Real("loss_shape", &RefineOptions::loss_shape, "1", -100.0, 2.0,
            "for barron: 2 squares, 1 Charbonnier, 0 Cauchy, -2 Geman-McClure")
      .Set("intrinsics", &RefineOptions::intrinsics, {"focal", "center", "distortion"},
           "estimated along with the pose, which then accounts for them; needs pixels")
      .Count("max_iterations", &RefineOptions::max_iterations, 1, 1'000'000,
             "limit; reaching it is the error kNoConvergence")
      .Real("step_tolerance", &RefineOptions::step_tolerance, "rad and m", 1e-15, 1.0,
            "the iteration ends with a step smaller than this")
      .Real("sigma_m", &RefineOptions::sigma_m, "m", 0.0, 1e6,
            "noise of pairs that state none; 0: estimated from the residuals")
      .Real("sigma_px", &RefineOptions::sigma_px, "px", 0.0, 1e6,
            "noise of pairs that state none; 0: estimated from the residuals");
  return options;
}

Expected<RefineOptions> ParseRefineOptions(const SolverArguments& arguments) {
  Expected<RefineOptions> options = RefineOptionSet().Parse(arguments.options);
  if (!options) return options;
  SEXTANT_ASSIGN_OR_RETURN(const RefineOn on, ResolveOn(arguments, options->on));
  options->on = on;
  SEXTANT_RETURN_IF_ERROR(CheckKeepsCamera(*arguments.inner, "refine"));
  if (options->intrinsics != 0U && !Uses2d3d(on)) {
    return MakeError(ErrorCode::kInvalidOption,
                     "refine: intrinsics needs pixels to refine on: on=2d3d or on=both");
  }
  return options;
}

}  // namespace sextant
