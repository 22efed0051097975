// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/scans/scan_match.h"

#include <Eigen/Geometry>

namespace sextant {
namespace {

constexpr double kLeastCosine = 0.85;  ///< Between the normals of a match.
constexpr double kEndOfWeights2 = 9.0;
constexpr double kCellsOfAPlane = 9.0;
/// Besides what is known of a match, in noise variances: planes are not quite flat.
constexpr double kUnknownShare = 0.1;

// A pose as the kernels read it.
struct Motion {
  explicit Motion(const Rigid3d& b_from_a)
      : rotation(b_from_a.rotation.toRotationMatrix()), translation(b_from_a.translation) {}

  SEXTANT_INLINE std::array<Lanes, 3> Turned(const std::array<Lanes, 3>& v) const {
    std::array<Lanes, 3> turned;
    for (int k = 0; k < 3; ++k) {
      turned[static_cast<std::size_t>(k)] =
          rotation(k, 0) * v[0] + rotation(k, 1) * v[1] + rotation(k, 2) * v[2];
    }
    return turned;
  }
  SEXTANT_INLINE std::array<Lanes, 3> Moved(const std::array<Lanes, 3>& p) const {
    std::array<Lanes, 3> moved = Turned(p);
    for (int k = 0; k < 3; ++k) moved[static_cast<std::size_t>(k)] += translation[k];
    return moved;
  }

  Eigen::Matrix3d rotation;
  Eigen::Vector3d translation;
};

using Triple = std::array<std::vector<double>, 3>;

SEXTANT_INLINE std::array<Lanes, 3> Load(const Triple& from, std::size_t at) {
  return {LoadLanes(from[0].data() + at), LoadLanes(from[1].data() + at),
          LoadLanes(from[2].data() + at)};
}

SEXTANT_INLINE Lanes Dot(const std::array<Lanes, 3>& a, const std::array<Lanes, 3>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

SEXTANT_INLINE std::array<Lanes, 3> Cross(const std::array<Lanes, 3>& a,
                                          const std::array<Lanes, 3>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

struct Planes {
  std::array<Lanes, 3> normal;
  Lanes distance;
  Lanes variance;
  std::array<Lanes, 6> inverse;
};

SEXTANT_INLINE Planes Gather(const std::vector<ScanPlane>& planes, const std::int32_t* which) {
  Planes gathered;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const ScanPlane& plane = planes[static_cast<std::size_t>(which[i])];
    for (std::size_t k = 0; k < 3; ++k) gathered.normal[k][i] = plane.normal[k];
    gathered.distance[i] = plane.distance;
    gathered.variance[i] = plane.variance_m2;
    for (std::size_t k = 0; k < 6; ++k) gathered.inverse[k][i] = plane.inverse_moments[k];
  }
  return gathered;
}

// The planes' variances at q over the noise of one return.
SEXTANT_INLINE Lanes PlaneVariance(const std::array<Lanes, 6>& i, const std::array<Lanes, 3>& q) {
  return i[0] * q[0] * q[0] + i[3] * q[1] * q[1] + i[5] * q[2] * q[2] +
         2.0 * (i[1] * q[0] * q[1] + i[2] * q[0] * q[2] + i[4] * q[1] * q[2]);
}

SEXTANT_MULTIVERSION
void MatchAll(const ScanSurfaces& target, const ScanSurfaces::Patches& patches,
              const Motion& motion, std::int32_t* plane_of) {
  const std::int32_t none = target.no_plane();
  for (std::size_t i = 0; i < patches.inverse_count.size(); i += kLanes) {
    const std::array<Lanes, 3> normals = motion.Turned(Load(patches.normal, i));
    target.cells().CellsOf(motion.Moved(Load(patches.middle, i)), none, plane_of + i);
    const Lanes cosines = Dot(Gather(target.planes(), plane_of + i).normal, normals);
    for (std::size_t k = 0; k < kLanes; ++k) {
      if (cosines[k] < kLeastCosine) plane_of[i + k] = none;
    }
  }
}

// Sums of w r^2, of matches, of w j r and of the upper half of w j j^T, or, for the noise of the
// gradient, of w^2 v j j^T with v what a match adds to it.
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
  std::array<Lanes, 6> gradient{};
  std::array<Lanes, 21> hessian{};
  Lanes squares{};
  Lanes matches{};
  const Lanes gate = AllLanes(gate_m * gate_m);
  for (std::size_t i = 0; i < patches.inverse_count.size(); i += kLanes) {
    const Planes plane = Gather(planes, plane_of + i);
    const std::array<Lanes, 3> q = motion.Moved(Load(patches.middle, i));
    const Lanes residual = Dot(plane.normal, q) - plane.distance;
    const Lanes patch_share = LoadLanes(patches.inverse_count.data() + i);
    const Lanes plane_share = PlaneVariance(plane.inverse, q);
    const Lanes share = patch_share + plane_share;
    const Lanes variance = plane.variance * share;
    const Lanes end = Max(gate, kEndOfWeights2 * plane.variance * (share + kUnknownShare));
    const LaneMask is_match = (plane.variance > 0.0) & (residual * residual < end);
    const Lanes biweight = 1.0 - residual * residual / (is_match ? end : AllLanes(1.0));
    const Lanes weight =
        is_match ? biweight * biweight / (is_match ? variance : AllLanes(1.0)) : AllLanes(0.0);
    const Lanes noise = plane.variance * (patch_share + kCellsOfAPlane * plane_share);
    const Lanes of_hessian = kind == Hessian::kOfNoise ? weight * weight * noise : weight;
    const std::array<Lanes, 3> arm = Cross(q, plane.normal);
    const std::array<Lanes, 6> j = {arm[0],          arm[1],          arm[2],
                                    plane.normal[0], plane.normal[1], plane.normal[2]};
    std::size_t next = 0;
    for (std::size_t a = 0; a < 6; ++a) {
      gradient[a] += weight * j[a] * residual;
      const Lanes weighted = of_hessian * j[a];
      for (std::size_t b = a; b < 6; ++b) hessian[next++] += weighted * j[b];
    }
    squares += weight * residual * residual;
    matches += is_match ? AllLanes(1.0) : AllLanes(0.0);
  }
  for (std::size_t a = 0; a < 6; ++a) sums.gradient[a] = SumLanes(gradient[a]);
  for (std::size_t k = 0; k < 21; ++k) sums.hessian[k] = SumLanes(hessian[k]);
  sums.squares = SumLanes(squares);
  sums.matches = SumLanes(matches);
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
