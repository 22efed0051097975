// SPDX-License-Identifier: Apache-2.0
#include "features/lidar/lidar_beam.h"

#include <fmt/core.h>

#include "base/nearest_name.h"
#include "base/units.h"

namespace sextant {
namespace {

// For a receiver that reports the strongest echo, however little of the spot is on the board; the
// VLP-16 loses the weakest echoes.
constexpr double kGrowth = 0.31;
constexpr double kEdgeSigma = 0.05;

struct BeamEntry {
  const char* name;
  LidarBeam beam;
};

LidarBeam Beam(double aperture_h_m, double aperture_v_m, double divergence_h_rad,
               double divergence_v_rad) {
  LidarBeam beam;
  beam.aperture_h_m = aperture_h_m;
  beam.aperture_v_m = aperture_v_m;
  beam.divergence_h_rad = divergence_h_rad;
  beam.divergence_v_rad = divergence_v_rad;
  beam.growth = kGrowth;
  beam.edge_sigma = kEdgeSigma;
  return beam;
}

const std::vector<BeamEntry>& BeamEntries() {
  static const std::vector<BeamEntry> entries = {
      {"vlp16", {}},
      {"hdl32e", Beam(0.0127, 0.0095, 0.003, 0.0015)},
      {"hdl64e", Beam(0.0127, 0.0095, 0.002, 0.002)},
      {"os1_64", Beam(0.010, 0.010, 0.13 * kRadPerDeg, 0.13 * kRadPerDeg)},
      {"os1_128", Beam(0.010, 0.010, 0.18 * kRadPerDeg, 0.18 * kRadPerDeg)},
      {"pandar40p", Beam(0.0127, 0.0095, 0.003, 0.0015)},
      {"livox", Beam(0.005, 0.005, 0.03 * kRadPerDeg, 0.28 * kRadPerDeg)},
  };
  return entries;
}

}  // namespace

const std::vector<std::string>& LidarBeamNames() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const BeamEntry& entry : BeamEntries()) list.emplace_back(entry.name);
    return list;
  }();
  return names;
}

Expected<LidarBeam> FindLidarBeam(std::string_view name) {
  for (const BeamEntry& entry : BeamEntries()) {
    if (name == entry.name) return entry.beam;
  }
  return MakeError(ErrorCode::kUnknownName, fmt::format("no known beam of a LiDAR '{}'; {}", name,
                                                        SuggestName(name, LidarBeamNames())));
}

}  // namespace sextant
