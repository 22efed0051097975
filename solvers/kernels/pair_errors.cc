// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/pair_errors.h"

#include <cmath>

#include "solvers/kernels/pair_simd.h"

namespace sextant {
namespace {

template <class Real>
SEXTANT_INLINE Real SquaredResidual(const RotationMatrix<double>& r, const Point3<double>& t,
                                    const Point3<Real>& in_lidar, const Point3<Real>& in_cam) {
  const Real x = in_cam.x - (r.xx * in_lidar.x + r.xy * in_lidar.y + r.xz * in_lidar.z + t.x);
  const Real y = in_cam.y - (r.yx * in_lidar.x + r.yy * in_lidar.y + r.yz * in_lidar.z + t.y);
  const Real z = in_cam.z - (r.zx * in_lidar.x + r.zy * in_lidar.y + r.zz * in_lidar.z + t.z);
  return x * x + y * y + z * z;
}

// Eight pairs at a time, then one.
SEXTANT_MULTIVERSION PairErrors Measure(std::span<const Pair3d3d> pairs,
                                        const RotationMatrix<double>& r, const Point3<double>& t,
                                        double* distances_m) {
  Vec8d squares_m2{};
  Vec8d squares{};
  std::size_t i = 0;
  for (; i + kSimdWidth <= pairs.size(); i += kSimdWidth) {
    const Pair3d3d* p = &pairs[i];
    const Vec8d squared = SquaredResidual(r, t, Gather<Vec8d>(p, &Pair3d3d::point_in_lidar),
                                          Gather<Vec8d>(p, &Pair3d3d::point_in_cam));
    StoreVec(Sqrt(squared), distances_m + i);
    const Vec8d sigma = {p[0].sigma_m, p[1].sigma_m, p[2].sigma_m, p[3].sigma_m,
                         p[4].sigma_m, p[5].sigma_m, p[6].sigma_m, p[7].sigma_m};
    squares_m2 += squared;
    squares += sigma > 0.0 ? squared / (sigma * sigma) : squared;
  }
  PairErrors errors = {HorizontalSum(squares_m2), HorizontalSum(squares)};
  for (; i < pairs.size(); ++i) {
    const double squared =
        SquaredResidual(r, t, PointAt(pairs[i].point_in_lidar), PointAt(pairs[i].point_in_cam));
    const double sigma = pairs[i].sigma_m;
    distances_m[i] = std::sqrt(squared);
    errors.squares_m2 += squared;
    errors.squares += squared * (sigma > 0.0 ? 1.0 / (sigma * sigma) : 1.0);
  }
  return errors;
}

}  // namespace

PairErrors MeasurePairs(std::span<const Pair3d3d> pairs, const Rigid3d& cam_from_lidar,
                        std::span<double> distances_m) {
  const Eigen::Quaterniond& q = cam_from_lidar.rotation;
  return Measure(pairs, MakeRotationMatrix(Vector4<double>{q.x(), q.y(), q.z(), q.w()}),
                 PointAt(cam_from_lidar.translation), distances_m.data());
}

}  // namespace sextant
