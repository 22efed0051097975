// SPDX-License-Identifier: Apache-2.0
#include "calibrate/observe/dark_returns.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <vector>

namespace sextant {
namespace {

constexpr std::size_t kMinReturns = 40;
constexpr double kMinClassShare = 0.1;
constexpr double kMinSeparation = 4.0;
constexpr double kPrior_m = 0.015;
constexpr double kSignificantExcess = 3.0;

struct IntensityClasses {
  double dark = 0.0;
  double bright = 0.0;

  double DarknessOf(double intensity) const {
    return std::clamp((bright - intensity) / (bright - dark), 0.0, 1.0);
  }
};

// The division with the least variance within the classes.
std::optional<IntensityClasses> ClassesOf(std::span<const float> intensity) {
  std::vector<double> sorted(intensity.begin(), intensity.end());
  std::ranges::sort(sorted);
  const auto n = static_cast<double>(sorted.size());
  double total = 0.0;
  double squares = 0.0;
  for (const double value : sorted) {
    total += value;
    squares += value * value;
  }
  double best = -1.0;
  double below = 0.0;
  IntensityClasses classes;
  for (std::size_t i = 1; i < sorted.size(); ++i) {
    below += sorted[i - 1];
    const auto k = static_cast<double>(i);
    if (k < kMinClassShare * n || n - k < kMinClassShare * n) continue;
    const double dark = below / k;
    const double bright = (total - below) / (n - k);
    const double between = k * (n - k) / (n * n) * (bright - dark) * (bright - dark);
    if (between <= best) continue;
    best = between;
    classes = {dark, bright};
  }
  const double within = squares / n - std::pow(total / n, 2) - best;
  const double apart = classes.bright - classes.dark;
  if (best <= 0.0 || apart * apart < kMinSeparation * kMinSeparation * within) return std::nullopt;
  return classes;
}

// Range beyond the plane.
double BeyondPlane(const Eigen::Vector3d& point, const LidarPlane& plane) {
  const Eigen::Vector3d offset = point - plane.origin;
  return plane.normal.dot(offset) / plane.normal.dot(point.normalized());
}

/// Sums over the returns of one ring for the regression of the range on darkness, the offset and
/// the slope along the ring eliminated.
class RingRegression {
 public:
  void Add(double along, double darkness, double range) {
    const Eigen::Vector4d row(1.0, along, darkness, range);
    sums_ += row * row.transpose();
  }

  // Remaining products of darkness and range; zero where all returns are alike.
  Eigen::Matrix2d Remaining() const {
    const Eigen::Matrix2d own = sums_.topLeftCorner<2, 2>();
    const double determinant = own.determinant();
    if (!(determinant > 1e-12 * own(0, 0) * own(0, 0))) return Eigen::Matrix2d::Zero();
    const Eigen::Matrix2d mixed = sums_.topRightCorner<2, 2>();
    Eigen::Matrix2d adjugate;
    adjugate << own(1, 1), -own(0, 1), -own(1, 0), own(0, 0);
    return sums_.bottomRightCorner<2, 2>() - mixed.transpose() * adjugate * mixed / determinant;
  }

 private:
  Eigen::Matrix4d sums_ = Eigen::Matrix4d::Zero();
};

// The products over all rings.
Eigen::Matrix2d ProductsOf(std::span<const double> darkness, const LidarPlane& plane,
                           const FaceOfBoard& face) {
  std::map<int, RingRegression> rings;
  const Eigen::Vector3d along = Eigen::Vector3d::UnitZ().cross(plane.origin).normalized();
  for (std::size_t i = 0; i < face.in_lidar.size(); ++i) {
    const Eigen::Vector3d& point = face.in_lidar[i];
    rings[face.rings.empty() ? -1 : face.rings[i]].Add(along.dot(point - plane.origin), darkness[i],
                                                       BeyondPlane(point, plane));
  }
  Eigen::Matrix2d products = Eigen::Matrix2d::Zero();
  for (const auto& [number, ring] : rings) products += ring.Remaining();
  return products;
}

}  // namespace

double CorrectDarkReturns(std::span<const float> intensity, const LidarPlane& plane,
                          FaceOfBoard& face) {
  const std::size_t count = face.in_lidar.size();
  if (count < kMinReturns || intensity.size() != count) return 0.0;
  const std::optional<IntensityClasses> classes = ClassesOf(intensity);
  if (!classes) return 0.0;
  std::vector<double> darkness;
  for (const double value : intensity) darkness.push_back(classes->DarknessOf(value));
  const Eigen::Matrix2d products = ProductsOf(darkness, plane, face);
  const double variance = products(1, 1) / static_cast<double>(count);
  const double information = products(0, 0) + variance / (kPrior_m * kPrior_m);
  if (!(products(0, 0) > 0.0)) return 0.0;
  const double excess = products(0, 1) / information;
  if (excess * excess * information < kSignificantExcess * kSignificantExcess * variance) {
    return 0.0;
  }
  for (std::size_t i = 0; i < count; ++i) {
    Eigen::Vector3d& point = face.in_lidar[i];
    point -= excess * darkness[i] * point.normalized();
  }
  return excess;
}

}  // namespace sextant
