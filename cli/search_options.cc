// SPDX-License-Identifier: Apache-2.0
#include "cli/search_options.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace sextant::cli {
namespace {

Expected<LidarBeam> BeamOf(const SearchArguments& arguments) {
  Expected<LidarBeam> beam = FindLidarBeam(arguments.lidar);
  if (!beam) return beam;
  if (arguments.aperture_m) beam->aperture_h_m = beam->aperture_v_m = *arguments.aperture_m;
  if (arguments.divergence_rad) {
    beam->divergence_h_rad = beam->divergence_v_rad = *arguments.divergence_rad;
  }
  if (arguments.growth) beam->growth = *arguments.growth;
  return beam;
}

}  // namespace

void DeclareSearch(SearchArguments& search, Arguments& arguments) {
  arguments.Add("--region", search.region, "Search only in x y z x y z [m], LiDAR frame",
                {.range = {{-1e6, 1e6}}, .min_values = 6});
  arguments.Add("--raw-edges", search.raw_edges,
                "Put edges at the last return, uncorrected for sample steps and beam width");
  arguments.Add("--lidar", search.lidar,
                "Sensor, for the width of its beam: vlp16, os1_64, ... of sextant list lidars;\n"
                "--beam-aperture, --beam-divergence and --edge-growth each replace its value",
                {.shows_default = true});
  arguments.Add("--beam-aperture", search.aperture_m,
                "Width of the beam at the sensor, instead of that of --lidar [m]",
                {.range = {{0.0, 1.0}}});
  arguments.Add("--beam-divergence", search.divergence_rad,
                "Full divergence angle, instead of that of --lidar [rad]", {.range = {{0.0, 1.0}}});
  arguments.Add("--edge-growth", search.growth,
                "How far beyond an edge the board still gives returns, as a share of the beam's\n"
                "width, instead of that of --lidar",
                {.range = {{-10.0, 10.0}}, .excludes = "--raw-edges"});
  arguments.Add("--seed", search.seed, "Seed of the search for planes", {.shows_default = true});
}

Expected<BoardSearchOptions> SearchOptionsFrom(const SearchArguments& arguments) {
  SEXTANT_ASSIGN_OR_RETURN(const LidarBeam beam, BeamOf(arguments));
  BoardSearchOptions search{
      .correct_edges = !arguments.raw_edges, .beam = beam, .seed = arguments.seed};
  if (arguments.region.empty()) return search;
  LidarRegion region;
  for (int i = 0; i < 3; ++i) {
    region.low(i) = arguments.region[static_cast<std::size_t>(i)];
    region.high(i) = arguments.region[static_cast<std::size_t>(i + 3)];
    if (region.low(i) < region.high(i)) continue;
    return MakeError(
        ErrorCode::kInvalidOption,
        fmt::format("--region: expected the lower before the upper corner, x y z x y z "
                    "in metres; along {} it ends at {} and begins at {}",
                    "xyz"[i], region.high(i), region.low(i)));
  }
  search.region = region;
  return search;
}

std::vector<std::string> ConfigurationOf(const SearchArguments& arguments) {
  std::vector<std::string> lines = {fmt::format("lidar: {}", arguments.lidar),
                                    fmt::format("seed: {}", arguments.seed)};
  const auto add = [&lines](const char* name, const std::optional<double>& value) {
    if (value) lines.push_back(fmt::format("{}: {}", name, *value));
  };
  add("beam_aperture_m", arguments.aperture_m);
  add("beam_divergence_rad", arguments.divergence_rad);
  add("edge_growth", arguments.growth);
  if (arguments.raw_edges) lines.emplace_back("raw_edges: true");
  if (!arguments.region.empty()) {
    lines.push_back(fmt::format("region: {}", fmt::join(arguments.region, " ")));
  }
  return lines;
}

}  // namespace sextant::cli
