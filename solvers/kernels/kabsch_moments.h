// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "geometry/pair_noise.h"
#include "solvers/kernels/horn_matrix.h"
#include "solvers/kernels/pair_simd.h"

namespace sextant {

/// The sums that every least-squares fit of 3D-3D pairs starts from, eight pairs at a time.

template <class Real>
struct SymmetricMatrix {
  Real xx, yy, zz, xy, xz, yz;
};

/// Sums relative to provisional origins.
template <class Real>
struct PairMomentSums {
  Real weight, squares;
  Point3<Real> a, b;
  CrossMatrix<Real> cross;
  SymmetricMatrix<Real> scatter;  ///< sum w a a^T, only where kScatter is set.

  template <bool kWeighted, bool kScatter>
  SEXTANT_INLINE void Add(const Point3<Real>& pa, const Point3<Real>& pb, const Real& w) {
    const Point3<Real> wa = kWeighted ? Point3<Real>{w * pa.x, w * pa.y, w * pa.z} : pa;
    const Real b_squares = pb.x * pb.x + pb.y * pb.y + pb.z * pb.z;
    const Real xx = wa.x * pa.x;
    const Real yy = wa.y * pa.y;
    const Real zz = wa.z * pa.z;
    if constexpr (kWeighted) weight += w;
    squares += (xx + yy + zz) + (kWeighted ? w * b_squares : b_squares);
    a.x += wa.x, a.y += wa.y, a.z += wa.z;
    if constexpr (kWeighted) {
      b.x += w * pb.x, b.y += w * pb.y, b.z += w * pb.z;
    } else {
      b.x += pb.x, b.y += pb.y, b.z += pb.z;
    }
    cross.xx += wa.x * pb.x, cross.xy += wa.x * pb.y, cross.xz += wa.x * pb.z;
    cross.yx += wa.y * pb.x, cross.yy += wa.y * pb.y, cross.yz += wa.y * pb.z;
    cross.zx += wa.z * pb.x, cross.zy += wa.z * pb.y, cross.zz += wa.z * pb.z;
    if constexpr (kScatter) {
      scatter.xx += xx, scatter.yy += yy, scatter.zz += zz;
      scatter.xy += wa.x * pa.y, scatter.xz += wa.x * pa.z, scatter.yz += wa.y * pa.z;
    }
  }
};

template <bool kWeighted, bool kScatter, class V>
SEXTANT_INLINE PairMomentSums<double> SumOf(const PairMomentSums<V>& s) {
  const CrossMatrix<V>& m = s.cross;
  const V first = SumEach(s.squares, s.a.x, s.a.y, s.a.z, s.b.x, s.b.y, s.b.z, m.xx);
  const V second = SumEach(m.xy, m.xz, m.yx, m.yy, m.yz, m.zx, m.zy, m.zz);
  PairMomentSums<double> sum{};
  if constexpr (kWeighted) sum.weight = HorizontalSum(s.weight);
  sum.squares = first[0];
  sum.a = {first[1], first[2], first[3]};
  sum.b = {first[4], first[5], first[6]};
  sum.cross = {first[7],  second[0], second[1], second[2], second[3],
               second[4], second[5], second[6], second[7]};
  if constexpr (kScatter) {
    sum.scatter = {HorizontalSum(s.scatter.xx), HorizontalSum(s.scatter.yy),
                   HorizontalSum(s.scatter.zz), HorizontalSum(s.scatter.xy),
                   HorizontalSum(s.scatter.xz), HorizontalSum(s.scatter.yz)};
  }
  return sum;
}

/// Moments about the weighted means. The means are relative to the provisional origins.
template <class Real>
struct CentredMoments {
  Real weight, squares;  ///< squares: sum w (|a|^2 + |b|^2).
  Point3<Real> mean_a, mean_b;
  CrossMatrix<Real> cross;        ///< sum w a b^T.
  SymmetricMatrix<Real> scatter;  ///< sum w a a^T.
};

template <bool kScatter, class Real>
SEXTANT_INLINE CentredMoments<Real> Centre(const PairMomentSums<Real>& s, const Real& weight) {
  const Real inverse = 1.0 / weight;
  const Point3<Real> ma = {s.a.x * inverse, s.a.y * inverse, s.a.z * inverse};
  const Point3<Real> mb = {s.b.x * inverse, s.b.y * inverse, s.b.z * inverse};
  CentredMoments<Real> m{};
  m.weight = weight;
  m.mean_a = ma;
  m.mean_b = mb;
  m.cross = {s.cross.xx - ma.x * s.b.x, s.cross.xy - ma.x * s.b.y, s.cross.xz - ma.x * s.b.z,
             s.cross.yx - ma.y * s.b.x, s.cross.yy - ma.y * s.b.y, s.cross.yz - ma.y * s.b.z,
             s.cross.zx - ma.z * s.b.x, s.cross.zy - ma.z * s.b.y, s.cross.zz - ma.z * s.b.z};
  m.squares = s.squares - (ma.x * s.a.x + ma.y * s.a.y + ma.z * s.a.z) -
              (mb.x * s.b.x + mb.y * s.b.y + mb.z * s.b.z);
  if constexpr (kScatter) {
    m.scatter = {s.scatter.xx - ma.x * s.a.x, s.scatter.yy - ma.y * s.a.y,
                 s.scatter.zz - ma.z * s.a.z, s.scatter.xy - ma.x * s.a.y,
                 s.scatter.xz - ma.x * s.a.z, s.scatter.yz - ma.y * s.a.z};
  }
  return m;
}

/// Points and weights in separate arrays.
struct PointSpans {
  SEXTANT_INLINE std::size_t size() const { return in_a.size(); }
  SEXTANT_INLINE Point3<double> a(std::size_t i) const { return PointAt(in_a[i]); }
  SEXTANT_INLINE Point3<double> b(std::size_t i) const { return PointAt(in_b[i]); }
  SEXTANT_INLINE double weight(std::size_t i) const { return weights[i]; }
  SEXTANT_INLINE std::size_t place(std::size_t k) const { return kPointOrder[k]; }

