// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/kabsch_batch.h"

#include <algorithm>
#include <array>

#include "solvers/kernels/kabsch_kernel.h"
#include "solvers/kernels/trace_formula.h"

namespace sextant {
namespace {

static_assert(PointBatch::kGroup == kSimdWidth);

using EightNumbers = std::array<double, kSimdWidth>;

// Eight problems, taken apart by lane.
struct GroupFit {
  double At(int number, std::size_t lane) const {
    return numbers[static_cast<std::size_t>(number)][lane];
  }

  KernelFit Kernel(std::size_t lane) const {
    return {{At(0, lane), At(1, lane), At(2, lane), At(3, lane)},
            {At(4, lane), At(5, lane), At(6, lane)},
            At(7, lane),
            At(8, lane)};
  }
  double squares(std::size_t lane) const { return At(9, lane); }

  CentredMoments<double> Moments(std::size_t lane) const {
    CentredMoments<double> m{};
    m.squares = squares(lane);
    m.mean_a = {At(10, lane), At(11, lane), At(12, lane)};
    m.mean_b = {At(13, lane), At(14, lane), At(15, lane)};
    m.cross = {At(16, lane), At(17, lane), At(18, lane), At(19, lane), At(20, lane),
               At(21, lane), At(22, lane), At(23, lane), At(24, lane)};
    return m;
  }

  std::array<EightNumbers, 25> numbers;
  std::array<long long, kSimdWidth> proven;  // -1 where the formula proved itself.
};

template <class L>
SEXTANT_INLINE Point3<L> LoadPoint(const double* from) {
  return {Load<L>(from), Load<L>(from + kSimdWidth), Load<L>(from + 2 * kSimdWidth)};
}

template <class L>
SEXTANT_INLINE Point3<L> operator+(const Point3<L>& a, const Point3<L>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}

template <class L>
SEXTANT_INLINE CentredMoments<L> MomentsOf(const double* group, std::size_t points) {
  const Point3<L> origin_a = LoadPoint<L>(group);
  const Point3<L> origin_b = LoadPoint<L>(group + 3 * kSimdWidth);
  PairMomentSums<L> sums{};
  for (std::size_t i = 1; i < points; ++i) {
    const double* point = group + i * 6 * kSimdWidth;
    sums.template Add<false, false>(LoadPoint<L>(point) - origin_a,
                                    LoadPoint<L>(point + 3 * kSimdWidth) - origin_b, L{});
  }
  CentredMoments<L> m = Centre<false>(sums, All<L>(static_cast<double>(points)));
  m.mean_a = m.mean_a + origin_a;
  m.mean_b = m.mean_b + origin_b;
  return m;
}

// MaximizeTraceByFormula in lanes. One that is done is left alone, so that no problem notices its
// neighbours.
template <class L>
SEXTANT_INLINE MaskOf<L> FindRoot(const Quartic<L>& quartic, const L& bound, L& x) {
  constexpr int kMaxIterations = 8;
  x = bound;
  MaskOf<L> done{};
  for (int i = 0; i < kMaxIterations && AnyTrue(~done); ++i) {
    const L step = HouseholderStep(quartic, x);
    x = Select(done, x, x - step);
    done |= Abs(step) <= 1e-3 * bound;
  }
  return done;
}

template <class L>
SEXTANT_INLINE MaskOf<L> FindVector(const HornMatrix<L>& horn, const Invariants<L>& v,
                                    const L& bound, L& e1, Vector4<L>& q) {
  constexpr int kMaxRounds = 4;
  const L none{};
  q = {none, none, none, none};
  MaskOf<L> done{};
  for (int round = 0; round < kMaxRounds && AnyTrue(~done); ++round) {
    Vector4<L> column = NullVector(horn, e1);
    for (int polish = 0; polish < 2 && AnyTrue(~done); ++polish) {
      const EigenResidual<L> r = ResidualOf(horn, e1, column);
      const L scale = 1.0 / Sqrt(r.length2);
      q = Select(
          done, q,
          Vector4<L>{scale * column.x, scale * column.y, scale * column.z, scale * column.w});
      e1 = Select(done, e1, e1 + r.shift);
      done |= IsProven<MaskOf<L>>(r, SeparationOf(v, e1), bound);
      column = WithoutFarParts(column, r, e1);
    }
  }
  return done;
}

template <class L>
SEXTANT_INLINE void Store(const CentredMoments<L>& m, GroupFit& fit) {
  const L all[] = {m.squares,  m.mean_a.x, m.mean_a.y, m.mean_a.z, m.mean_b.x, m.mean_b.y,
                   m.mean_b.z, m.cross.xx, m.cross.xy, m.cross.xz, m.cross.yx, m.cross.yy,
                   m.cross.yz, m.cross.zx, m.cross.zy, m.cross.zz};
  for (std::size_t i = 0; i < 16; ++i) StoreVec(all[i], fit.numbers[9 + i].data());
}

template <class L>
SEXTANT_INLINE void FitGroupFor(const double* group, std::size_t points, GroupFit& fit) {
  const CentredMoments<L> m = MomentsOf<L>(group, points);
  Store(m, fit);
  const L bound = 0.5 * m.squares;
  const HornMatrix<L> horn = MakeHornMatrix(m.cross);
  const Invariants<L> v = ComputeInvariants(m.cross);
  L e1;
  MaskOf<L> proven = FindRoot(CharacteristicPolynomial(v), bound, e1);
  Vector4<L> q;
  proven &= FindVector(horn, v, bound, e1, q);
  proven &= SeparationOf(v, e1) > kMinSeparation * bound * bound * bound;
  const RotationMatrix<L> r = MakeRotationMatrix(q);
  const Point3<L> translation = m.mean_b - Rotate(r, m.mean_a);
  const L all[] = {q.x,
                   q.y,
                   q.z,
                   q.w,
                   translation.x,
                   translation.y,
                   translation.z,
                   e1,
                   e1 - 2.0 * LeastSingularValue(r, m.cross)};
  for (std::size_t i = 0; i < 9; ++i) StoreVec(all[i], fit.numbers[i].data());
  StoreMask(proven, fit.proven.data());
}

SEXTANT_SIMD_DISPATCH(void, FitGroup, (const double* group, std::size_t points, GroupFit& fit),
                      (group, points, fit))

KabschOutcome OutcomeOf(const GroupFit& group, std::size_t lane) {
  if (group.proven[lane] != 0) return CheckFit(group.Kernel(lane), group.squares(lane));
  KernelFit kernel;
  if (!FitByEigensolver(group.Moments(lane), kernel)) {
    return tl::unexpected(ErrorCode::kDegenerate);
  }
  return CheckFit(kernel, group.squares(lane));
}

}  // namespace

PointBatch::PointBatch(std::size_t problems, std::size_t points_per_problem)
    : problems_(problems),
      points_(points_per_problem),
      numbers_((problems + kGroup - 1) / kGroup * points_per_problem * 6 * kGroup, 0.0) {}

void FitKabschBatch(const PointBatch& batch, std::span<KabschOutcome> fits) {
  if (batch.points_per_problem() < 3) {
    std::fill(fits.begin(), fits.end(), tl::unexpected(ErrorCode::kTooFewPairs));
    return;
  }
  GroupFit group;
  for (std::size_t first = 0; first < batch.problems(); first += kSimdWidth) {
    FitGroup(batch.Group(first / kSimdWidth), batch.points_per_problem(), group);
    const std::size_t count = std::min(kSimdWidth, batch.problems() - first);
    for (std::size_t lane = 0; lane < count; ++lane) fits[first + lane] = OutcomeOf(group, lane);
  }
}

}  // namespace sextant
