// SPDX-License-Identifier: Apache-2.0
#include "calibrate/match/match.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/median.h"
#include "base/units.h"
#include "calibrate/match/sensor_agreement.h"
#include "geometry/scan_marks.h"
#include "solvers/matching/object_match.h"

namespace sextant {
namespace {

constexpr double kNumbersPerBoard = 3.0 * kCornersPerBoard;
constexpr double kMaxSigmas = 4.0;
constexpr double kEquallyLikely = 9.2;  // -2 ln(0.01): likelihood ratio of 1 %.

// The candidate pairings of one view for the matcher, and the match that each of them means.
struct ViewPairings {
  MatchView view;
  std::vector<MatchedBoard> meanings;
};

double MeanVariance(const Eigen::MatrixXd& covariance) {
  return covariance.topLeftCorner<3 * kCornersPerBoard, 3 * kCornersPerBoard>().trace() /
         kNumbersPerBoard;
}

std::vector<Eigen::Vector3d> Outer(const std::vector<Eigen::Vector3d>& corners) {
  return {corners.begin(), corners.begin() + kCornersPerBoard};
}

void AddPairing(const Observation& observation, const MatchedBoard& match, double floor_m,
                ViewPairings& pairings) {
  const CameraSighting& sighting = observation.in_image[static_cast<std::size_t>(match.sighting)];
  const BoardPlacement& placement = observation.in_scan[static_cast<std::size_t>(match.patch)]
                                        .placements[static_cast<std::size_t>(match.placement)];
  const double variance = MeanVariance(sighting.corners.covariance) +
                          MeanVariance(placement.corners.covariance) + floor_m * floor_m;
  const double other = match.other_pose ? sighting.pose.ambiguity_chi_square : 0.0;
  pairings.view.pairings.push_back(
      {.in_b = match.sighting,
       .in_a = match.patch,
       .points_in_b = Outer(match.other_pose ? sighting.other_corners : sighting.corners.points),
       .points_in_a = Outer(placement.corners.in_lidar),
       .sigma_m = std::sqrt(variance),
       .penalty = placement.misfit + other});
  pairings.meanings.push_back(match);
}

// The patches that may be the board: all that have its outline, or those that fit it best.
std::vector<std::size_t> CandidatePatches(const Observation& observation, int board) {
  std::vector<std::pair<double, std::size_t>> fitting;
  for (std::size_t p = 0; p < observation.in_scan.size(); ++p) {
    const auto& placements = observation.in_scan[p].placements;
    const auto best = std::ranges::find(placements, board, &BoardPlacement::board);
    if (best != placements.end()) fitting.emplace_back(best->misfit, p);
  }
  if (fitting.size() > kMaxPatchesPerBoard) {
    std::ranges::sort(fitting);
    fitting.resize(kMaxPatchesPerBoard);
  }
  std::vector<std::size_t> patches;
  for (const auto& [misfit, patch] : fitting) patches.push_back(patch);
  std::ranges::sort(patches);
  return patches;
}

ViewPairings PairingsOf(const Observation& observation, int view, const MatchSettings& settings) {
  ViewPairings pairings;
  for (std::size_t s = 0; s < observation.in_image.size(); ++s) {
    const CameraSighting& sighting = observation.in_image[s];
    if (!sighting.left_out.empty()) continue;
    const int poses = sighting.pose.ambiguous_with ? 2 : 1;
    for (const std::size_t p : CandidatePatches(observation, sighting.board)) {
      const auto& placements = observation.in_scan[p].placements;
      for (std::size_t k = 0; k < placements.size(); ++k) {
        if (placements[k].board != sighting.board) continue;
        for (int pose = 0; pose < poses; ++pose) {
          const MatchedBoard match{.view = view,
                                   .sighting = static_cast<int>(s),
                                   .patch = static_cast<int>(p),
                                   .placement = static_cast<int>(k),
                                   .other_pose = pose == 1};
          if (!MayBeSameBoard(observation, match, MaxApart(settings))) continue;
          AddPairing(observation, match, settings.floor_m, pairings);
        }
      }
    }
  }
  return pairings;
}

// Median chi-square per number of the corners that fit: their variance over the stated one; at
// least 1.
double NoiseScale(const MatchExplanation& explanation) {
  std::vector<double> costs;
  for (const TakenPairing& taken : explanation.taken) {
    if (taken.fits) costs.push_back(taken.cost / kNumbersPerBoard);
  }
  // Two boards nearly always fit each other, so their median does not measure the noise.
  if (costs.size() < 3) return 1.0;
  return std::max(1.0, UpperMedian(costs));
}

DroppedBoard Dropped(const Observation& observation, const MatchedBoard& match,
                     const ObjectPairing& pairing, const Rigid3d& cam_from_lidar) {
  DroppedBoard dropped{.match = match};
  double squares = 0.0;
  for (std::size_t i = 0; i < pairing.points_in_b.size(); ++i) {
    squares += (pairing.points_in_b[i] - cam_from_lidar * pairing.points_in_a[i]).squaredNorm();
  }
  dropped.off_m = std::sqrt(squares / static_cast<double>(pairing.points_in_b.size()));
  const CameraSighting& sighting = observation.in_image[static_cast<std::size_t>(match.sighting)];
  const Rigid3d& cam_from_board =
      match.other_pose ? *sighting.pose.ambiguous_with : sighting.pose.cam_from_board;
  const Rigid3d& lidar_from_board = observation.in_scan[static_cast<std::size_t>(match.patch)]
                                        .placements[static_cast<std::size_t>(match.placement)]
                                        .lidar_from_board;
  dropped.off_rad = RotationDistance(cam_from_board.rotation,
                                     cam_from_lidar.rotation * lidar_from_board.rotation);
  return dropped;
}

// Number of explanations that are as likely as the first; moves the one whose rotation is nearest
// to `rotation` to the front.
std::size_t CountEquallyLikely(std::vector<MatchExplanation>& explanations, double scale,
                               const Eigen::Quaterniond& rotation) {
  std::size_t count = 1;
  while (count < explanations.size() &&
         (explanations[count].cost - explanations[0].cost) / scale < kEquallyLikely) {
    ++count;
  }
  const auto nearest = std::min_element(explanations.begin(),
                                        explanations.begin() + static_cast<std::ptrdiff_t>(count),
                                        [&](const MatchExplanation& a, const MatchExplanation& b) {
                                          return RotationDistance(a.b_from_a.rotation, rotation) <
                                                 RotationDistance(b.b_from_a.rotation, rotation);
                                        });
  std::iter_swap(explanations.begin(), nearest);
  return count;
}

}  // namespace

double MaxApart(const MatchSettings& settings) {
  return settings.max_apart_m + (settings.initial ? settings.initial->translation.norm() : 0.0);
}

Expected<Matching> MatchViews(std::span<const Observation> views, const MatchSettings& settings) {
  std::vector<ViewPairings> pairings;
  std::vector<MatchView> match_views;
  for (std::size_t i = 0; i < views.size(); ++i) {
    pairings.push_back(PairingsOf(views[i], static_cast<int>(i), settings));
    match_views.push_back(pairings.back().view);
  }
  MatchOptions options{.cap = kMaxSigmas * kMaxSigmas * kNumbersPerBoard};
  Expected<std::vector<MatchExplanation>> found = MatchObjects(match_views, options);
  if (!found && found.error().code == ErrorCode::kTooFewPairs) {
    return MakeError(
        ErrorCode::kTooFewPairs,
        fmt::format("no board was seen by both sensors in any of {} views", views.size()));
  }
  if (!found) {
    return MakeError(
        found.error().code,
        "the boards that both sensors saw do not determine a pose: their corners lie on "
        "one line");
  }
  const double scale = NoiseScale(found->front());
  if (scale > 1.0) {
    options.cap *= scale;
    found = MatchObjects(match_views, options);
    if (!found) return tl::unexpected<Error>(found.error());
  }
  Matching matching;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (views[i].in_scan.size() > kMaxPatchesPerBoard)
      matching.limited.push_back(static_cast<int>(i));
  }
  if (found->size() > 1) matching.margin = ((*found)[1].cost - (*found)[0].cost) / scale;
  const Eigen::Quaterniond initial =
      settings.initial ? settings.initial->rotation : AxesCamFromLidar().rotation;
  const std::size_t alternatives = CountEquallyLikely(*found, scale, initial);
  const MatchExplanation& best = found->front();
  matching.cam_from_lidar = best.b_from_a;
  for (std::size_t i = 1; i < alternatives; ++i)
    matching.alternatives.push_back((*found)[i].b_from_a);
  for (const TakenPairing& taken : best.taken) {
    const MatchedBoard& match = pairings[taken.view].meanings[taken.pairing];
    if (taken.fits) {
      matching.kept.push_back(match);
    } else {
      matching.dropped.push_back(Dropped(views[taken.view], match,
                                         match_views[taken.view].pairings[taken.pairing],
                                         best.b_from_a));
    }
  }
  return matching;
}

