// SPDX-License-Identifier: Apache-2.0
#include "support/edge_fit.h"

#include <Eigen/QR>
#include <cmath>
#include <cstdint>

namespace sextant::test {
namespace {

// Offset from the chord as a cubic polynomial of the position along it.
struct Cubic {
  Eigen::Vector2d origin;
  Eigen::Vector2d along;
  double length = 0.0;
  Eigen::Vector4d coefficients;

  Eigen::Vector2d Across() const { return {-along.y(), along.x()}; }
  double Offset(double t) const {
    const double s = t / length;
    return coefficients.dot(Eigen::Vector4d(1.0, s, s * s, s * s * s));
  }
  Eigen::Vector2d PointAt(double t) const { return origin + t * along + Offset(t) * Across(); }
  double Miss(const Eigen::Vector2d& point) const {
    const Eigen::Vector2d offset = point - origin;
    return offset.dot(Across()) - Offset(offset.dot(along));
  }
};

Cubic FitCubic(const std::vector<Eigen::Vector2d>& points, const Eigen::Vector2d& from,
               const Eigen::Vector2d& to) {
  Cubic cubic{from, (to - from).normalized(), (to - from).norm(), Eigen::Vector4d::Zero()};
  const auto count = static_cast<Eigen::Index>(points.size());
  Eigen::MatrixXd powers(count, 4);
  Eigen::VectorXd offsets(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Eigen::Vector2d offset = points[static_cast<std::size_t>(i)] - from;
    const double s = offset.dot(cubic.along) / cubic.length;
    powers.row(i) << 1.0, s, s * s, s * s * s;
    offsets[i] = offset.dot(cubic.Across());
  }
  cubic.coefficients = powers.householderQr().solve(offsets);
  return cubic;
}

// Newton's method along `a`, starting at its point nearest to `start`.
Eigen::Vector2d Intersect(const Cubic& a, const Cubic& b, const Eigen::Vector2d& start) {
  constexpr double kStep = 1e-3;
  double t = (start - a.origin).dot(a.along);
  for (int i = 0; i < 20; ++i) {
    const double miss = b.Miss(a.PointAt(t));
    t -= kStep * miss / (b.Miss(a.PointAt(t + kStep)) - miss);
  }
  return a.PointAt(t);
}

}  // namespace

std::vector<Eigen::Vector2d> EdgeCrossings(const cv::Mat& image, const Eigen::Vector2d& from,
                                           const Eigen::Vector2d& to, int half_width_px) {
  constexpr double kMargin = 0.1;
  const bool by_rows = std::abs(to.y() - from.y()) >= std::abs(to.x() - from.x());
  const int down = by_rows ? 1 : 0;  // Coordinate that numbers the lines.
  const Eigen::Vector2d& first = from[down] < to[down] ? from : to;
  const Eigen::Vector2d& last = from[down] < to[down] ? to : from;
  const double span = last[down] - first[down];
  const auto level = [&](int line, int at) {
    return static_cast<double>(by_rows ? image.at<std::uint8_t>(line, at)
                                       : image.at<std::uint8_t>(at, line));
  };
  std::vector<Eigen::Vector2d> crossings;
  const int end = static_cast<int>(std::floor(last[down] - kMargin * span));
  for (int line = static_cast<int>(std::ceil(first[down] + kMargin * span)); line <= end; ++line) {
    const double share = (line - first[down]) / span;
    const double rough = (1.0 - share) * first[1 - down] + share * last[1 - down];
    const int begin = static_cast<int>(std::lround(rough)) - half_width_px;
    const double near = level(line, begin);
    const double far = level(line, begin + 2 * half_width_px);
    double pixels_of_near = 0.0;
    for (int at = begin; at <= begin + 2 * half_width_px; ++at) {
      pixels_of_near += (level(line, at) - far) / (near - far);
    }
    Eigen::Vector2d point;
    point[down] = line;
    point[1 - down] = begin - 0.5 + pixels_of_near;
    crossings.push_back(point);
  }
  return crossings;
}

std::vector<Eigen::Vector2d> FitQuadCorners(const cv::Mat& image,
                                            const std::vector<Eigen::Vector2d>& rough,
                                            int half_width_px) {
  std::vector<Cubic> edges;
  for (std::size_t i = 0; i < 4; ++i) {
    const Eigen::Vector2d& from = rough[i];
    const Eigen::Vector2d& to = rough[(i + 1) % 4];
    edges.push_back(FitCubic(EdgeCrossings(image, from, to, half_width_px), from, to));
  }
  std::vector<Eigen::Vector2d> corners;
  for (std::size_t i = 0; i < 4; ++i) {
    corners.push_back(Intersect(edges[(i + 3) % 4], edges[i], rough[i]));
  }
  return corners;
}

}  // namespace sextant::test
