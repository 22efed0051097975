// SPDX-License-Identifier: Apache-2.0
#include "geometry/distortion.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

namespace sextant {
namespace {

// Coefficients from the constant up.
template <std::size_t kTerms>
using Polynomial = std::array<double, kTerms>;

template <std::size_t kTerms>
double Value(const Polynomial<kTerms>& p, double x) {
  double sum = 0.0;
  for (std::size_t i = kTerms; i-- > 0;) sum = sum * x + p[i];
  return sum;
}

template <std::size_t kTerms>
double Slope(const Polynomial<kTerms>& p, double x) {
  double sum = 0.0;
  for (std::size_t i = kTerms; i-- > 1;) sum = sum * x + static_cast<double>(i) * p[i];
  return sum;
}

// A polynomial lies between the smallest and the largest of its Bernstein coefficients, which
// converge to it as the interval is halved. Undecided after 30 halvings means that it touches zero.
constexpr int kMaxHalvings = 30;

template <std::size_t kTerms>
bool IsPositiveByHalving(Polynomial<kTerms> bernstein, int halvings) {
  if (!(bernstein.front() > 0.0 && bernstein.back() > 0.0)) return false;
  if (*std::min_element(bernstein.begin(), bernstein.end()) > 0.0) return true;
  if (halvings == 0) return false;
  Polynomial<kTerms> left;
  for (std::size_t level = 0; level < kTerms; ++level) {
    left[level] = bernstein[0];
    for (std::size_t i = 0; i + level + 1 < kTerms; ++i) {
      bernstein[i] = 0.5 * (bernstein[i] + bernstein[i + 1]);
    }
  }
  return IsPositiveByHalving(left, halvings - 1) && IsPositiveByHalving(bernstein, halvings - 1);
}

// Whether p > 0 on all of [0, end]. Allocates nothing and needs no root search, so that the
// domain of a camera is checked without a cache besides its coefficients.
template <std::size_t kTerms>
bool IsPositiveUpTo(const Polynomial<kTerms>& p, double end) {
  Polynomial<kTerms> scaled;
  double power = 1.0;
  double lower_bound = p[0];
  for (std::size_t i = 0; i < kTerms; ++i) {
    scaled[i] = p[i] * power;
    if (i > 0) lower_bound += std::min(0.0, scaled[i]);
    power *= end;
  }
  if (lower_bound > 0.0) return true;
  // Bernstein coefficient i is sum_j C(i, j) / C(degree, j) scaled_j.
  Polynomial<kTerms> bernstein{};
  for (std::size_t i = 0; i < kTerms; ++i) {
    double ratio = 1.0;
    for (std::size_t j = 0; j <= i; ++j) {
      bernstein[i] += ratio * scaled[j];
      if (j < i) ratio *= static_cast<double>(i - j) / static_cast<double>(kTerms - 1 - j);
    }
  }
  return IsPositiveByHalving(bernstein, kMaxHalvings);
}

struct RadialTerms {
  Polynomial<4> numerator;
  Polynomial<4> denominator;
};

RadialTerms BrownTerms(const Camera& camera) {
  const std::array<double, 8>& k = camera.distortion;
  return {{1.0, k[0], k[1], k[4]}, {1.0, k[5], k[6], k[7]}};
}

// The image's radius r N / D grows where (N + 2 s N') D - 2 s N D' > 0, provided D has no root.
bool BrownGrowsUpTo(const RadialTerms& terms, double s) {
  const auto& [n, d] = terms;
  const Polynomial<4> grown = {1.0, 3.0 * n[1], 5.0 * n[2], 7.0 * n[3]};
  if (d[1] == 0.0 && d[2] == 0.0 && d[3] == 0.0) return IsPositiveUpTo(grown, s);
  Polynomial<7> slope{};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) {
      slope[i + j] += (grown[i] - 2.0 * static_cast<double>(j) * n[i]) * d[j];
    }
  }
  return IsPositiveUpTo(d, s) && IsPositiveUpTo(slope, s);
}

