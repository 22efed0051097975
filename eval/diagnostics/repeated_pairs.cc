// SPDX-License-Identifier: Apache-2.0
#include "eval/diagnostics/repeated_pairs.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

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

// The indices by LiDAR point, and those of one point in the order of the list.
template <class Pair>
std::vector<std::size_t> ByPoint(const std::vector<Pair>& pairs) {
  std::vector<std::size_t> order(pairs.size());
  std::iota(order.begin(), order.end(), 0U);
  std::ranges::sort(order, {}, [&](std::size_t i) {
    const Eigen::Vector3d& p = pairs[i].point_in_lidar;
    return std::tuple(p.x(), p.y(), p.z(), i);
  });
  return order;
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
    const std::vector<std::size_t> order = ByPoint(pairs_);
    for (std::size_t begin = 0; begin < order.size();) {
      std::size_t end = begin + 1;
      while (end < order.size() &&
             pairs_[order[end]].point_in_lidar == pairs_[order[begin]].point_in_lidar) {
        ++end;
      }
      for (std::size_t i = begin + 1; i < end; ++i) Compare(order[begin], order[i]);
      begin = end;
    }
    RemoveMerged();
    const auto by_repeat = [](const RepeatedPair& pair) { return pair.repeat; };
    std::ranges::sort(found_.merged, {}, by_repeat);
    std::ranges::sort(found_.contradictory, {}, by_repeat);
  }

 private:
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
  RepeatedPairs points{.in_pixels = false, .merged = {}, .contradictory = {}};
  RepeatedPairs pixels{.in_pixels = true, .merged = {}, .contradictory = {}};
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

std::vector<std::string> Describe(const RepeatedPairs& repeated) {
  constexpr std::size_t kMaxLines = 5;
  std::vector<std::string> lines;
  if (!repeated.merged.empty()) {
    lines.push_back(
        fmt::format("repeated: {} pairs repeat others and count once, because copies of a "
                    "measurement add no information (pair {})",
                    repeated.merged.size(), ListOf(repeated.merged)));
  }
  for (const RepeatedPair& pair : repeated.contradictory) {
    if (lines.size() == kMaxLines) {
      lines.push_back(fmt::format("contradiction: {} pairs in all have another one's LiDAR point",
                                  repeated.contradictory.size()));
      break;
    }
    lines.push_back(fmt::format(
        "contradiction: pairs {} and {} have the same LiDAR point, but are {:.4g} {} apart in the "
        "camera: one of them is wrong; correct or remove it",
        pair.first + 1, pair.repeat + 1, pair.apart, repeated.in_pixels ? "px" : "m"));
  }
  return lines;
}

}  // namespace sextant
