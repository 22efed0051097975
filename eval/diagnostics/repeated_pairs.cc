// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/repeated_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "base/median.h"
#include "eval/diagnostics/near_copies.h"
#include "geometry/pair_noise.h"

namespace sextant {
namespace {

Eigen::Vector3d& ObservationOf(Pair3d3d& pair) { return pair.point_in_cam; }
const Eigen::Vector3d& ObservationOf(const Pair3d3d& pair) { return pair.point_in_cam; }
Eigen::Vector2d& ObservationOf(Pair2d3d& pair) { return pair.pixel; }
const Eigen::Vector2d& ObservationOf(const Pair2d3d& pair) { return pair.pixel; }

double SigmaOf(const Pair3d3d& pair) {
  return HasKnownNoise(pair) ? 1.0 / std::sqrt(IsotropicWeight(pair)) : 0.0;
}
double SigmaOf(const Pair2d3d& pair) { return pair.sigma_px; }

template <class Pair>
double SpreadOf(const std::vector<Pair>& pairs) {
  auto mean = ObservationOf(pairs.front());
  mean.setZero();
  for (const Pair& pair : pairs) mean += ObservationOf(pair) / static_cast<double>(pairs.size());
  double squares = 0.0;
  for (const Pair& pair : pairs) squares += (ObservationOf(pair) - mean).squaredNorm();
  return std::sqrt(squares / static_cast<double>(pairs.size()));
}

// Coordinates along a direction in which no wall or board is flat, with the index.
template <class Pair>
std::vector<std::pair<double, std::size_t>> SortedAlong(const std::vector<Pair>& pairs) {
  const Eigen::Vector3d direction = Eigen::Vector3d(0.4142, 0.6180, 0.7321).normalized();
  std::vector<std::pair<double, std::size_t>> sorted;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    sorted.emplace_back(direction.dot(pairs[i].point_in_lidar), i);
  }
  std::ranges::sort(sorted);
  return sorted;
}

// LiDAR points no further apart are the same: 5e-4 of the median distance from the median point,
// which a few far points do not change.
template <class Pair>
double SamePointDistance(const std::vector<Pair>& pairs) {
  constexpr double kSame = 5e-4;
  std::vector<double> values(pairs.size());
  Eigen::Vector3d centre;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < pairs.size(); ++i) values[i] = pairs[i].point_in_lidar[axis];
    centre[axis] = UpperMedian(values);
  }
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    values[i] = (pairs[i].point_in_lidar - centre).norm();
  }
  return kSame * UpperMedian(values);
}

template <class Pair>
class RepeatMerger {
 public:
  RepeatMerger(std::vector<Pair>& pairs, RepeatedPairs& found)
      : pairs_(pairs), found_(found), members_(pairs.size(), 1), is_merged_(pairs.size(), false) {}

  void Run() {
    if (pairs_.empty()) return;
    constexpr double kOfSpread = 0.02;
    max_apart_ = kOfSpread * SpreadOf(pairs_);
    std::vector<bool> is_repeat(pairs_.size(), false);
    MergeNearCopies(is_repeat);
    const auto sorted = SortedAlong(pairs_);
    std::vector<std::size_t> place(pairs_.size());
    for (std::size_t k = 0; k < sorted.size(); ++k) place[sorted[k].second] = k;
    const double same = SamePointDistance(pairs_);
    std::vector<std::size_t> repeats;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      if (is_repeat[i]) continue;
      repeats.clear();
      const auto take = [&](std::size_t k) {
        const std::size_t j = sorted[k].second;
        if (std::abs(sorted[k].first - sorted[place[i]].first) > same) return false;
        const double apart = (pairs_[j].point_in_lidar - pairs_[i].point_in_lidar).norm();
        if (j > i && !is_repeat[j] && apart <= same) repeats.push_back(j);
        return true;
      };
      for (std::size_t k = place[i] + 1; k < sorted.size() && take(k); ++k) continue;
      for (std::size_t k = place[i]; k > 0 && take(k - 1); --k) continue;
      std::ranges::sort(repeats);
      for (const std::size_t j : repeats) {
        is_repeat[j] = true;
        Compare(i, j);
      }
    }
    RemoveMerged();
    const auto by_repeat = [](const RepeatedPair& pair) { return pair.repeat; };
    std::ranges::sort(found_.merged, {}, by_repeat);
    std::ranges::sort(found_.contradictory, {}, by_repeat);
  }

 private:
  // Each point that was measured several times remains as the mean, in place of its first pair.
  void MergeNearCopies(std::vector<bool>& is_repeat) {
    const auto count = static_cast<Eigen::Index>(pairs_.size());
    Eigen::Matrix3Xd in_lidar(3, count);
    Eigen::MatrixXd observed(ObservationOf(pairs_.front()).size(), count);
    std::vector<PairId> ids;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      in_lidar.col(static_cast<Eigen::Index>(i)) = pairs_[i].point_in_lidar;
      observed.col(static_cast<Eigen::Index>(i)) = ObservationOf(pairs_[i]);
      ids.push_back(pairs_[i].id);
    }
    const std::vector<int> points = PointsOfNearCopies(in_lidar, observed, ids);
    std::vector<std::size_t> first;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const auto point = static_cast<std::size_t>(points[i]);
      if (point == first.size()) {
        first.push_back(i);
        continue;
      }
      Pair& kept = pairs_[first[point]];
      const auto place = static_cast<Eigen::Index>(first[point]);
      const auto difference = (ObservationOf(pairs_[i]) - ObservationOf(kept)).eval();
      const double share = 1.0 / static_cast<double>(++members_[first[point]]);
      ObservationOf(kept) += share * difference;
      kept.point_in_lidar += share * (pairs_[i].point_in_lidar - kept.point_in_lidar);
      is_repeat[i] = true;
      is_merged_[i] = true;
      const double apart = (ObservationOf(pairs_[i]) - observed.col(place)).norm();
      found_.merged.push_back(
          {.first = static_cast<int>(first[point]), .repeat = static_cast<int>(i), .apart = apart});
    }
    if (points.empty()) return;
    found_.measured = static_cast<int>(pairs_.size());
    found_.points = static_cast<int>(first.size());
  }

  void Compare(std::size_t first, std::size_t repeat) {
    constexpr double kSigmas = 5.0;
    auto& kept = ObservationOf(pairs_[first]);
    const auto difference = (ObservationOf(pairs_[repeat]) - kept).eval();
    const RepeatedPair pair{.first = static_cast<int>(first),
                            .repeat = static_cast<int>(repeat),
                            .apart = difference.norm()};
    const double sigma = std::hypot(SigmaOf(pairs_[first]), SigmaOf(pairs_[repeat]));
    if (pair.apart > std::max(max_apart_, kSigmas * sigma)) {
      found_.contradictory.push_back(pair);
      return;
    }
    kept += difference / static_cast<double>(++members_[first]);
    is_merged_[repeat] = true;
    found_.merged.push_back(pair);
  }

  void RemoveMerged() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < pairs_.size(); ++i) {
      if (is_merged_[i]) continue;
      if (kept != i) pairs_[kept] = std::move(pairs_[i]);
      ++kept;
    }
    pairs_.resize(kept);
  }

  std::vector<Pair>& pairs_;
  RepeatedPairs& found_;
  std::vector<int> members_;  // Observations in the mean of each pair.
  std::vector<bool> is_merged_;
  double max_apart_ = 0.0;
};

