// SPDX-License-Identifier: Apache-2.0
#include "solvers/robust/triple_source.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>

#include "base/random.h"
#include "geometry/camera.h"
#include "solvers/kernels/kabsch_fit.h"
#include "solvers/kernels/p3p.h"

namespace sextant {
namespace {

// With these samples and 70 percent of outliers one sample has none with probability 0.9997.
constexpr int kMinPixelSamples = 300;
// Residuals computed at most, and the number of samples that is always allowed.
constexpr double kMaxPixelWork = 2e7;
constexpr int kMaxPixelSamples = 10'000;
constexpr int kMinOfMaxPixelSamples = 1000;
constexpr int kMaxPointSamples = 1 << 18;
constexpr int kPointBatch = 1024;
// Triples tried of the first batch and of the others. The best agree because they are true.
constexpr std::size_t kFirstTried = 32;
constexpr std::size_t kTried = 8;

// Appends the poses of `inner` on all pairs, if it works on these.
void AddPosesOfAll(const CalibrationProblem& problem, PairKind kind, const Solver& inner,
                   std::vector<Rigid3d>& poses) {
  const DataNeeds& needs = inner.spec().needs;
  const bool points = kind == PairKind::k3d3d;
  if ((points ? needs.pairs_3d3d : needs.pairs_2d3d) == 0) return;
  std::vector<int> all(points ? problem.pairs_3d3d.size() : problem.pairs_2d3d.size());
  std::iota(all.begin(), all.end(), 0);
  inner.Hypothesize(problem, all, poses);
}

/// Any inner solver, on as few pairs as it needs.
class InnerSource final : public TripleSource {
 public:
  InnerSource(const CalibrationProblem& problem, PairKind kind, const Solver& inner,
              std::uint64_t seed)
      : TripleSource(kMinPixelSamples, kMinOfMaxPixelSamples),
        problem_(problem),
        kind_(kind),
        inner_(inner),
        random_(seed),
        count_(kind == PairKind::k3d3d ? problem.pairs_3d3d.size() : problem.pairs_2d3d.size()) {
    const DataNeeds& needs = inner.spec().needs;
    sample_.resize(static_cast<std::size_t>(std::max(needs.pairs_3d3d, needs.pairs_2d3d)));
  }

  void Next(std::vector<Rigid3d>& poses) override {
    if (samples() == 0) AddPosesOfAll(problem_, kind_, inner_, poses);
    random_.Sample(static_cast<int>(count_), sample_);
    inner_.Hypothesize(problem_, sample_, poses);
    Count(1);
  }

 private:
  const CalibrationProblem& problem_;
  PairKind kind_;
  const Solver& inner_;
  Random random_;
  std::size_t count_;
  std::vector<int> sample_;
};

/// P3P on triples of pixels of any camera.
class PixelTripleSource final : public TripleSource {
 public:
  PixelTripleSource(const CalibrationProblem& problem, const Solver& inner, std::uint64_t seed)
      : TripleSource(kMinPixelSamples, MaxSamples(problem.pairs_2d3d.size())),
        problem_(problem),
        inner_(inner),
        random_(seed) {
    for (const Pair2d3d& pair : problem.pairs_2d3d) {
      const std::optional<Eigen::Vector3d> ray = Unproject(*problem.camera, pair.pixel);
      if (!ray) continue;
      rays_.push_back(ray->normalized());
      points_.push_back(pair.point_in_lidar);
    }
  }

  void Next(std::vector<Rigid3d>& poses) override {
    if (samples() == 0) AddPosesOfAll(problem_, PairKind::k2d3d, inner_, poses);
    Count(1);
    if (rays_.size() < sample_.size()) return;
    random_.Sample(static_cast<int>(rays_.size()), sample_);
    std::array<Eigen::Vector3d, 3> rays;
    std::array<Eigen::Vector3d, 3> points;
    for (std::size_t i = 0; i < sample_.size(); ++i) {
      rays[i] = rays_[static_cast<std::size_t>(sample_[i])];
      points[i] = points_[static_cast<std::size_t>(sample_[i])];
    }
    std::array<Rigid3d, kMaxP3pPoses> found;
    const int count = SolveP3p(rays, points, found);
    poses.insert(poses.end(), found.begin(), found.begin() + count);
  }

