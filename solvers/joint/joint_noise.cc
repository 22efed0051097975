// SPDX-License-Identifier: Apache-2.0
#include "solvers/joint/joint_noise.h"

#include <algorithm>
#include <cmath>

#include "base/median.h"
#include "solvers/joint/joint_contradiction.h"

namespace sextant {
namespace {

// Median of the absolute value of a standard normal variable.
constexpr double kNormalMedian = 0.6744897501960817;
// Ranges are stated with the offsets of rings in them, which may be most of them.
constexpr double kMinRatio = 0.3;
constexpr double kPriorResiduals = 10.0;
constexpr double kPriorShifts = 4.0;  // Also of the rings, which are as few.

double RatioOf(std::vector<double> values, double expected) {
  for (double& value : values) value = std::abs(value);
  const double ratio = UpperMedian(values) / expected;
  return std::isfinite(ratio) && ratio > 0.0 ? ratio : 1.0;
}

double Updated(double before, const KindSum& sum, double prior, double weight) {
  const double squares = weight * prior * prior + before * before * sum.squares;
  return std::sqrt(squares / (weight + sum.redundancy));
}

}  // namespace

JointNoise MedianNoise(const std::vector<BoardViewResiduals>& residuals, const JointNoise& before) {
  BoardViewResiduals all;
  const auto append = [](const std::vector<double>& from, std::vector<double>& to) {
    to.insert(to.end(), from.begin(), from.end());
  };
  for (const BoardViewResiduals& of : residuals) {
    append(of.printed, all.printed);
    append(of.face, all.face);
    append(of.edges, all.edges);
  }
  JointNoise noise = before;
  // The norm of many residuals is near 1 where their noise is as stated.
  noise.printed = std::max(1.0, RatioOf(std::move(all.printed), 1.0));
  noise.face = std::max(kMinRatio, RatioOf(std::move(all.face), kNormalMedian));
  noise.edges = std::max(1.0, RatioOf(std::move(all.edges), kNormalMedian));
  return noise;
}

JointNoise WithMedianShift(const std::vector<ViewSums>& sums, const JointNoise& before) {
  const double scale = std::sqrt(std::clamp(ContradictionScale(sums), 0.01, 100.0));
  JointNoise noise = before;
  noise.out_of_plane_m *= scale;
  noise.in_plane_m *= scale;
  return noise;
}

JointNoise EstimateNoise(const std::vector<ViewSums>& sums, const KindSum& rings,
                         const JointNoise& before, double shift_m) {
  ViewSums all;
  for (const ViewSums& of : sums) {
    all.printed += of.printed;
    all.face += of.face;
    all.edges += of.edges;
    all.out_of_plane += of.out_of_plane;
    all.in_plane += of.in_plane;
  }
  JointNoise noise{Updated(before.printed, all.printed, 1.0, kPriorResiduals),
                   Updated(before.face, all.face, 1.0, kPriorResiduals),
                   Updated(before.edges, all.edges, 1.0, kPriorResiduals),
                   kNoShift_m,
                   kNoShift_m,
                   Updated(before.rings, rings, 1.0, kPriorShifts)};
  if (shift_m > kNoShift_m) {
    noise.out_of_plane_m = Updated(before.out_of_plane_m, all.out_of_plane, shift_m, kPriorShifts);
    noise.in_plane_m = Updated(before.in_plane_m, all.in_plane, shift_m, kPriorShifts);
  }
  return noise;
}

bool IsSameNoise(const JointNoise& a, const JointNoise& b) {
  constexpr double kSame = 0.01;
  const auto same = [](double x, double y) { return std::abs(x - y) <= kSame * y; };
  return same(a.printed, b.printed) && same(a.face, b.face) && same(a.edges, b.edges) &&
         same(a.out_of_plane_m, b.out_of_plane_m) && same(a.in_plane_m, b.in_plane_m) &&
         same(a.rings, b.rings);
}

}  // namespace sextant