  std::span<const Eigen::Vector3d> in_b;
  std::span<const Eigen::Vector3d> in_a;
  std::span<const double> weights;
};

/// Pairs with the weights IsotropicWeight.
struct WeightedPoints {
  SEXTANT_INLINE std::size_t size() const { return pairs.size(); }
  SEXTANT_INLINE Point3<double> a(std::size_t i) const { return PointAt(pairs[i].point_in_lidar); }
  SEXTANT_INLINE Point3<double> b(std::size_t i) const { return PointAt(pairs[i].point_in_cam); }
  SEXTANT_INLINE double weight(std::size_t i) const { return IsotropicWeight(pairs[i]); }
  SEXTANT_INLINE std::size_t place(std::size_t k) const { return k; }

  std::span<const Pair3d3d> pairs;
};

/// Points relative to an origin, eight at a time from the i-th on, in the order of `place`.
template <class V>
struct SeenFromOrigin {
  SEXTANT_INLINE SeenFromOrigin(std::span<const Eigen::Vector3d> all, const Point3<double>& o)
      : points(all), origin(o) {}
  SEXTANT_INLINE Point3<V> Eight(std::size_t i) const {
    return LoadPoints<V>(points[i].data(), origin);
  }

  std::span<const Eigen::Vector3d> points;
  RepeatedPoint<V> origin;
};

/// The points of pairs in one frame, relative to an origin.
template <class V, Eigen::Vector3d Pair3d3d::*kPoint>
struct PairsFromOrigin {
  SEXTANT_INLINE Point3<V> Eight(std::size_t i) const {
    return Gather<V>(&pairs[i], kPoint) - origin;
  }

