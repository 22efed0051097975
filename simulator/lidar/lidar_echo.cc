// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cassert>
#include <span>

#include "simulator/lidar/lidar_beam.h"

namespace sextant {
namespace {

using Hits = std::span<const LidarBeams::SubHit>;

double PowerOf(const LidarBeams::SubHit& hit) {
  return hit.reflectivity / (hit.range_m * hit.range_m);
}

double PowerOf(Hits hits) {
  double power = 0.0;
  for (const LidarBeams::SubHit& hit : hits) power += PowerOf(hit);
  return power;
}

bool SameFace(const LidarBeams::SubHit& a, const LidarBeams::SubHit& b) {
  return a.target == b.target && a.face == b.face;
}

// A hit on the face that contributes most of the power.
const LidarBeams::SubHit& OnMainFace(Hits hits) {
  const LidarBeams::SubHit* best = &hits[0];
  double best_power = -1.0;
  for (const LidarBeams::SubHit& candidate : hits) {
    if (best_power >= 0.0 && SameFace(candidate, *best)) continue;
    double power = 0.0;
    for (const LidarBeams::SubHit& hit : hits) {
      if (SameFace(hit, candidate)) power += PowerOf(hit);
    }
    if (power > best_power) {
      best_power = power;
      best = &candidate;
    }
  }
  return *best;
}

LidarEcho MakeEcho(Hits hits, int sub_rays) {
  LidarEcho echo;
  const LidarBeams::SubHit& main = OnMainFace(hits);
  double weighted_range = 0.0;
  double range_sum = 0.0;
  int on_face = 0;
  int black = 0;
  for (const LidarBeams::SubHit& hit : hits) {
    echo.power += PowerOf(hit);
    weighted_range += PowerOf(hit) * hit.range_m;
    range_sum += hit.range_m;
    echo.reflectivity += hit.reflectivity;
    on_face += SameFace(hit, main) ? 1 : 0;
    black += hit.black ? 1 : 0;
  }
  const auto count = static_cast<double>(hits.size());
  echo.range_m = echo.power > 0.0 ? weighted_range / echo.power : range_sum / count;
  echo.power /= sub_rays;
  echo.reflectivity /= sub_rays;
  echo.black_share = black / count;
  echo.lit_share = count / sub_rays;
  echo.truth = {.object = main.target->object,
                .index = main.target->index,
                .spot_share = static_cast<double>(on_face) / sub_rays,
                .mixed = on_face < static_cast<int>(hits.size())};
  return echo;
}

}  // namespace

LidarEcho StrongestEcho(std::vector<LidarBeams::SubHit>& hits, int sub_rays,
                        double pulse_length_m) {
  assert(!hits.empty());
  std::ranges::stable_sort(hits, {}, &LidarBeams::SubHit::range_m);
  Hits strongest;
  double strongest_power = -1.0;
  std::size_t begin = 0;
  for (std::size_t end = 1; end <= hits.size(); ++end) {
    if (end < hits.size() && hits[end].range_m - hits[end - 1].range_m < pulse_length_m) continue;
    const Hits echo(hits.data() + begin, end - begin);
    const double power = PowerOf(echo);
    if (power > strongest_power) {
      strongest_power = power;
      strongest = echo;
    }
    begin = end;
  }
  return MakeEcho(strongest, sub_rays);
}

}  // namespace sextant
