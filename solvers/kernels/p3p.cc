// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/p3p.h"

#include <Eigen/Geometry>

#include "solvers/kernels/p3p_core.h"

namespace sextant {
namespace {

using p3p::Vec4d;
using p3p::Vector;

// The candidates of one triple, one in each column.
struct Candidates {
  double rotation[9][kMaxP3pPoses];
  double translation[3][kMaxP3pPoses];
  double depth[kMaxP3pPoses];  // Not positive where the candidate is no pose.
};

SEXTANT_INLINE Vec4d Packed(const double (&a)[4]) { return Vec4d{a[0], a[1], a[2], a[3]}; }

SEXTANT_MULTIVERSION
void FindCandidates(const double* rays, const double* points, Candidates& out) {
  const Vector<double> y[3] = {
      {rays[0], rays[1], rays[2]}, {rays[3], rays[4], rays[5]}, {rays[6], rays[7], rays[8]}};
  const Vector<double> p[3] = {{points[0], points[1], points[2]},
                               {points[3], points[4], points[5]},
                               {points[6], points[7], points[8]}};
  const p3p::Prepared<double> from = p3p::Prepare(y, p);
  double ratio_x[4];
  double ratio_y[4];
  p3p::FindRatios(from.triangle, ratio_x, ratio_y);
  Vector<Vec4d> d;
  Vec4d depth = p3p::Polish(from.triangle, Packed(ratio_x), Packed(ratio_y), d);
  if (!(from.squared_height > p3p::kMinSquaredHeight)) depth = Vec4d{} - 1.0;
  Vec4d r[9];
  Vec4d t[3];
  p3p::PoseAt(from, d, r, t);
  std::memcpy(out.rotation, r, sizeof r);
  std::memcpy(out.translation, t, sizeof t);
  std::memcpy(out.depth, &depth, sizeof depth);
}

SEXTANT_INLINE void LoadVectors(const double (&from)[9][kSimdWidth], Vector<Vec8d> (&to)[3]) {
  for (int i = 0; i < 3; ++i) {
    to[i] = {LoadVec(from[3 * i]), LoadVec(from[3 * i + 1]), LoadVec(from[3 * i + 2])};
  }
}

// A separate function: clang makes no versions of SolveP3pBatch, which was declared before.
SEXTANT_MULTIVERSION
void SolveEight(const P3pTriples& triples, P3pPoses& poses) {
  Vector<Vec8d> y[3];
  Vector<Vec8d> p[3];
  LoadVectors(triples.rays, y);
  LoadVectors(triples.points, p);
  const p3p::Prepared<Vec8d> from = p3p::Prepare(y, p);
  Vec8d ratio_x[4];
  Vec8d ratio_y[4];
  p3p::FindRatios(from.triangle, ratio_x, ratio_y);
  for (std::size_t c = 0; c < kMaxP3pPoses; ++c) {
    Vector<Vec8d> d;
    Vec8d depth = p3p::Polish(from.triangle, ratio_x[c], ratio_y[c], d);
    depth = p3p::Select(from.squared_height > p3p::kMinSquaredHeight, depth, Vec8d{});
    const Mask8 exists = depth > 0.0;
    std::memcpy(poses.exists[c], &exists, sizeof exists);
    if (!p3p::Any(exists)) continue;
    Vec8d r[9];
    Vec8d t[3];
    p3p::PoseAt(from, d, r, t);
    for (int k = 0; k < 9; ++k) StoreVec(r[k], poses.rotation[c][k]);
    for (int k = 0; k < 3; ++k) StoreVec(t[k], poses.translation[c][k]);
  }
}

}  // namespace

int SolveP3p(std::span<const Eigen::Vector3d, 3> rays_in_cam,
             std::span<const Eigen::Vector3d, 3> points_in_lidar,
             std::span<Rigid3d, kMaxP3pPoses> poses) {
  Candidates found;
  FindCandidates(rays_in_cam[0].data(), points_in_lidar[0].data(), found);
  std::size_t count = 0;
  for (std::size_t c = 0; c < kMaxP3pPoses; ++c) {
    if (!(found.depth[c] > 0.0)) continue;
    Eigen::Matrix3d rotation;
    for (int k = 0; k < 9; ++k) rotation(k / 3, k % 3) = found.rotation[k][c];
    Rigid3d& pose = poses[count++];
    pose.rotation = Eigen::Quaterniond(rotation).normalized();
    for (int k = 0; k < 3; ++k) pose.translation[k] = found.translation[k][c];
  }
  return static_cast<int>(count);
}

void SolveP3pBatch(const P3pTriples& triples, P3pPoses& poses) { SolveEight(triples, poses); }

Rigid3d P3pPoses::Pose(std::size_t candidate, std::size_t triple) const {
  Eigen::Matrix3d matrix;
  for (int k = 0; k < 9; ++k) matrix(k / 3, k % 3) = rotation[candidate][k][triple];
  Rigid3d pose;
  pose.rotation = Eigen::Quaterniond(matrix).normalized();
  for (int k = 0; k < 3; ++k) pose.translation[k] = translation[candidate][k][triple];
  return pose;
}

}  // namespace sextant
