// SPDX-License-Identifier: Apache-2.0
#include "solvers/matching/object_match.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "solvers/kernels/kabsch.h"

namespace sextant {
namespace {

constexpr std::size_t kFinalists = 24;
constexpr double kDropped = 2.0;  // Cost of an unmatched object, in units of the cap.
constexpr int kMaxMatchRounds = 30;
constexpr double kSameAngle_rad = 0.1;
constexpr double kSameShift = 1.0 / 3.0;  // Relative to an object's size.
constexpr double kNoticeable_m = 1e-6;    // Costs of points that differ by less count as equal.
// Tolerances of the rounds, relative to an object's size: wide at first, as the pose of a single
// pairing is a few degrees off.
constexpr std::array<double, 4> kWidths = {0.3, 0.1, 0.03, 0.0};

using Points = std::vector<Eigen::Vector3d>;

Eigen::Vector3d MeanOf(const Points& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& point : points) sum += point;
  return sum / static_cast<double>(points.size());
}

double CostOf(const ObjectPairing& pairing, const Rigid3d& b_from_a, double width_m) {
  double squares = 0.0;
  for (std::size_t i = 0; i < pairing.points_in_b.size(); ++i) {
    squares += (pairing.points_in_b[i] - b_from_a * pairing.points_in_a[i]).squaredNorm();
  }
  return squares / (pairing.sigma_m * pairing.sigma_m + width_m * width_m) + pairing.penalty;
}

// Marks both objects as taken unless one of them is.
bool Take(int in_b, int in_a, std::vector<bool>& is_taken_in_b, std::vector<bool>& is_taken_in_a) {
  const auto b = static_cast<std::size_t>(in_b);
  const auto a = static_cast<std::size_t>(in_a);
  if (is_taken_in_b.size() <= b) is_taken_in_b.resize(b + 1, false);
  if (is_taken_in_a.size() <= a) is_taken_in_a.resize(a + 1, false);
  if (is_taken_in_b[b] || is_taken_in_a[a]) return false;
  is_taken_in_b[b] = true;
  is_taken_in_a[a] = true;
  return true;
}

// Greedy, nearest first: the distances of objects in one view are large compared with the error of
// a reasonable pose.
void PairView(const MatchView& view, std::size_t index, const Rigid3d& pose, double cap,
              double width_m, MatchExplanation& explanation) {
  std::vector<TakenPairing> all;
  for (std::size_t i = 0; i < view.pairings.size(); ++i) {
    const double cost = CostOf(view.pairings[i], pose, width_m);
    all.push_back({.view = index, .pairing = i, .cost = cost, .fits = cost < cap});
  }
  std::ranges::stable_sort(all, {}, &TakenPairing::cost);
  std::vector<bool> is_taken_in_b;
  std::vector<bool> is_taken_in_a;
  for (const TakenPairing& candidate : all) {
    const ObjectPairing& pairing = view.pairings[candidate.pairing];
    if (!Take(pairing.in_b, pairing.in_a, is_taken_in_b, is_taken_in_a)) continue;
    explanation.taken.push_back(candidate);
    explanation.cost += candidate.fits ? candidate.cost : kDropped * cap;
  }
}

MatchExplanation Explain(std::span<const MatchView> views, const Rigid3d& pose, double cap,
                         double width_m) {
  MatchExplanation explanation{.b_from_a = pose};
  for (std::size_t i = 0; i < views.size(); ++i) {
    PairView(views[i], i, pose, cap, width_m, explanation);
  }
  return explanation;
}

bool SamePairings(const MatchExplanation& a, const MatchExplanation& b) {
  return std::ranges::equal(a.taken, b.taken, [](const TakenPairing& x, const TakenPairing& y) {
    return x.view == y.view && x.pairing == y.pairing && x.fits == y.fits;
  });
}

class Matcher {
 public:
  Matcher(std::span<const MatchView> views, const MatchOptions& options)
      : views_(views), options_(options) {
    double size = 0.0;
    double count = 0.0;
    for (const MatchView& view : views) {
      for (const ObjectPairing& pairing : view.pairings) {
        const Eigen::Vector3d mean = MeanOf(pairing.points_in_a);
        size += (pairing.points_in_a.front() - mean).norm();
        center_ += mean;
        count += 1.0;
        noticeable_ = std::max(noticeable_, std::pow(kNoticeable_m / pairing.sigma_m, 2) *
                                                static_cast<double>(pairing.points_in_a.size()));
      }
    }
    pairings_ = static_cast<std::size_t>(count);
    if (pairings_ == 0) return;
    ChooseScored();
    size_ = size / count;
    center_ /= count;
  }

  bool IsEmpty() const { return pairings_ == 0; }

  std::vector<Rigid3d> Starts() const {
    std::vector<Rigid3d> starts = options_.starts;
    // Every view where there are few, else an evenly spread subset.
    const double share =
        std::min(1.0, static_cast<double>(options_.max_starts) / static_cast<double>(pairings_));
    double due = 1.0;
    for (const MatchView& view : views_) {
      if (due >= 1.0) {
        due -= 1.0;
        for (const ObjectPairing& pairing : view.pairings) {
          const auto fit = FitKabsch(pairing.points_in_b, pairing.points_in_a);
          if (fit) starts.push_back(fit->b_from_a);
        }
      }
      due += share;
    }
    return starts;
  }