std::string ListOf(const std::vector<RepeatedPair>& pairs) {
  constexpr std::size_t kMaxListed = 8;
  std::string text;
  for (std::size_t i = 0; i < std::min(pairs.size(), kMaxListed); ++i) {
    text += fmt::format("{}{} of {}", i == 0 ? "" : ", ", pairs[i].repeat + 1, pairs[i].first + 1);
  }
  return pairs.size() > kMaxListed ? text + ", ..." : text;
}

}  // namespace

std::vector<RepeatedPairs> MergeRepeatedPairs(CalibrationProblem& problem) {
  RepeatedPairs points{
      .in_pixels = false, .merged = {}, .contradictory = {}, .measured = 0, .points = 0};
  RepeatedPairs pixels{
      .in_pixels = true, .merged = {}, .contradictory = {}, .measured = 0, .points = 0};
  RepeatMerger(problem.pairs_3d3d, points).Run();
  RepeatMerger(problem.pairs_2d3d, pixels).Run();
  if (!points.merged.empty()) problem.point_sets = WithholdPairing(problem.pairs_3d3d);
  std::vector<RepeatedPairs> found;
  for (RepeatedPairs* of_kind : {&points, &pixels}) {
    const bool is_empty = of_kind->merged.empty() && of_kind->contradictory.empty();
    if (!is_empty) found.push_back(std::move(*of_kind));
  }
  return found;
}

std::vector<std::string> Describe(const RepeatedPairs& repeated, double sigma) {
  constexpr std::size_t kMaxLines = 5;
  std::vector<std::string> lines;
  if (repeated.points > 0) {
    lines.push_back(fmt::format(
        "repeated: {} pairs were merged into {}, the means of those that measure one "
        "point: they differ far less than the points, and alike measurements share "
        "their errors",
        repeated.measured, repeated.measured - static_cast<int>(repeated.merged.size())));
  } else if (!repeated.merged.empty()) {
    lines.push_back(
        fmt::format("repeated: {} pairs repeat others and count once, because copies of a "
                    "measurement add no information (pair {})",
                    repeated.merged.size(), ListOf(repeated.merged)));
  }
  std::vector<RepeatedPair> contradictory = repeated.contradictory;
  const char* unit = repeated.in_pixels ? "px" : "m";
  // What one of so many differences exceeds by noise with a probability of 1 %.
  const auto count = static_cast<double>(std::max<std::size_t>(1, contradictory.size()));
  const double by_noise =
      std::numbers::sqrt2 * sigma * (std::sqrt(2.0 * std::log(100.0 * count)) + 0.5);
  const std::size_t explained = std::erase_if(
      contradictory, [&](const RepeatedPair& pair) { return pair.apart <= by_noise; });
  if (explained > 0) {
    lines.push_back(fmt::format(
        "repeated: {} pairs have the LiDAR point of another one, but other points in the camera, "
        "at most {:.2g} {} apart, as the noise of the pairs explains ({:.2g} {}): an error of that "
        "LiDAR point counts several times, so that the stated uncertainty may be too small",
        explained, by_noise, unit, sigma, unit));
  }
  for (const RepeatedPair& pair : contradictory) {
    if (lines.size() == kMaxLines) {
      lines.push_back(fmt::format("contradiction: {} pairs in all have another one's LiDAR point",
                                  contradictory.size()));
      break;
    }
    lines.push_back(fmt::format(
        "contradiction: pairs {} and {} have the same LiDAR point, but are {:.4g} {} apart in the "
        "camera: one of them is wrong; correct or remove it",
        pair.first + 1, pair.repeat + 1, pair.apart, unit));
  }
  return lines;
}

int PlaceInFile(int index, bool in_pixels, std::span<const RepeatedPairs> repeated) {
  for (const RepeatedPairs& of_kind : repeated) {
    if (of_kind.in_pixels != in_pixels) continue;
    for (const RepeatedPair& pair : of_kind.merged) {
      if (pair.repeat <= index) ++index;
    }
  }
  return index + 1;
}

}  // namespace sextant
