// SPDX-License-Identifier: Apache-2.0
#include "calibrate/configuration.h"

#include <fmt/core.h>

#include "base/units.h"

namespace sextant {
namespace {

std::vector<std::string> Describe(const BoardSearchOptions& search) {
  const LidarBeam& beam = search.beam;
  std::vector<std::string> lines = {
      fmt::format("seed: {}", search.seed),
      fmt::format("beam_aperture_m: {} {}", beam.aperture_h_m, beam.aperture_v_m),
      fmt::format("beam_divergence_rad: {} {}", beam.divergence_h_rad, beam.divergence_v_rad),
      fmt::format("edge_growth: {} {} {}", beam.growth, beam.growth_sigma, beam.edge_sigma)};
  if (!search.correct_edges) lines.emplace_back("raw_edges: true");
  if (search.region) {
    const Eigen::Vector3d& low = search.region->low;
    const Eigen::Vector3d& high = search.region->high;
    lines.push_back(fmt::format("region: {} {} {} {} {} {}", low.x(), low.y(), low.z(), high.x(),
                                high.y(), high.z()));
  }
  return lines;
}

}  // namespace

std::vector<std::string> ConfigurationLines(const ObservedSession& observed,
                                            const CalibrateOptions& options,
                                            const std::string& solver) {
  const ObserveOptions& observe = options.observe;
  std::vector<std::string> lines = {
      fmt::format("solver: {}", solver), fmt::format("extractor: {}", observe.extractor),
      fmt::format("detector: {}", observe.detector.empty() ? "usual" : observe.detector)};
  const std::vector<std::string> search =
      options.search_description.empty() ? Describe(observe.search) : options.search_description;
  lines.insert(lines.end(), search.begin(), search.end());
  if (const auto initial = MatchSettingsFor(observed.session, options).initial) {
    const Eigen::Quaterniond& q = initial->rotation;
    lines.push_back(
        fmt::format("initial_quaternion_wxyz: {} {} {} {}", q.w(), q.x(), q.y(), q.z()));
  }
  if (!observed.session.bag.empty()) {
    lines.push_back(fmt::format("tolerance_s: {}", options.tolerance_s));
  }
  lines.push_back(fmt::format("bootstrap_samples: {}", options.bootstrap_samples));
  lines.push_back(fmt::format("need: {:g} mm {:g} deg", 1e3 * options.need.translation_m,
                              options.need.rotation_rad * kDegPerRad));
  for (const Board& board : observed.boards) {
    lines.push_back(
        fmt::format("board {}: {} x {} m", board.id, board.top_right_m, board.right_bottom_m));
  }
  return lines;
}

MatchSettings MatchSettingsFor(const Session& session, const CalibrateOptions& options) {
  MatchSettings settings = options.match;
  if (!settings.initial) settings.initial = session.initial_cam_from_lidar;
  return settings;
}

}  // namespace sextant
