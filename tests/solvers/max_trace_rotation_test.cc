// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/max_trace_rotation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/random.h"
#include "geometry/so3.h"

namespace sextant {
namespace {

Eigen::Quaterniond RandomRotation(Random& random) {
  Eigen::Vector4d q;
  for (int i = 0; i < 4; ++i) q[i] = random.Normal();
  return Eigen::Quaterniond(q).normalized();
}

// cross = U diag(s) V^T, whose maximiser is V U^T by construction.
struct RotationCase {
  Eigen::Matrix3d cross;
  Eigen::Quaterniond rotation;
};

RotationCase WithSingularValues(const Eigen::Vector3d& s, Random& random) {
  const Eigen::Quaterniond u = RandomRotation(random);
  const Eigen::Quaterniond v = RandomRotation(random);
  return {u.toRotationMatrix() * s.asDiagonal() * v.toRotationMatrix().transpose(),
          v * u.conjugate()};
}

// The error of an eigensolver's eigenvector: about this many roundings over the gap of eigenvalues.
double RotationTolerance(const Eigen::Vector3d& s, double bound) {
  return std::max(2e-12, 50.0 * 2.2e-16 * bound / (s[1] + s[2]));
}

TEST(MaxTraceRotation, FindsTheMaximiserForEverySpectrum) {
  const std::vector<Eigen::Vector3d> spectra = {
      {3, 2, 1},       {1, 1, 1},        {2, 1, 1},        {2, 2, 1},        {1, 1, 0},
      {1, 0.3, 0},     {3, 2, -1},       {1, 1, -0.5},     {1, 0.01, 0},     {1, 1e-3, 0},
      {1, 1e-6, 0},    {1, 1e-3, -5e-4}, {1, 1, -0.999},   {1, 1, 1 - 1e-9}, {1, 0.1, 0.1},
      {1, 1e-4, 1e-4}, {1, 1e-8, 1e-9},  {1, 0.5, -0.4999}};
  Random random(11);
  for (const Eigen::Vector3d& shape : spectra) {
    for (const double slack : {1.0, 1.0001, 1.3, 10.0}) {
      for (const double scale : {1e-12, 1.0, 1e14}) {
        for (int trial = 0; trial < 10; ++trial) {
          const Eigen::Vector3d s = scale * shape;
          const RotationCase expected = WithSingularValues(s, random);
          const double bound = slack * s.sum() + 1e-3 * scale;
          const auto best = MaximizeTrace(expected.cross, bound);
          ASSERT_TRUE(best) << s.transpose() << " slack " << slack;
          EXPECT_LT(RotationDistance(best->rotation, expected.rotation),
                    RotationTolerance(s, bound))
              << s.transpose() << " slack " << slack;
          EXPECT_NEAR(best->rotation.norm(), 1.0, 1e-14);
          EXPECT_NEAR(best->trace, s.sum(), 2e-14 * bound) << s.transpose();
          EXPECT_NEAR(best->mirrored_trace, s[0] + s[1] - s[2], 1e-7 * bound) << s.transpose();
        }
      }
    }
  }
}

TEST(MaxTraceRotation, FindsTheMaximiserOfRandomSpectra) {
  Random random(12);
  for (int trial = 0; trial < 3000; ++trial) {
    Eigen::Vector3d s;
    s[0] = 1.0;
    s[1] = random.Uniform();
    s[2] = s[1] * random.Uniform(-1.0, 1.0);
    const RotationCase expected = WithSingularValues(s, random);
    const double bound = s.sum() * random.Uniform(1.0, 2.0);
    const auto best = MaximizeTrace(expected.cross, bound);
    ASSERT_TRUE(best) << s.transpose();
    EXPECT_LT(RotationDistance(best->rotation, expected.rotation), RotationTolerance(s, bound))
        << s.transpose();
    EXPECT_NEAR(best->trace, s.sum(), 1e-14 * bound);
    EXPECT_NEAR(best->mirrored_trace, s[0] + s[1] - s[2], 1e-7 * bound) << s.transpose();
  }
}

TEST(MaxTraceRotation, RefusesAFreeRotation) {
  Random random(13);
  const std::vector<Eigen::Vector3d> spectra = {
      {0, 0, 0}, {1, 0, 0}, {1, 1e-11, 0}, {1, 1, -1}, {1, 0.5, -0.5}};
  for (const Eigen::Vector3d& s : spectra) {
    const RotationCase undetermined = WithSingularValues(s, random);
    EXPECT_FALSE(MaximizeTrace(undetermined.cross, 1.0 + s.sum())) << s.transpose();
  }
  const double nan = std::nan("");
  EXPECT_FALSE(MaximizeTrace(Eigen::Matrix3d::Constant(nan), nan));
}

}  // namespace
}  // namespace sextant
