// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/cloud_sums.h"

#include <algorithm>

#include "base/simd.h"

namespace sextant {
namespace {

// Eight points, coordinate by coordinate; `beyond` stands for points beyond the last.
template <std::size_t kSize>
struct Coordinates {
  Vec8d of[kSize];
};

template <std::size_t kSize>
SEXTANT_INLINE Coordinates<kSize> LoadFull(const double* from) {
  Coordinates<kSize> out;
  for (std::size_t axis = 0; axis < kSize; ++axis) {
    const double* p = from + axis;
    out.of[axis] = Vec8d{p[0],         p[kSize],     p[2 * kSize], p[3 * kSize],
                         p[4 * kSize], p[5 * kSize], p[6 * kSize], p[7 * kSize]};
  }
  return out;
}

template <std::size_t kSize>
SEXTANT_INLINE Coordinates<kSize> LoadCoordinates(const double* data, std::size_t at,
                                                  std::size_t count, const double* beyond) {
  if (at + kSimdWidth <= count) return LoadFull<kSize>(data + kSize * at);
  double rest[kSize * kSimdWidth];
  const std::size_t left = count - at;
  for (std::size_t i = 0; i < kSimdWidth; ++i) {
    const double* from = i < left ? data + kSize * (at + i) : beyond;
    for (std::size_t axis = 0; axis < kSize; ++axis) rest[kSize * i + axis] = from[axis];
  }
  return LoadFull<kSize>(rest);
}

constexpr double kZero[3] = {};

template <std::size_t kSize>
SEXTANT_INLINE void SumCoordinates(const double* data, std::size_t count, double (&sums)[kSize]) {
  Vec8d vectors[kSize] = {};
  for (std::size_t at = 0; at < count; at += kSimdWidth) {
    const Coordinates<kSize> c = LoadCoordinates<kSize>(data, at, count, kZero);
    for (std::size_t axis = 0; axis < kSize; ++axis) vectors[axis] += c.of[axis];
  }
  for (std::size_t axis = 0; axis < kSize; ++axis) sums[axis] = HorizontalSum(vectors[axis]);
}

SEXTANT_MULTIVERSION
void SumOf2(const double* data, std::size_t count, double (&sums)[2]) {
  SumCoordinates<2>(data, count, sums);
}

SEXTANT_MULTIVERSION
void SumOf3(const double* data, std::size_t count, double (&sums)[3]) {
  SumCoordinates<3>(data, count, sums);
}

// Points beyond the last are at the centre and add nothing.
SEXTANT_MULTIVERSION
void SumOuter(const double* data, std::size_t count, const double (&centre)[3], double (&sums)[6]) {
  Vec8d vectors[6] = {};
  for (std::size_t at = 0; at < count; at += kSimdWidth) {
    const Coordinates<3> p = LoadCoordinates<3>(data, at, count, centre);
    const Vec8d x = p.of[0] - centre[0];
    const Vec8d y = p.of[1] - centre[1];
    const Vec8d z = p.of[2] - centre[2];
    vectors[0] += x * x;
    vectors[1] += x * y;
    vectors[2] += x * z;
    vectors[3] += y * y;
    vectors[4] += y * z;
    vectors[5] += z * z;
  }
  for (int i = 0; i < 6; ++i) sums[i] = HorizontalSum(vectors[i]);
}

struct MomentFrame {
  double mean[2];
  double centroid[3];
  double axes[9];  // Column by column.
};

SEXTANT_MULTIVERSION
void AddMoments(const double* image, const double* points, std::size_t count,
                const MomentFrame& frame, MomentSums& sums) {
  Vec8d u_sums[10] = {};
  Vec8d v_sums[10] = {};
  Vec8d w_sums[10] = {};
  for (std::size_t at = 0; at < count; at += kSimdWidth) {
    const Coordinates<2> uv = LoadCoordinates<2>(image, at, count, frame.mean);
    const Coordinates<3> p = LoadCoordinates<3>(points, at, count, frame.centroid);
    const Vec8d u = uv.of[0] - frame.mean[0];
    const Vec8d v = uv.of[1] - frame.mean[1];
    const Vec8d w = u * u + v * v;
    Vec8d offset[3];
    for (int axis = 0; axis < 3; ++axis) offset[axis] = p.of[axis] - frame.centroid[axis];
    Vec8d h[3];
    for (int axis = 0; axis < 3; ++axis) {
      const double* a = frame.axes + 3 * axis;
      h[axis] = a[0] * offset[0] + a[1] * offset[1] + a[2] * offset[2];
    }
    u_sums[0] += u;
    v_sums[0] += v;
    w_sums[0] += w;
    for (int k = 0; k < 3; ++k) {
      u_sums[1 + k] += u * h[k];
      v_sums[1 + k] += v * h[k];
      w_sums[1 + k] += w * h[k];
    }
    int entry = 4;
    for (int j = 0; j < 3; ++j) {
      for (int k = j; k < 3; ++k, ++entry) {
        const Vec8d product = h[j] * h[k];
        u_sums[entry] += u * product;
        v_sums[entry] += v * product;
        w_sums[entry] += w * product;
      }
    }
  }
  for (std::size_t i = 0; i < 10; ++i) {
    sums.u[i] = HorizontalSum(u_sums[i]);
    sums.v[i] = HorizontalSum(v_sums[i]);
    sums.w[i] = HorizontalSum(w_sums[i]);
  }
}

struct FitPose {
  double r[9];  // Column by column.
  double t[3];
};

SEXTANT_MULTIVERSION
void AddFit(const double* image, const double* points, std::size_t count, const FitPose& pose,
            double (&sums)[2]) {
  const double* r = pose.r;
  Vec8d squares = {};
  Vec8d in_front = {};
  for (std::size_t at = 0; at < count; at += kSimdWidth) {
    // Beyond the last point the first is loaded and gets no weight.
    const Coordinates<2> uv = LoadCoordinates<2>(image, at, count, image);
    const Coordinates<3> p = LoadCoordinates<3>(points, at, count, points);
    const Vec8d x = r[0] * p.of[0] + r[3] * p.of[1] + r[6] * p.of[2] + pose.t[0];
    const Vec8d y = r[1] * p.of[0] + r[4] * p.of[1] + r[7] * p.of[2] + pose.t[1];
    const Vec8d z = r[2] * p.of[0] + r[5] * p.of[1] + r[8] * p.of[2] + pose.t[2];
    const Vec8d inverse = 1.0 / (z > 0.0 ? z : BroadcastVec(1.0));
    const Vec8d du = x * inverse - uv.of[0];
    const Vec8d dv = y * inverse - uv.of[1];
    Vec8d given;
    for (std::size_t i = 0; i < kSimdWidth; ++i) given[i] = at + i < count ? 1.0 : 0.0;
    const Vec8d weight = z > 0.0 ? given : Vec8d{};
    squares += weight * (du * du + dv * dv);
    in_front += weight;
  }
  sums[0] = HorizontalSum(squares);
  sums[1] = HorizontalSum(in_front);
}

}  // namespace

Eigen::Vector2d MeanOf(std::span<const Eigen::Vector2d> image_points) {
  double sums[2];
  SumOf2(image_points.front().data(), image_points.size(), sums);
  return Eigen::Vector2d(sums[0], sums[1]) / static_cast<double>(image_points.size());
}

Eigen::Vector3d MeanOf(std::span<const Eigen::Vector3d> points) {
  double sums[3];
  SumOf3(points.front().data(), points.size(), sums);
  return Eigen::Vector3d(sums[0], sums[1], sums[2]) / static_cast<double>(points.size());
}

Eigen::Matrix3d ScatterAbout(const Eigen::Vector3d& centre,
                             std::span<const Eigen::Vector3d> points) {
  double s[6];
  SumOuter(points.front().data(), points.size(), {centre.x(), centre.y(), centre.z()}, s);
  Eigen::Matrix3d scatter;
  scatter << s[0], s[1], s[2], s[1], s[3], s[4], s[2], s[4], s[5];
  return scatter / static_cast<double>(points.size());
}

MomentSums SumMoments(std::span<const Eigen::Vector2d> image_points, const Eigen::Vector2d& mean,
                      std::span<const Eigen::Vector3d> points, const Eigen::Vector3d& centroid,
                      const Eigen::Matrix3d& axes) {
  MomentFrame frame = {{mean.x(), mean.y()}, {centroid.x(), centroid.y(), centroid.z()}, {}};
  std::copy_n(axes.data(), 9, frame.axes);
  MomentSums sums;
  AddMoments(image_points.front().data(), points.front().data(), points.size(), frame, sums);
  return sums;
}

ImageFit FitOf(std::span<const Eigen::Vector2d> image_points,
               std::span<const Eigen::Vector3d> points, const Eigen::Matrix3d& rotation,
               const Eigen::Vector3d& translation) {
  FitPose pose;
  std::copy_n(rotation.data(), 9, pose.r);
  std::copy_n(translation.data(), 3, pose.t);
  double sums[2];
  AddFit(image_points.front().data(), points.front().data(), points.size(), pose, sums);
  return {.behind = points.size() - static_cast<std::size_t>(sums[1]), .sum_squares = sums[0]};
}

}  // namespace sextant