  // The best starts that differ from each other, in the order of the starts.
  std::vector<Rigid3d> Finalists(const std::vector<Rigid3d>& starts) const {
    struct Scored {
      std::size_t start;
      double cost;
    };
    std::vector<Scored> scored;
    for (std::size_t i = 0; i < starts.size(); ++i) {
      const double cost = Explain(scored_, starts[i], options_.cap, kWidths[0] * size_).cost;
      scored.push_back({i, cost});
    }
    std::ranges::stable_sort(scored, {}, &Scored::cost);
    std::vector<std::size_t> chosen;
    for (const Scored& candidate : scored) {
      if (chosen.size() == kFinalists) break;
      const bool is_new = std::ranges::none_of(chosen, [&](std::size_t other) {
        return IsSame(starts[candidate.start], starts[other]);
      });
      if (is_new) chosen.push_back(candidate.start);
    }
    std::ranges::sort(chosen);
    std::vector<Rigid3d> finalists;
    for (const std::size_t i : chosen) finalists.push_back(starts[i]);
    return finalists;
  }

  std::optional<MatchExplanation> Follow(const Rigid3d& start) const {
    Rigid3d pose = start;
    MatchExplanation explanation;
    for (const double width : kWidths) {
      explanation = {};
      for (int round = 0; round < kMaxMatchRounds; ++round) {
        MatchExplanation next = Explain(views_, pose, options_.cap, width * size_);
        const bool unchanged = round > 0 && SamePairings(next, explanation);
        explanation = std::move(next);
        if (unchanged) break;
        const std::optional<Rigid3d> fitted = Fit(explanation, width * size_);
        if (!fitted) return std::nullopt;
        pose = *fitted;
      }
    }
    return explanation;
  }

  // Better by more than rounding, so that the earlier of equal starts is kept.
  bool IsBetter(const MatchExplanation& a, const MatchExplanation& b) const {
    return a.cost < b.cost - noticeable_ * static_cast<double>(a.taken.size());
  }

  bool IsSame(const Rigid3d& a, const Rigid3d& b) const {
    return RotationDistance(a.rotation, b.rotation) < kSameAngle_rad &&
           (a * center_ - b * center_).norm() < kSameShift * size_;
  }

 private:
  // All views, or an evenly spread subset of them: 512 starts in 10,000 views would take minutes.
  void ChooseScored() {
    constexpr std::size_t kMaxScoredPairings = 8192;
    const std::size_t step = (pairings_ - 1) / kMaxScoredPairings + 1;
    for (std::size_t i = 0; i < views_.size(); i += step) scored_.push_back(views_[i]);
  }

  std::optional<Rigid3d> Fit(const MatchExplanation& explanation, double width_m) const {
    Points in_b;
    Points in_a;
    std::vector<double> weights;
    for (const TakenPairing& taken : explanation.taken) {
      if (!taken.fits) continue;
      const ObjectPairing& pairing = views_[taken.view].pairings[taken.pairing];
      in_b.insert(in_b.end(), pairing.points_in_b.begin(), pairing.points_in_b.end());
      in_a.insert(in_a.end(), pairing.points_in_a.begin(), pairing.points_in_a.end());
      weights.resize(in_b.size(), 1.0 / (pairing.sigma_m * pairing.sigma_m + width_m * width_m));
    }
    if (in_b.size() < 3) return std::nullopt;
    const Expected<KabschFit> fit = FitKabsch(in_b, in_a, weights);
    if (!fit) return std::nullopt;
    return fit->b_from_a;
  }

  std::span<const MatchView> views_;
  std::vector<MatchView> scored_;  // The views by which starts are ranked.
  const MatchOptions& options_;
  std::size_t pairings_ = 0;
  double noticeable_ = 0.0;
  double size_ = 0.0;  // Mean distance from an object's centroid to its first point.
  Eigen::Vector3d center_ = Eigen::Vector3d::Zero();
};

}  // namespace

MatchExplanation ExplainUnder(std::span<const MatchView> views, const Rigid3d& b_from_a,
                              double cap) {
  return Explain(views, b_from_a, cap, 0.0);
}

Expected<std::vector<MatchExplanation>> MatchObjects(std::span<const MatchView> views,
                                                     const MatchOptions& options) {
  const Matcher matcher(views, options);
  if (matcher.IsEmpty()) {
    return MakeError(ErrorCode::kTooFewPairs,
                     "no object was seen by both sensors at the same time");
  }
  std::vector<MatchExplanation> explanations;
  for (const Rigid3d& start : matcher.Finalists(matcher.Starts())) {
    std::optional<MatchExplanation> found = matcher.Follow(start);
    if (!found) continue;
    const auto same = std::ranges::find_if(explanations, [&](const MatchExplanation& other) {
      return matcher.IsSame(other.b_from_a, found->b_from_a);
    });
    if (same == explanations.end()) {
      explanations.push_back(std::move(*found));
    } else if (matcher.IsBetter(*found, *same)) {
      *same = std::move(*found);
    }
  }
  if (explanations.empty()) {
    return MakeError(ErrorCode::kDegenerate,
                     "no object gives a pose: its points coincide or lie on one line");
  }
  std::size_t best = 0;
  for (std::size_t i = 1; i < explanations.size(); ++i) {
    if (matcher.IsBetter(explanations[i], explanations[best])) best = i;
  }
  std::swap(explanations.front(), explanations[best]);
  std::stable_sort(explanations.begin() + 1, explanations.end(),
                   [](const auto& a, const auto& b) { return a.cost < b.cost; });
  return explanations;
}

}  // namespace sextant
