// SPDX-License-Identifier: Apache-2.0
#include "solvers/kernels/agreement_graph.h"

#include <algorithm>

#include "solvers/kernels/column_kernel.h"

namespace sextant {
namespace {

constexpr std::size_t kBlock = PairColumns::kBlock;

using Bits8 = unsigned long long __attribute__((vector_size(64)));

template <class Real>
SEXTANT_INLINE Real SquaredLength(const Point3<Real>& v) {
  return v.x * v.x + v.y * v.y + v.z * v.z;
}

// | |c| - |l| |^2 <= t without a root: (c^2 - l^2)^2 <= t (2 (c^2 + l^2) - t), or c^2 + l^2 <= t.
// It holds where one of the two margins is not negative.
template <class Real>
struct Margins {
  Real equal;
  Real near;
};

template <class Real>
SEXTANT_INLINE Margins<Real> MarginsOf(const Real& c2, const Real& l2, const Real& t) {
  const Real difference = c2 - l2;
  const Real sum = c2 + l2;
  return {t * (sum + sum - t) - difference * difference, t - sum};
}

struct Vertex {
  Point3<double> cam;
  Point3<double> lidar;
  double variance;
};

SEXTANT_INLINE Vertex VertexOf(const PairColumns& pairs, std::size_t pair) {
  const std::size_t place = PairColumns::Place(pair);
  return {PointOf(pairs, kCamColumn, place), PointOf(pairs, kLidarColumn, place),
          pairs.Column(kVarianceColumn)[place]};
}

// Bit k is set where pair k of the block agrees. The signs of the margins are collected instead of
// comparisons, which compilers break into scalars; bits of padding are meaningless.
SEXTANT_INLINE std::uint64_t AgreementsInBlock(const PairColumns& pairs, std::size_t block,
                                               const Vertex& vertex, double max_squared) {
  constexpr Bits8 kShifts = {0, 8, 16, 24, 32, 40, 48, 56};
  constexpr int kSign = 63;
  Bits8 bits{};
  for (std::size_t k = kSimdWidth; k-- > 0;) {
    const std::size_t at = block + kSimdWidth * k;
    const Vec8d c2 = SquaredLength(PointsAt(pairs, kCamColumn, at) - vertex.cam);
    const Vec8d l2 = SquaredLength(PointsAt(pairs, kLidarColumn, at) - vertex.lidar);
    const Vec8d t = max_squared * (LoadVec(pairs.Column(kVarianceColumn) + at) + vertex.variance);
    const Margins<Vec8d> margins = MarginsOf(c2, l2, t);
    const Bits8 differ =
        __builtin_bit_cast(Bits8, margins.equal) & __builtin_bit_cast(Bits8, margins.near);
    bits = bits + bits + (differ >> kSign);
  }
  bits <<= kShifts;
  return ~static_cast<std::uint64_t>(HorizontalOr(__builtin_bit_cast(Mask8, bits)));
}

// Fills row i from the word `first` on.
SEXTANT_INLINE void FillRow(const PairColumns& pairs, std::size_t i, double max_squared,
                            std::size_t first, std::uint64_t* row) {
  const Vertex vertex = VertexOf(pairs, i);
  const std::size_t words = pairs.padded() / kBlock;
  for (std::size_t w = first; w < words; ++w) {
    row[w] = AgreementsInBlock(pairs, w * kBlock, vertex, max_squared);
  }
  row[words - 1] &= ~std::uint64_t{0} >> (pairs.padded() - pairs.size());
  row[i / kBlock] &= ~(std::uint64_t{1} << (i % kBlock));
}

SEXTANT_MULTIVERSION void FillOneRow(const PairColumns& pairs, std::size_t i, double max_squared,
                                     std::uint64_t* row) {
  FillRow(pairs, i, max_squared, 0, row);
}

SEXTANT_MULTIVERSION void FillUpperBlocks(const PairColumns& pairs, double max_squared,
                                          BitGraph& graph) {
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    FillRow(pairs, i, max_squared, i / kBlock, graph.Row(static_cast<int>(i)));
  }
}

// Bit j of word i becomes bit i of word j: swaps off-diagonal halves, then those of each half.
SEXTANT_INLINE void Transpose(std::uint64_t* block) {
  std::uint64_t mask = 0x00000000FFFFFFFFULL;
  for (std::size_t half = kBlock / 2; half > 0; half /= 2, mask ^= mask << half) {
    for (std::size_t begin = 0; begin < kBlock; begin += 2 * half) {
      for (std::size_t i = begin; i < begin + half; ++i) {
        const std::uint64_t swapped = ((block[i] >> half) ^ block[i + half]) & mask;
        block[i] ^= swapped << half;
        block[i + half] ^= swapped;
      }
    }
  }
}

void MirrorUpperBlocks(BitGraph& graph) {
  const auto vertices = static_cast<std::size_t>(graph.vertices());
  std::uint64_t block[kBlock];
  for (std::size_t column = 1; column < graph.words(); ++column) {
    const std::size_t rows = std::min(kBlock, vertices - column * kBlock);
    for (std::size_t w = 0; w < column; ++w) {
      for (std::size_t i = 0; i < kBlock; ++i) {
        block[i] = graph.Row(static_cast<int>(w * kBlock + i))[column];
      }
      Transpose(block);
      for (std::size_t i = 0; i < rows; ++i) {
        graph.Row(static_cast<int>(column * kBlock + i))[w] = block[i];
      }
    }
  }
}

}  // namespace

bool Agree(const PairColumns& pairs, std::size_t i, std::size_t j, double max_squared) {
  const Vertex a = VertexOf(pairs, i);
  const Vertex b = VertexOf(pairs, j);
  const Margins<double> margins =
      MarginsOf(SquaredLength(a.cam - b.cam), SquaredLength(a.lidar - b.lidar),
                max_squared * (a.variance + b.variance));
  return margins.equal >= 0.0 || margins.near >= 0.0;
}

BitGraph AgreementGraph(const PairColumns& pairs, double max_squared) {
  BitGraph graph(static_cast<int>(pairs.size()));
  if (pairs.size() == 0) return graph;
  FillUpperBlocks(pairs, max_squared, graph);
  MirrorUpperBlocks(graph);
  return graph;
}

void RowOfAgreements(const PairColumns& pairs, std::size_t i, double max_squared,
                     std::span<std::uint64_t> row) {
  FillOneRow(pairs, i, max_squared, row.data());
}

}  // namespace sextant
