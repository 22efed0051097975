// SPDX-License-Identifier: Apache-2.0
#include "calibrate/match/repeated_views.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace sextant {
namespace {

// Every coordinate that the boards of a view have in its image and in its scan.
std::vector<double> ContentOf(const Observation& view) {
  std::vector<double> content;
  const auto add = [&content](const auto& points) {
    for (const auto& point : points) {
      content.insert(content.end(), point.data(), point.data() + point.size());
    }
  };
  for (const CameraSighting& sighting : view.in_image) {
    content.push_back(sighting.board);
    add(sighting.corners.points);
    for (const BoardPoints& printed : sighting.printed) add(printed.pixels);
  }
  for (const LidarSighting& sighting : view.in_scan) {
    add(sighting.face);
    for (const BoardPlacement& placement : sighting.placements) add(placement.corners.in_lidar);
  }
  return content;
}

// The corners of a kept board, and the mean variance of a coordinate.
struct SensedCorners {
  const std::vector<Eigen::Vector3d>* corners = nullptr;
  double variance = 0.0;
};

SensedCorners CornersInCam(const Observation& view, const MatchedBoard& kept) {
  const CameraSighting& sighting = view.in_image[static_cast<std::size_t>(kept.sighting)];
  const Eigen::MatrixXd& covariance = sighting.corners.covariance;
  return {kept.other_pose ? &sighting.other_corners : &sighting.corners.points,
          covariance.trace() / static_cast<double>(covariance.rows())};
}

SensedCorners CornersInLidar(const Observation& view, const MatchedBoard& kept) {
  const LidarCorners& corners = view.in_scan[static_cast<std::size_t>(kept.patch)]
                                    .placements[static_cast<std::size_t>(kept.placement)]
                                    .corners;
  return {&corners.in_lidar,
          corners.covariance.trace() / static_cast<double>(corners.covariance.rows())};
}

bool IsSamePlace(const SensedCorners& a, const SensedCorners& b, double floor_m) {
  constexpr double kSigmas = 3.0;
  // In root mean square over the three coordinates of every corner.
  const double limit =
      3.0 * std::max(kSigmas * kSigmas * (a.variance + b.variance), floor_m * floor_m);
  double squares = 0.0;
  const std::size_t corners = std::min(a.corners->size(), b.corners->size());
  for (std::size_t k = 0; k < corners; ++k) {
    squares += ((*a.corners)[k] - (*b.corners)[k]).squaredNorm();
    if (squares > limit * static_cast<double>(corners)) return false;
  }
  return true;
}

}  // namespace

std::vector<std::optional<std::size_t>> FindCopies(std::span<const Observation> views) {
  std::vector<std::optional<std::size_t>> copies(views.size());
  std::map<std::vector<double>, std::size_t> first;
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (views[i].in_image.empty() || views[i].in_scan.empty()) continue;
    const auto [entry, is_first] = first.try_emplace(ContentOf(views[i]), i);
    if (!is_first) copies[i] = entry->second;
  }
  return copies;
}

std::vector<RepeatedPlacement> FindRepeatedPlacements(std::span<const Observation> views,
                                                      std::span<const MatchedBoard> kept,
                                                      double floor_m) {
  struct Place {
    SensedCorners in_cam;
    SensedCorners in_lidar;
    RepeatedPlacement shown;
  };
  std::vector<Place> places;
  for (const MatchedBoard& match : kept) {
    const Observation& view = views[static_cast<std::size_t>(match.view)];
    const int board = view.in_image[static_cast<std::size_t>(match.sighting)].board;
    const SensedCorners in_cam = CornersInCam(view, match);
    const SensedCorners in_lidar = CornersInLidar(view, match);
    const auto same = std::ranges::find_if(places, [&](const Place& place) {
      return place.shown.board == board && IsSamePlace(place.in_cam, in_cam, floor_m) &&
             IsSamePlace(place.in_lidar, in_lidar, floor_m);
    });
    if (same == places.end()) {
      places.push_back({in_cam, in_lidar, {.board = board, .views = {match.view}}});
    } else {
      same->shown.views.push_back(match.view);
    }
  }
  std::vector<RepeatedPlacement> repeated;
  for (Place& place : places) {
    if (place.shown.views.size() > 1) repeated.push_back(std::move(place.shown));
  }
  return repeated;
}

void CountPlacementsOnce(std::span<const RepeatedPlacement> placements,
                         std::span<const Board> boards, CalibrationProblem& problem) {
  std::map<std::pair<int, int>, double> factors;  // By view and Board::id.
  for (const RepeatedPlacement& placement : placements) {
    const int id = boards[static_cast<std::size_t>(placement.board)].id;
    for (const int view : placement.views) {
      factors[{view, id}] = static_cast<double>(placement.views.size());
    }
  }
  const auto factor_of = [&factors](int view, int board) {
    const auto found = factors.find({view, board});
    return found == factors.end() ? 1.0 : found->second;
  };
  for (Pair3d3d& pair : problem.pairs_3d3d) {
    const double factor = factor_of(pair.id.view, pair.id.board);
    pair.sigma_m *= std::sqrt(factor);
    if (pair.covariance_in_cam) *pair.covariance_in_cam *= factor;
  }
  for (Pair2d3d& pair : problem.pairs_2d3d) {
    pair.sigma_px *= std::sqrt(factor_of(pair.id.view, pair.id.board));
  }
  for (BoardView& view : problem.board_views) {
    const double factor = factor_of(view.view, view.board);
    view.range_sigma_m *= std::sqrt(factor);
    for (BoardPoints& printed : view.printed) printed.covariance_px2 *= factor;
    for (EdgeRay& edge : view.edges) edge.sigma_m *= std::sqrt(factor);
  }
}

std::vector<std::vector<int>> ViewsThatShare(std::span<const RepeatedPlacement> placements) {
  std::vector<std::vector<int>> groups;
  for (const RepeatedPlacement& placement : placements) {
    std::vector<int> joined = placement.views;
    std::erase_if(groups, [&joined](const std::vector<int>& group) {
      const bool shares = std::ranges::find_first_of(group, joined) != group.end();
      if (shares) joined.insert(joined.end(), group.begin(), group.end());
      return shares;
    });
    std::ranges::sort(joined);
    joined.erase(std::unique(joined.begin(), joined.end()), joined.end());
    groups.push_back(std::move(joined));
  }
  return groups;
}

}  // namespace sextant