  std::span<const Pair3d3d> pairs;
  Point3<double> origin;
};

template <class V>
SEXTANT_INLINE auto FromOriginOfA(const PointSpans& points, const Point3<double>& o) {
  return SeenFromOrigin<V>(points.in_a, o);
}
template <class V>
SEXTANT_INLINE auto FromOriginOfB(const PointSpans& points, const Point3<double>& o) {
  return SeenFromOrigin<V>(points.in_b, o);
}
template <class V>
SEXTANT_INLINE auto FromOriginOfA(const WeightedPoints& points, const Point3<double>& o) {
  return PairsFromOrigin<V, &Pair3d3d::point_in_lidar>{points.pairs, o};
}
template <class V>
SEXTANT_INLINE auto FromOriginOfB(const WeightedPoints& points, const Point3<double>& o) {
  return PairsFromOrigin<V, &Pair3d3d::point_in_cam>{points.pairs, o};
}

/// The weights of eight points, in the order of `place`.
template <class V, class Points>
SEXTANT_INLINE V EightWeights(const Points& points, std::size_t i) {
  const auto w = [&](std::size_t k) __attribute__((always_inline)) {
    return points.weight(i + points.place(k));
  };
  return VecOf<V>(w(0), w(1), w(2), w(3), w(4), w(5), w(6), w(7));
}

/// Which of the eight are the `place`-th or later.
template <class V, class Points>
SEXTANT_INLINE auto PlacesFrom(const Points& points, std::size_t place) {
  const auto at = [&](std::size_t k) __attribute__((always_inline)) {
    return static_cast<long long>(points.place(k));
  };
  return VecOf<MaskOf<V>>(at(0), at(1), at(2), at(3), at(4), at(5), at(6), at(7)) >=
         static_cast<long long>(place);
}

/// Moments of all points; the weight is their number where they have none. The first point as
/// provisional origin preserves precision for small sets far from the sensor.
template <class V, bool kWeighted, bool kScatter, class Points>
SEXTANT_INLINE CentredMoments<double> ComputeMoments(const Points& points) {
  const Point3<double> origin_a = points.a(0);
  const Point3<double> origin_b = points.b(0);
  const std::size_t count = points.size();
  PairMomentSums<double> sums{};
  if (count < kSimdWidth) {
    for (std::size_t i = 0; i < count; ++i) {
      sums.Add<kWeighted, kScatter>(points.a(i) - origin_a, points.b(i) - origin_b,
                                    kWeighted ? points.weight(i) : 1.0);
    }
  } else {
    const auto all_a = FromOriginOfA<V>(points, origin_a);
    const auto all_b = FromOriginOfB<V>(points, origin_b);
    PairMomentSums<V> eight{};
    std::size_t i = 0;
    for (; i + kSimdWidth <= count; i += kSimdWidth) {
      V weight{};
      if constexpr (kWeighted) weight = EightWeights<V>(points, i);
      eight.template Add<kWeighted, kScatter>(all_a.Eight(i), all_b.Eight(i), weight);
    }
    if (i < count) {
      // The last eight again; those that were counted already are set to zero.
      const std::size_t last = count - kSimdWidth;
      const auto is_new = PlacesFrom<V>(points, i - last);
      const Point3<V> a = all_a.Eight(last);
      const Point3<V> b = all_b.Eight(last);
      const V none{};
      V weight{};
      if constexpr (kWeighted) weight = Select(is_new, EightWeights<V>(points, last), none);
      eight.template Add<kWeighted, kScatter>(
          {Select(is_new, a.x, none), Select(is_new, a.y, none), Select(is_new, a.z, none)},
          {Select(is_new, b.x, none), Select(is_new, b.y, none), Select(is_new, b.z, none)},
          weight);
    }
    sums = SumOf<kWeighted, kScatter>(eight);
  }
  CentredMoments<double> m =
      Centre<kScatter>(sums, kWeighted ? sums.weight : static_cast<double>(count));
  m.mean_a = {m.mean_a.x + origin_a.x, m.mean_a.y + origin_a.y, m.mean_a.z + origin_a.z};
  m.mean_b = {m.mean_b.x + origin_b.x, m.mean_b.y + origin_b.y, m.mean_b.z + origin_b.z};
  return m;
}

}  // namespace sextant
