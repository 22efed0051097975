// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/scans/scan_match.h"

#include <Eigen/Geometry>

namespace sextant {
namespace {

constexpr double kMinCosine = 0.85;  ///< Angle between the normals of a match.
constexpr double kEndOfWeights2 = 9.0;
constexpr double kCellsOfAPlane = 9.0;
/// Added to the known variance of a match, in noise variances: planes are not quite flat.
constexpr double kUnknownShare = 0.1;

// A pose with its rotation as a matrix.
struct Motion {
  explicit Motion(const Rigid3d& b_from_a)
      : rotation(b_from_a.rotation.toRotationMatrix()), translation(b_from_a.translation) {}

  SEXTANT_INLINE std::array<Vec8d, 3> Rotated(const std::array<Vec8d, 3>& v) const {
    std::array<Vec8d, 3> rotated;
    for (int k = 0; k < 3; ++k) {
      rotated[static_cast<std::size_t>(k)] =
          rotation(k, 0) * v[0] + rotation(k, 1) * v[1] + rotation(k, 2) * v[2];
    }
    return rotated;
  }
  SEXTANT_INLINE std::array<Vec8d, 3> Moved(const std::array<Vec8d, 3>& p) const {
    std::array<Vec8d, 3> moved = Rotated(p);
    for (int k = 0; k < 3; ++k) moved[static_cast<std::size_t>(k)] += translation[k];
    return moved;
  }

  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
};

using Triple = std::array<std::vector<double>, 3>;

SEXTANT_INLINE std::array<Vec8d, 3> Load(const Triple& from, std::size_t at) {
  return {LoadVec(from[0].data() + at), LoadVec(from[1].data() + at), LoadVec(from[2].data() + at)};
}

SEXTANT_INLINE Vec8d Dot(const std::array<Vec8d, 3>& a, const std::array<Vec8d, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

SEXTANT_INLINE std::array<Vec8d, 3> Cross(const std::array<Vec8d, 3>& a,
                                          const std::array<Vec8d, 3>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

struct Planes {
  std::array<Vec8d, 3> normal;
  Vec8d distance;
  Vec8d variance;
  std::array<Vec8d, 6> inverse;
};

SEXTANT_INLINE Planes Gather(const std::vector<ScanPlane>& planes, const std::int32_t* which) {
  Planes gathered;
  for (std::size_t i = 0; i < kSimdWidth; ++i) {
    const ScanPlane& plane = planes[static_cast<std::size_t>(which[i])];
    for (std::size_t k = 0; k < 3; ++k) gathered.normal[k][i] = plane.normal[k];
    gathered.distance[i] = plane.distance;
    gathered.variance[i] = plane.variance_m2;
    for (std::size_t k = 0; k < 6; ++k) gathered.inverse[k][i] = plane.inverse_moments[k];
  }
  return gathered;
}

// The variances of the planes at q, divided by the noise of one return.
SEXTANT_INLINE Vec8d PlaneVariance(const std::array<Vec8d, 6>& i, const std::array<Vec8d, 3>& q) {
  return i[0] * q[0] * q[0] + i[3] * q[1] * q[1] + i[5] * q[2] * q[2] +
         2.0 * (i[1] * q[0] * q[1] + i[2] * q[0] * q[2] + i[4] * q[1] * q[2]);
}

SEXTANT_MULTIVERSION
void MatchAll(const ScanSurfaces& target, const ScanSurfaces::Patches& patches,
              const Motion& motion, std::int32_t* plane_of) {
  const std::int32_t none = target.no_plane();
  for (std::size_t i = 0; i < patches.inverse_count.size(); i += kSimdWidth) {
    const std::array<Vec8d, 3> normals = motion.Rotated(Load(patches.normal, i));
    target.cells().CellsOf(motion.Moved(Load(patches.middle, i)), none, plane_of + i);
    const Vec8d cosines = Dot(Gather(target.planes(), plane_of + i).normal, normals);
    for (std::size_t k = 0; k < kSimdWidth; ++k) {
      if (cosines[k] < kMinCosine) plane_of[i + k] = none;
    }
  }
}

// Sums over matches: w r^2, their number, w j r, and the upper triangle of w j j^T or, for the
// noise of the gradient, of w^2 v j j^T with v the variance that a match contributes.
enum class Hessian { kOfSteps, kOfNoise };
struct Sums {
  std::array<double, 6> gradient;
  std::array<double, 21> hessian;
  double squares;
  double matches;
};

SEXTANT_MULTIVERSION
void Accumulate(const std::vector<ScanPlane>& planes, const ScanSurfaces::Patches& patches,
                const Motion& motion, const std::int32_t* plane_of, double gate_m, Hessian kind,
                Sums& sums) {
  std::array<Vec8d, 6> gradient{};
  std::array<Vec8d, 21> hessian{};
  Vec8d squares{};
  Vec8d matches{};
  const Vec8d gate = BroadcastVec(gate_m * gate_m);
  for (std::size_t i = 0; i < patches.inverse_count.size(); i += kSimdWidth) {
    const Planes plane = Gather(planes, plane_of + i);
    const std::array<Vec8d, 3> q = motion.Moved(Load(patches.middle, i));
    const Vec8d residual = Dot(plane.normal, q) - plane.distance;
    const Vec8d patch_share = LoadVec(patches.inverse_count.data() + i);
    const Vec8d plane_share = PlaneVariance(plane.inverse, q);
    const Vec8d share = patch_share + plane_share;
    const Vec8d variance = plane.variance * share;
    const Vec8d end = Max(gate, kEndOfWeights2 * plane.variance * (share + kUnknownShare));
    const Mask8 is_match = (plane.variance > 0.0) & (residual * residual < end);
    const Vec8d biweight = 1.0 - residual * residual / (is_match ? end : BroadcastVec(1.0));
    const Vec8d weight = is_match ? biweight * biweight / (is_match ? variance : BroadcastVec(1.0))
                                  : BroadcastVec(0.0);
    const Vec8d noise = plane.variance * (patch_share + kCellsOfAPlane * plane_share);
    const Vec8d of_hessian = kind == Hessian::kOfNoise ? weight * weight * noise : weight;
    const std::array<Vec8d, 3> arm = Cross(q, plane.normal);
    const std::array<Vec8d, 6> j = {arm[0],          arm[1],          arm[2],
                                    plane.normal[0], plane.normal[1], plane.normal[2]};
    std::size_t next = 0;
    for (std::size_t a = 0; a < 6; ++a) {
      gradient[a] += weight * j[a] * residual;
      const Vec8d weighted = of_hessian * j[a];
      for (std::size_t b = a; b < 6; ++b) hessian[next++] += weighted * j[b];
    }
    squares += weight * residual * residual;
    matches += is_match ? BroadcastVec(1.0) : BroadcastVec(0.0);
  }
  for (std::size_t a = 0; a < 6; ++a) sums.gradient[a] = HorizontalSum(gradient[a]);
  for (std::size_t k = 0; k < 21; ++k) sums.hessian[k] = HorizontalSum(hessian[k]);
  sums.squares = HorizontalSum(squares);
  sums.matches = HorizontalSum(matches);
}

Matrix6d Symmetric(const std::array<double, 21>& upper) {
  Matrix6d matrix;
  std::size_t next = 0;
  for (int a = 0; a < 6; ++a) {
    for (int b = a; b < 6; ++b) matrix(a, b) = matrix(b, a) = upper[next++];
  }
  return matrix;
}

}  // namespace

ScanMatch::ScanMatch(const ScanSurfaces& target, const ScanSurfaces& source)
    : target_(target),
      source_(source),
      plane_of_(source.patches().inverse_count.size(), target.no_plane()) {}

void ScanMatch::Match(const Rigid3d& target_from_source) {
  MatchAll(target_, source_.patches(), Motion(target_from_source), plane_of_.data());
}

ScanMatch::Equations ScanMatch::Linearise(const Rigid3d& target_from_source, double gate_m) const {
  Sums sums;
  Accumulate(target_.planes(), source_.patches(), Motion(target_from_source), plane_of_.data(),
             gate_m, Hessian::kOfSteps, sums);
  Equations equations;
  equations.normal = Symmetric(sums.hessian);
  for (int a = 0; a < 6; ++a) equations.right[a] = -sums.gradient[static_cast<std::size_t>(a)];
  equations.squares = sums.squares;
  equations.matches = static_cast<int>(sums.matches);
  return equations;
}

Matrix6d ScanMatch::NoiseOfRight(const Rigid3d& target_from_source) const {
  Sums sums;
  Accumulate(target_.planes(), source_.patches(), Motion(target_from_source), plane_of_.data(), 0.0,
             Hessian::kOfNoise, sums);
  return Symmetric(sums.hessian);
}

}  // namespace sextant