Polynomial<5> EquidistantTerms(const Camera& camera) {
  const std::array<double, 8>& k = camera.distortion;
  return {1.0, k[0], k[1], k[2], k[3]};
}

bool EquidistantGrowsUpTo(const Polynomial<5>& p, double theta) {
  const Polynomial<5> slope = {1.0, 3.0 * p[1], 5.0 * p[2], 7.0 * p[3], 9.0 * p[4]};
  return IsPositiveUpTo(slope, theta * theta);
}

// c and dc/ds of the header.
struct RadialFactor {
  double value = 1.0;
  double by_square = 0.0;
};

std::optional<RadialFactor> BrownFactor(const Camera& camera, double s) {
  const RadialTerms terms = BrownTerms(camera);
  if (!BrownGrowsUpTo(terms, s)) return std::nullopt;
  const double inverse = 1.0 / Value(terms.denominator, s);
  const double c = Value(terms.numerator, s) * inverse;
  return RadialFactor{c, (Slope(terms.numerator, s) - c * Slope(terms.denominator, s)) * inverse};
}

std::optional<RadialFactor> EquidistantFactor(const Camera& camera, double s) {
  // Here the next term of the series is under 1e-16.
  constexpr double kOnAxis = 1e-16;
  if (s < kOnAxis) return RadialFactor{1.0, camera.distortion[0] - 1.0 / 3.0};
  const double r = std::sqrt(s);
  const std::optional<DistortedAngle> theta = DistortAngle(camera, std::atan(r));
  if (!theta) return std::nullopt;
  const double c = theta->value / r;
  return RadialFactor{c, 0.5 * (theta->slope / (1.0 + s) - c) / s};
}

}  // namespace

std::optional<Distorted> Distort(const Camera& camera, const Eigen::Vector2d& undistorted) {
  if (camera.model == CameraModel::kPinhole) {
    return Distorted{undistorted, Eigen::Matrix2d::Identity()};
  }
  const double x = undistorted.x();
  const double y = undistorted.y();
  const double s = undistorted.squaredNorm();
  const bool is_brown = camera.model == CameraModel::kBrownConrady;
  const auto radial = is_brown ? BrownFactor(camera, s) : EquidistantFactor(camera, s);
  if (!radial) return std::nullopt;
  const double p1 = is_brown ? camera.distortion[2] : 0.0;
  const double p2 = is_brown ? camera.distortion[3] : 0.0;

  Distorted result;
  result.point = radial->value * undistorted;
  result.point.x() += 2.0 * p1 * x * y + p2 * (s + 2.0 * x * x);
  result.point.y() += p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y;
  const double stretch = 2.0 * radial->by_square;
  const double mixed = stretch * x * y + 2.0 * (p1 * x + p2 * y);
  result.by_undistorted << radial->value + stretch * x * x + 2.0 * p1 * y + 6.0 * p2 * x, mixed,
      mixed, radial->value + stretch * y * y + 6.0 * p1 * y + 2.0 * p2 * x;
  if (!(result.by_undistorted.determinant() > 0.0)) return std::nullopt;
  return result;
}

std::optional<DistortedAngle> DistortAngle(const Camera& equidistant, double theta) {
  const Polynomial<5> terms = EquidistantTerms(equidistant);
  if (!EquidistantGrowsUpTo(terms, theta)) return std::nullopt;
  const double squared = theta * theta;
  const double factor = Value(terms, squared);
  return DistortedAngle{theta * factor, factor + 2.0 * squared * Slope(terms, squared)};
}

bool GrowsUpTo(const Camera& camera, double radius) {
  switch (camera.model) {
    case CameraModel::kPinhole:
      return true;
    case CameraModel::kBrownConrady:
      return BrownGrowsUpTo(BrownTerms(camera), radius * radius);
    case CameraModel::kEquidistant:
      return EquidistantGrowsUpTo(EquidistantTerms(camera), radius);
  }
  return false;
}

}  // namespace sextant
