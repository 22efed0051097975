// SPDX-License-Identifier: Apache-2.0
#include "cli/calibrate_arguments.h"

#include <utility>

#include "base/units.h"
#include "cli/need_option.h"
#include "cli/pose_argument.h"
#include "solvers/all/all_solvers.h"

namespace sextant::cli {
namespace {

Expected<std::vector<SolverPtr>> SolversFrom(const std::string& list) {
  std::vector<SolverPtr> solvers;
  if (list.empty()) return solvers;
  SEXTANT_ASSIGN_OR_RETURN(const std::vector<SpecNode> specs, ParseSpecList(list));
  const SolverRegistry registry = AllSolvers(Commands::kAllowed);
  for (const SpecNode& spec : specs) {
    SEXTANT_ASSIGN_OR_RETURN(SolverPtr solver, registry.Make(spec));
    solvers.push_back(std::move(solver));
  }
  return solvers;
}

}  // namespace

void DeclareCalibrate(CalibrateArguments& how, Arguments& arguments) {
  arguments.Add("--solver", how.solvers,
                "Solvers, separated by commas: the answer of the first is written, the others are\n"
                "compared with it; see sextant list solvers");
  arguments.Add("--initial", how.initial,
                "Rough cam_from_lidar, used only to choose if the views allow several: a file of\n"
                "any form of sextant check, or X Y Z QW QX QY QZ; default: a camera that looks\n"
                "along the LiDAR's x",
                {.min_values = 1, .max_values = 7});
  DeclarePoseIs(how.pose_is, arguments, "--initial");
  arguments.Add("--detector", how.detector, "See sextant detect");
  arguments.Add("--extractor", how.extractor, "See sextant boards", {.shows_default = true});
  DeclareSearch(how.search, arguments);
  DeclareNeed(how.need, arguments);
  arguments.Add("--bootstrap", how.bootstrap,
                "Bootstrap samples over the views; 0: neither bootstrap nor cross-validation",
                {.shows_default = true, .range = {{0, 100'000}}});
}

Expected<CalibrateOptions> CalibrateOptionsFrom(const CalibrateArguments& how) {
  CalibrateOptions settings{
      .observe = {.detector = how.detector, .extractor = how.extractor},
      .bootstrap_samples = how.bootstrap,
      .need = {.translation_m = 1e-3 * how.need[0], .rotation_rad = kRadPerDeg * how.need[1]},
      .search_description = ConfigurationOf(how.search)};
  SEXTANT_ASSIGN_OR_RETURN(settings.solvers, SolversFrom(how.solvers));
  if (!how.initial.empty()) {
    SEXTANT_ASSIGN_OR_RETURN(settings.match.initial,
                             PoseFromArgument("--initial", how.initial, how.pose_is));
  }
  SEXTANT_ASSIGN_OR_RETURN(settings.observe.search, SearchOptionsFrom(how.search));
  return settings;
}

}  // namespace sextant::cli