std::vector<std::string> DescribeAmbiguity(const Matching& matching,
                                           const MatchSettings& settings) {
  std::vector<std::string> lines;
  if (!matching.limited.empty()) {
    lines.push_back(fmt::format(
        "patches: {} view{} {} more than {} board-like patches in the scan (first: view {}); "
        "each board was matched with the {} that fit it best; restrict the search with --region",
        matching.limited.size(), matching.limited.size() == 1 ? "" : "s",
        matching.limited.size() == 1 ? "has" : "have", kMaxPatchesPerBoard,
        matching.limited.front(), kMaxPatchesPerBoard));
  }
  if (matching.alternatives.empty()) return lines;
  const Eigen::Quaterniond initial =
      settings.initial ? settings.initial->rotation : AxesCamFromLidar().rotation;
  double next = std::numbers::pi;
  for (const Rigid3d& other : matching.alternatives) {
    next = std::min(next, RotationDistance(other.rotation, initial));
  }
  const double taken = RotationDistance(matching.cam_from_lidar.rotation, initial);
  lines.push_back(
      fmt::format("ambiguous: {} poses explain the views equally well, because a scan does not "
                  "distinguish boards "
                  "of one shape or the quarter turns of a square one",
                  matching.alternatives.size() + 1));
  lines.push_back(fmt::format(
      "assumed: {}; the chosen pose is {:.0f} deg away from it, the next one {:.0f} deg. {}",
      settings.initial ? "the rotation of --initial"
                       : "a camera that looks along the LiDAR's x axis, upright",
      taken * kDegPerRad, next * kDegPerRad,
      settings.initial ? "More views with the board elsewhere resolve it"
                       : "If it is mounted otherwise, give a rough pose with --initial; more views "
                         "with the board elsewhere resolve it, too"));
  return lines;
}

}  // namespace sextant
