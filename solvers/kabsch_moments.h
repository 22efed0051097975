// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "solvers/horn_matrix.h"
#include "solvers/pair_lanes.h"
#include "solvers/pair_noise.h"

namespace sextant {

/// The sums that every least squares of 3D-3D pairs begins with, over one problem with its points
/// in lanes, or over eight problems side by side.

template <class Real>
struct SymmetricMatrix {
  Real xx, yy, zz, xy, xz, yz;
};

/// About provisional origins.
template <class Real>
struct PairMomentSums {
  Real weight, squares;
  Point3<Real> a, b;
  CrossMatrix<Real> cross;
  SymmetricMatrix<Real> scatter;  ///< sum w a a^T, where asked for.

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

template <bool kWeighted, bool kScatter>
SEXTANT_INLINE PairMomentSums<double> SumOf(const PairMomentSums<Lanes>& s) {
  const CrossMatrix<Lanes>& m = s.cross;
  const Lanes first = SumEach(s.squares, s.a.x, s.a.y, s.a.z, s.b.x, s.b.y, s.b.z, m.xx);
  const Lanes second = SumEach(m.xy, m.xz, m.yx, m.yy, m.yz, m.zx, m.zy, m.zz);
  PairMomentSums<double> sum{};
  if constexpr (kWeighted) sum.weight = SumLanes(s.weight);
  sum.squares = first[0];
  sum.a = {first[1], first[2], first[3]};
  sum.b = {first[4], first[5], first[6]};
  sum.cross = {first[7],  second[0], second[1], second[2], second[3],
               second[4], second[5], second[6], second[7]};
  if constexpr (kScatter) {
    sum.scatter = {SumLanes(s.scatter.xx), SumLanes(s.scatter.yy), SumLanes(s.scatter.zz),
                   SumLanes(s.scatter.xy), SumLanes(s.scatter.xz), SumLanes(s.scatter.yz)};
  }
  return sum;
}

/// About the weighted means; the means themselves about the provisional origins.
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

/// Points and weights as the caller holds them.
struct PointSpans {
  SEXTANT_INLINE std::size_t size() const { return in_a.size(); }
  SEXTANT_INLINE Point3<double> a(std::size_t i) const { return PointAt(in_a[i]); }
  SEXTANT_INLINE Point3<double> b(std::size_t i) const { return PointAt(in_b[i]); }
  SEXTANT_INLINE double weight(std::size_t i) const { return weights[i]; }
  SEXTANT_INLINE Point3<Lanes> EightOfA(std::size_t i, const Point3<double>& origin) const {
    return LoadPoints(in_a[i].data(), origin);
  }
  SEXTANT_INLINE Point3<Lanes> EightOfB(std::size_t i, const Point3<double>& origin) const {
    return LoadPoints(in_b[i].data(), origin);
  }
  SEXTANT_INLINE Lanes EightWeights(std::size_t i) const {
    const Lanes w = LoadLanes(weights.data() + i);
    return __builtin_shufflevector(w, w, 0, 3, 6, 1, 4, 7, 2, 5);
  }
  SEXTANT_INLINE LaneMask order() const { return kPointOrder; }

  std::span<const Eigen::Vector3d> in_b;
  std::span<const Eigen::Vector3d> in_a;
  std::span<const double> weights;
};

/// Pairs, weighed by IsotropicWeight.
struct WeighedPairs {
  SEXTANT_INLINE std::size_t size() const { return pairs.size(); }
  SEXTANT_INLINE Point3<double> a(std::size_t i) const { return PointAt(pairs[i].point_in_lidar); }
  SEXTANT_INLINE Point3<double> b(std::size_t i) const { return PointAt(pairs[i].point_in_cam); }
  SEXTANT_INLINE double weight(std::size_t i) const { return IsotropicWeight(pairs[i]); }
  SEXTANT_INLINE Point3<Lanes> EightOfA(std::size_t i, const Point3<double>& origin) const {
    return Gather(&pairs[i], &Pair3d3d::point_in_lidar) - origin;
  }
  SEXTANT_INLINE Point3<Lanes> EightOfB(std::size_t i, const Point3<double>& origin) const {
    return Gather(&pairs[i], &Pair3d3d::point_in_cam) - origin;
  }
  SEXTANT_INLINE Lanes EightWeights(std::size_t i) const {
    return Lanes{weight(i),     weight(i + 1), weight(i + 2), weight(i + 3),
                 weight(i + 4), weight(i + 5), weight(i + 6), weight(i + 7)};
  }
  SEXTANT_INLINE LaneMask order() const { return LaneMask{0, 1, 2, 3, 4, 5, 6, 7}; }

  std::span<const Pair3d3d> pairs;
};

/// Moments of all points; weight is their number where unweighted. The first point as provisional
/// origin keeps the digits of small sets far from the sensor.
template <bool kWeighted, bool kScatter, class Points>
SEXTANT_INLINE CentredMoments<double> ComputeMoments(const Points& points) {
  const Point3<double> origin_a = points.a(0);
  const Point3<double> origin_b = points.b(0);
  const std::size_t count = points.size();
  PairMomentSums<double> sums{};
  if (count < kLanes) {
    for (std::size_t i = 0; i < count; ++i) {
      sums.Add<kWeighted, kScatter>(points.a(i) - origin_a, points.b(i) - origin_b,
                                    kWeighted ? points.weight(i) : 1.0);
    }
  } else {
    PairMomentSums<Lanes> eight{};
    std::size_t i = 0;
    for (; i + kLanes <= count; i += kLanes) {
      Lanes weight{};
      if constexpr (kWeighted) weight = points.EightWeights(i);
      eight.Add<kWeighted, kScatter>(points.EightOfA(i, origin_a), points.EightOfB(i, origin_b),
                                     weight);
    }
    if (i < count) {
      // The last eight once more; those counted already stand at the origins, without weight.
      const std::size_t last = count - kLanes;
      const LaneMask is_new = points.order() >= static_cast<long long>(i - last);
      const Point3<Lanes> a = points.EightOfA(last, origin_a);
      const Point3<Lanes> b = points.EightOfB(last, origin_b);
      const Lanes none{};
      Lanes weight{};
      if constexpr (kWeighted) weight = is_new ? points.EightWeights(last) : none;
      eight.Add<kWeighted, kScatter>(
          {is_new ? a.x : none, is_new ? a.y : none, is_new ? a.z : none},
          {is_new ? b.x : none, is_new ? b.y : none, is_new ? b.z : none}, weight);
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
