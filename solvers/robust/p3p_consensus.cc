// SPDX-License-Identifier: Apache-2.0
#include "solvers/robust/p3p_consensus.h"

#include <algorithm>
#include <limits>
#include <numeric>
#include <optional>
#include <vector>

#include "base/random.h"
#include "solvers/kernels/p3p.h"
#include "solvers/kernels/pixel_sums.h"
#include "solvers/least_squares/normal_step.h"
#include "solvers/robust/consensus.h"

namespace sextant {
namespace {

// After this many degenerate triples and no other, the data itself is degenerate.
constexpr int kMaxDegenerateSamples = 1000;
// Factor of the squared threshold in the first round of least squares, halved in each next one, so
// that a pair just outside is not lost for good.
constexpr double kFirstWidening = 4.0;
constexpr double kLocalStep = 1e-6;
constexpr double kFinalStep = 1e-10;
constexpr int kFinalRounds = 30;
// The minimum number of inliers for least squares.
constexpr int kMinInliers = 4;

class Search {
 public:
  Search(PixelTermsView terms, const Camera& camera, const P3pConsensusOptions& options)
      : camera_(camera), options_(options), random_(options.seed), count_(terms.size()) {
    std::vector<std::size_t> order(count_);
    std::iota(order.begin(), order.end(), std::size_t{0});
    for (std::size_t i = count_; i > 1; --i) std::swap(order[i - 1], order[Below(i)]);
    terms_.reserve(count_);
    rays_.reserve(count_);
    for (const std::size_t i : order) {
      const PixelTerm term = terms[i];
      terms_.push_back(term);
      rays_.push_back(Eigen::Vector3d((term.pixel.x() - camera.cx_px) / camera.fx_px,
                                      (term.pixel.y() - camera.cy_px) / camera.fy_px, 1.0)
                          .normalized());
    }
  }

  void Run() {
    double wanted = options_.max_samples;
    while (samples_ < wanted && (found_ || samples_ < kMaxDegenerateSamples)) {
      DrawBatch();
      drawn_ = std::min(static_cast<int>(kSimdWidth), options_.max_samples - samples_);
      samples_ += drawn_;
      SolveP3pBatch(triples_, candidates_);
      if (!TakeBestCandidate()) continue;
      Optimise(options_.local_rounds, kLocalStep);
      wanted = std::min<double>(options_.max_samples, SamplesForBest());
    }
    if (found_ && options_.local_rounds > 0) Optimise(kFinalRounds, kFinalStep);
  }

  P3pConsensus Answer() const { return {best_, best_cost_, samples_, found_}; }

 private:
  // Avoids a division; the bias is at most 1e-9 of each probability.
  std::size_t Below(std::size_t count) { return ((random_.Bits() >> 32) * count) >> 32; }

  void DrawBatch() {
    for (std::size_t k = 0; k < kSimdWidth; ++k) {
      const std::size_t first = Below(count_);
      std::size_t second = Below(count_ - 1);
      std::size_t third = Below(count_ - 2);
      // Second and third are ranks among the indices not drawn yet.
      if (second >= first) ++second;
      if (third >= std::min(first, second)) ++third;
      if (third >= std::max(first, second)) ++third;
      SetTriple(k, 0, first);
      SetTriple(k, 1, second);
      SetTriple(k, 2, third);
    }
  }

  // Point `to` of triple k becomes term `from`.
  void SetTriple(std::size_t k, std::size_t to, std::size_t from) {
    const PixelTerm term = terms_[from];
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto a = static_cast<Eigen::Index>(axis);
      triples_.rays[3 * to + axis][k] = rays_[from][a];
      triples_.points[3 * to + axis][k] = term.in_lidar[a];
    }
  }

  // Takes the cheapest pose of the batch if it costs less than the best so far, and returns whether
  // it does.
  bool TakeBestCandidate() {
    bool better = false;
    for (std::size_t c = 0; c < kMaxP3pPoses; ++c) {
      for (std::size_t k = 0; k < static_cast<std::size_t>(drawn_); ++k) {
        if (candidates_.exists[c][k] == 0) continue;
        const PinholePose pose(camera_, candidates_, c, k);
        const double cost =
            ScreenedPixelCost(terms_.blocks(), pose, options_.max_squared, best_cost_, screen_);
        if (!(cost < best_cost_)) continue;
        best_cost_ = cost;
        best_ = candidates_.Pose(c, k);
        better = true;
      }
    }
    found_ = found_ || better;
    return better;
  }

  // Alternates one step of least squares on the inliers with choosing them, starting at the best
  // pose. Ends after `rounds`, or with a step that is small or does not lower the cost.
  void Optimise(int rounds, double step_tolerance) {
    Rigid3d pose = best_;
    double widening = kFirstWidening;
    PixelSums sums;
    for (int round = 0; round < rounds; ++round) {
      const int inliers =
          SumPixelsWithin(terms_.View(), PinholePose(camera_, pose),
                          widening * options_.max_squared, options_.max_squared, sums);
      const bool falls = sums.squares <= best_cost_;
      if (falls) {
        best_ = pose;
        best_cost_ = sums.squares;
      }
      if ((widening == 1.0 && !falls) || inliers < kMinInliers) break;
      const std::optional<Vector6d> step = DampedStep(sums.information, sums.gradient, 0.0);
      if (!step || !step->allFinite()) break;
      if (widening == 1.0 && SizeOf(*step, pose) < step_tolerance) break;
      pose = Moved(pose, *step);
      widening = std::max(1.0, 0.5 * widening);
    }
  }

  double SamplesForBest() {
    PixelSums sums;
    const int inliers = SumPixelsWithin(terms_.View(), PinholePose(camera_, best_),
                                        options_.max_squared, options_.max_squared, sums);
    screen_ = PixelScreen(static_cast<double>(inliers) / static_cast<double>(count_));
    return WantedSamples(count_, static_cast<std::size_t>(inliers), 3, options_.confidence);
  }

  const Camera& camera_;
  const P3pConsensusOptions& options_;
  Random random_;
  std::size_t count_;
  PixelTerms terms_;  // In random order.
  std::vector<Eigen::Vector3d> rays_;
  P3pTriples triples_;
  P3pPoses candidates_;
  PixelScreen screen_;
  Rigid3d best_;
  double best_cost_ = std::numeric_limits<double>::infinity();
  int samples_ = 0;
  int drawn_ = 0;  // Triples used of this batch: fewer than eight in the last one.
  bool found_ = false;
};

}  // namespace

P3pConsensus FindP3pConsensus(PixelTermsView terms, const Camera& camera,
                              const P3pConsensusOptions& options) {
  Search search(terms, camera, options);
  search.Run();
  return search.Answer();
}

}  // namespace sextant
