// SPDX-License-Identifier: Apache-2.0
#include "geometry/distortion.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

#include "geometry/lens.h"
#include "geometry/positive_polynomial.h"

namespace sextant {
namespace {

// No lens magnifies its border ten times as much as its centre.
constexpr double kMaxRationalSlope = 10.0;

struct RadialTerms {
  Polynomial<4> numerator;
  Polynomial<4> denominator;
};

RadialTerms BrownTerms(const Camera& camera) {
  const auto& k = camera.distortion;
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
  // Close to a pole, where D falls to 0 before N does, the image runs away.
  Polynomial<7> below_limit{};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) below_limit[i + j] += kMaxRationalSlope * d[i] * d[j];
  }
  for (std::size_t i = 0; i < 7; ++i) below_limit[i] -= slope[i];
  return IsPositiveUpTo(d, s) && IsPositiveUpTo(slope, s) && IsPositiveUpTo(below_limit, s);
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

void AddPrism(const Camera& camera, const Eigen::Vector2d& m, Distorted& image) {
  const double* prism = camera.distortion.data() + 8;
  const double s = m.squaredNorm();
  const Eigen::Vector2d by_square(prism[0] + 2.0 * s * prism[1], prism[2] + 2.0 * s * prism[3]);
  image.point += Eigen::Vector2d(s * (prism[0] + s * prism[1]), s * (prism[2] + s * prism[3]));
  image.by_undistorted += 2.0 * by_square * m.transpose();
}

void Tilt(const Camera& camera, Distorted& image) {
  const Eigen::Matrix3d h = TiltHomography(camera.distortion[12], camera.distortion[13]);
  const Eigen::Vector3d tilted = h * image.point.homogeneous();
  image.point = tilted.hnormalized();
  const Eigen::Matrix2d by_point =
      (h.topLeftCorner<2, 2>() - image.point * h.bottomLeftCorner<1, 2>()) / tilted.z();
  image.by_undistorted = by_point * image.by_undistorted;
  // A point that the tilt puts behind the sensor has no image.
  if (!(tilted.z() > 0.0)) image.by_undistorted.setZero();
}

bool HasPrism(const Camera& camera) {
  const auto& k = camera.distortion;
  return k[8] != 0.0 || k[9] != 0.0 || k[10] != 0.0 || k[11] != 0.0;
}

bool IsTilted(const Camera& camera) {
  return camera.distortion[12] != 0.0 || camera.distortion[13] != 0.0;
}

}  // namespace

Eigen::Matrix3d TiltHomography(double tau_x, double tau_y) {
  Eigen::Matrix3d about_x;
  Eigen::Matrix3d about_y;
  about_x << 1.0, 0.0, 0.0, 0.0, std::cos(tau_x), std::sin(tau_x), 0.0, -std::sin(tau_x),
      std::cos(tau_x);
  about_y << std::cos(tau_y), 0.0, -std::sin(tau_y), 0.0, 1.0, 0.0, std::sin(tau_y), 0.0,
      std::cos(tau_y);
  const Eigen::Matrix3d r = about_y * about_x;
  Eigen::Matrix3d onto_sensor = Eigen::Matrix3d::Identity();
  onto_sensor(0, 0) = onto_sensor(1, 1) = r(2, 2);
  onto_sensor(0, 2) = -r(0, 2);
  onto_sensor(1, 2) = -r(1, 2);
  return onto_sensor * r;
}

std::optional<Distorted> DistortPlane(const Camera& camera, const Eigen::Vector2d& undistorted) {
  const double x = undistorted.x();
  const double y = undistorted.y();
  const double s = undistorted.squaredNorm();
  const auto radial = BrownFactor(camera, s);
  if (!radial) return std::nullopt;
  const double p1 = camera.distortion[2];
  const double p2 = camera.distortion[3];

  Distorted result;
  result.point = radial->value * undistorted;
  result.point.x() += 2.0 * p1 * x * y + p2 * (s + 2.0 * x * x);
  result.point.y() += p1 * (s + 2.0 * y * y) + 2.0 * p2 * x * y;
  const double stretch = 2.0 * radial->by_square;
  const double mixed = stretch * x * y + 2.0 * (p1 * x + p2 * y);
  result.by_undistorted << radial->value + stretch * x * x + 2.0 * p1 * y + 6.0 * p2 * x, mixed,
      mixed, radial->value + stretch * y * y + 6.0 * p1 * y + 2.0 * p2 * x;
  if (HasPrism(camera)) AddPrism(camera, undistorted, result);
  if (IsTilted(camera)) Tilt(camera, result);
  if (!(result.by_undistorted.determinant() > 0.0)) return std::nullopt;
  return result;
}

// Newton's method with step halving. The image of the domain is star-shaped about the axis, so
// from there each step can reduce the residual, unless the target lies outside.
std::optional<Eigen::Vector2d> UndistortPlane(const Camera& camera,
                                              const Eigen::Vector2d& distorted) {
  constexpr int kMaxSteps = 100;
  constexpr double kMinFraction = 1e-6;
  constexpr double kLastStep = 1e-9;
  Eigen::Vector2d guess = distorted;
  std::optional<Distorted> image = DistortPlane(camera, guess);
  if (!image) {
    guess.setZero();
    image = DistortPlane(camera, guess);
  }
  const double rounding = 1e-15 * (1.0 + distorted.norm());
  for (int step = 0; step < kMaxSteps && image; ++step) {
    const Eigen::Vector2d residual = distorted - image->point;
    if (residual.norm() <= rounding) return guess;
    const Eigen::Vector2d full = image->by_undistorted.inverse() * residual;
    // Newton's method squares its error: the next step would be rounding.
    if (full.norm() < kLastStep) return DistortPlane(camera, guess + full) ? guess + full : guess;
    double fraction = 1.0;
    std::optional<Distorted> next;
    // NOLINTNEXTLINE(clang-analyzer-security.FloatLoopCounter): halved exactly.
    for (; fraction > kMinFraction; fraction *= 0.5) {
      next = DistortPlane(camera, guess + fraction * full);
      if (next && (distorted - next->point).norm() < residual.norm()) break;
    }
    if (fraction <= kMinFraction) {
      // The residual is rounding, or the step ends at the border of the domain.
      return residual.norm() <= 1e3 * rounding ? std::optional(guess) : std::nullopt;
    }
    guess += fraction * full;
    image = next;
  }
  return std::nullopt;
}

std::optional<Distorted> Distort(const Camera& camera, const Eigen::Vector2d& undistorted) {
  if (camera.model == CameraModel::kPinhole) {
    return Distorted{undistorted, Eigen::Matrix2d::Identity()};
  }
  if (camera.model == CameraModel::kBrownConrady) return DistortPlane(camera, undistorted);
  const std::optional<LensImage> image = ProjectThroughLens(camera, undistorted.homogeneous());
  if (!image) return std::nullopt;
  return Distorted{image->point, image->by_point.leftCols<2>()};
}

bool PlaneGrowsUpTo(const Camera& camera, double radius) {
  return BrownGrowsUpTo(BrownTerms(camera), radius * radius);
}

bool HasNoPoleUpTo(const Camera& camera, double radius) {
  return IsPositiveUpTo(BrownTerms(camera).denominator, radius * radius);
}

}  // namespace sextant
