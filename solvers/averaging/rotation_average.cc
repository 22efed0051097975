// SPDX-License-Identifier: Apache-2.0
#include "solvers/averaging/rotation_average.h"

#include <fmt/core.h>

#include <cmath>

#include "geometry/symmetric.h"

namespace sextant {
namespace {

// Quaternions are rounded to 1e-16; below this an eigenvalue gap or a cosine is only rounding.
constexpr double kAngleRounding = 1e-12;

tl::unexpected<Error> NothingToAverage() {
  return MakeError(ErrorCode::kMissingData, "no rotations to average");
}

// Adds `q` to `sum` with the sign that is nearer to `reference`; false where both are equally near.
bool AddAligned(const Eigen::Vector4d& q, const Eigen::Vector4d& reference, Eigen::Vector4d& sum) {
  const double cosine = q.dot(reference);
  if (!(std::abs(cosine) > kAngleRounding)) return false;
  sum += cosine > 0.0 ? q : Eigen::Vector4d(-q);
  return true;
}

tl::unexpected<Error> HalfATurn(std::size_t i, const char* from) {
  return MakeError(ErrorCode::kDegenerate,
                   fmt::format("rotation {} is half a turn from {}, which leaves their average "
                               "undetermined; average rotations that are near each other",
                               i + 1, from));
}

}  // namespace

Expected<Eigen::Quaterniond> ChordalMean(std::span<const Eigen::Quaterniond> rotations) {
  if (rotations.empty()) return NothingToAverage();
  Eigen::Matrix4d sum = Eigen::Matrix4d::Zero();
  for (const Eigen::Quaterniond& q : rotations) sum += q.coeffs() * q.coeffs().transpose();
  const SymmetricEigen<4> eigen = EigenOf(sum);
  const double gap = eigen.values(3) - eigen.values(2);
  if (!(gap > kAngleRounding * static_cast<double>(rotations.size()))) {
    return MakeError(ErrorCode::kDegenerate,
                     fmt::format("the {} rotations are spread so evenly that two or more rotations "
                                 "are equally good means; average rotations that are near each "
                                 "other",
                                 rotations.size()));
  }
  return Eigen::Quaterniond(eigen.vectors.col(3)).normalized();
}

Expected<Eigen::Quaterniond> QuaternionSumMean(std::span<const Eigen::Quaterniond> rotations) {
  if (rotations.empty()) return NothingToAverage();
  const Eigen::Vector4d first = rotations[0].coeffs();
  Eigen::Vector4d sum = first;
  for (std::size_t i = 1; i < rotations.size(); ++i) {
    if (!AddAligned(rotations[i].coeffs(), first, sum)) return HalfATurn(i, "the first");
  }
  return Eigen::Quaterniond(sum).normalized();
}

Expected<Eigen::Quaterniond> OriginalRunningAverage(std::span<const Eigen::Quaterniond> rotations) {
  if (rotations.empty()) return NothingToAverage();
  Eigen::Vector4d running = rotations[0].coeffs();
  for (std::size_t i = 1; i < rotations.size(); ++i) {
    const Eigen::Vector4d before = running;
    if (!AddAligned(rotations[i].coeffs(), before, running)) {
      return HalfATurn(i, "the running average");
    }
    running.normalize();
  }
  return Eigen::Quaterniond(running).normalized();
}

Eigen::Quaterniond RecoverOriginalRotation(const Eigen::Quaterniond& before,
                                           const Eigen::Quaterniond& after) {
  const double cosine = before.dot(after);
  return Eigen::Quaterniond(Eigen::Vector4d(2.0 * cosine * after.coeffs() - before.coeffs()))
      .normalized();
}

}  // namespace sextant