 private:
  static int MaxSamples(std::size_t pairs) {
    const double affordable = kMaxPixelWork / static_cast<double>(pairs);
    return static_cast<int>(
        std::clamp<double>(affordable, kMinOfMaxPixelSamples, kMaxPixelSamples));
  }

  const CalibrationProblem& problem_;
  const Solver& inner_;
  Random random_;
  std::vector<Eigen::Vector3d> rays_;
  std::vector<Eigen::Vector3d> points_;
  std::array<int, 3> sample_{};
};

/// Kabsch on the triples of a batch whose lengths agree best.
class PointTripleSource final : public TripleSource {
 public:
  PointTripleSource(const CalibrationProblem& problem, const Solver& inner, std::uint64_t seed)
      : TripleSource(kPointBatch, kMaxPointSamples),
        problem_(problem),
        inner_(inner),
        random_(seed) {}

  void Next(std::vector<Rigid3d>& poses) override {
    const bool is_first = samples() == 0;
    if (is_first) AddPosesOfAll(problem_, PairKind::k3d3d, inner_, poses);
    batch_.clear();
    for (int i = 0; i < kPointBatch; ++i) Draw();
    Count(kPointBatch);
    const std::size_t tried = std::min(is_first ? kFirstTried : kTried, batch_.size());
    const auto end = batch_.begin() + static_cast<std::ptrdiff_t>(tried);
    std::partial_sort(batch_.begin(), end, batch_.end(), [](const Triple& a, const Triple& b) {
      return a.disagreement < b.disagreement;
    });
    for (auto triple = batch_.begin(); triple != end; ++triple) AddPose(*triple, poses);
  }

 private:
  struct Triple {
    double disagreement;  // The largest difference of a length between the frames.
    std::array<int, 3> pairs;
  };

  void Draw() {
    Triple triple{};
    random_.Sample(static_cast<int>(problem_.pairs_3d3d.size()), triple.pairs);
    const auto pair = [&](std::size_t k) -> const Pair3d3d& {
      return problem_.pairs_3d3d[static_cast<std::size_t>(triple.pairs[k])];
    };
    for (std::size_t k = 0; k < 3; ++k) {
      const Pair3d3d& a = pair(k);
      const Pair3d3d& b = pair((k + 1) % 3);
      const double difference =
          (a.point_in_cam - b.point_in_cam).norm() - (a.point_in_lidar - b.point_in_lidar).norm();
      triple.disagreement = std::max(triple.disagreement, std::abs(difference));
    }
    batch_.push_back(triple);
  }

  void AddPose(const Triple& triple, std::vector<Rigid3d>& poses) const {
    std::array<Eigen::Vector3d, 3> in_cam;
    std::array<Eigen::Vector3d, 3> in_lidar;
    for (std::size_t k = 0; k < 3; ++k) {
      const Pair3d3d& pair = problem_.pairs_3d3d[static_cast<std::size_t>(triple.pairs[k])];
      in_cam[k] = pair.point_in_cam;
      in_lidar[k] = pair.point_in_lidar;
    }
    constexpr std::array<double, 3> kEqual = {1.0, 1.0, 1.0};
    const KabschOutcome fit = FitPoints(in_cam, in_lidar, kEqual);
    if (fit) poses.push_back(fit->b_from_a);
  }

  const CalibrationProblem& problem_;
  const Solver& inner_;
  Random random_;
  std::vector<Triple> batch_;
};

}  // namespace

std::unique_ptr<TripleSource> MakeTripleSource(const CalibrationProblem& problem, PairKind kind,
                                               const Solver& inner, std::uint64_t seed) {
  if (!inner.spec().estimates_rotation) {
    return std::make_unique<InnerSource>(problem, kind, inner, seed);
  }
  if (kind == PairKind::k3d3d) return std::make_unique<PointTripleSource>(problem, inner, seed);
  return std::make_unique<PixelTripleSource>(problem, inner, seed);
}

}  // namespace sextant
