// SPDX-License-Identifier: Apache-2.0
#include "features/camera/tag_model.h"

#include <algorithm>
#include <cstdint>
#include <numbers>

#include "base/simd.h"

namespace sextant {
namespace {

constexpr double kReach = 4.0;         ///< Width of a blurred step, in standard deviations.
constexpr std::size_t kMaxCells = 24;  ///< Along one axis within reach.

// e^x for -700 < x <= 0 to 3e-10: 2^k times a polynomial over half an octave to each side.
SEXTANT_INLINE Vec8d Exp(const Vec8d& x) {
  const Vec8d shift =
      BroadcastVec(6755399441055744.0);  // 1.5 * 2^52: the integer is in the low bits.
  const Vec8d shifted = x * (1.0 / std::numbers::ln2) + shift;
  const Vec8d r = x - (shifted - shift) * std::numbers::ln2;
  Mask8 bits;
  std::memcpy(&bits, &shifted, sizeof bits);
  bits = (bits + 1023) << 52;
  Vec8d power;
  std::memcpy(&power, &bits, sizeof power);
  Vec8d sum = BroadcastVec(1.0 / 40320.0);
  for (const double c : {1.0 / 5040.0, 1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0}) {
    sum = sum * r + c;
  }
  return (sum * r + 1.0) * power;
}

// Phi(h), and phi(h) He_n(h) for n = 0 to 3 with Hermite's polynomials: up to the sign, each is the
// derivative of the one before.
struct Step {
  Vec8d value{};
  std::array<Vec8d, 4> hermite{};
};

SEXTANT_INLINE Step StepAt(const Vec8d& h) {
  const Mask8 is_in = (h > -kReach) & (h < kReach);
  const Vec8d inside = is_in ? h : BroadcastVec(0.0);
  const Vec8d density =
      Exp(-0.5 * inside * inside) * (0.5 * std::numbers::inv_sqrtpi * std::numbers::sqrt2);
  const Vec8d t = 1.0 / (1.0 + 0.2316419 * Abs(inside));
  const Vec8d tail =
      density * t *
      (0.319381530 + t * (-0.356563782 + t * (1.781477937 + t * (-1.821255978 + t * 1.330274429))));
  const Vec8d outside = h > 0.0 ? BroadcastVec(1.0) : BroadcastVec(0.0);
  const Vec8d phi = is_in ? density : BroadcastVec(0.0);
  Step step;
  step.value = is_in ? (inside > 0.0 ? 1.0 - tail : tail) : outside;
  step.hermite = {phi, inside * phi, (inside * inside - 1.0) * phi,
                  (inside * inside - 3.0) * inside * phi};
  return step;
}

// The weight of each cell from `first` on in the blur: the difference of Step over its two sides.
struct Weights {
  std::array<std::int32_t, kSimdWidth> first;
  std::size_t count = 0;
  std::array<Step, kMaxCells> cells;
};

SEXTANT_INLINE std::int32_t Floor(double value) {
  const auto whole = static_cast<std::int32_t>(value);
  return value < whole ? whole - 1 : whole;
}

SEXTANT_INLINE void WeightsAt(const Vec8d& point, const Vec8d& blur, Weights& weights) {
  const Vec8d low = point - kReach * blur;
  const Vec8d high = point + kReach * blur;
  Vec8d begin_at;
  std::int32_t most = 0;
  for (std::size_t i = 0; i < kSimdWidth; ++i) {
    weights.first[i] = Floor(low[i]);
    begin_at[i] = weights.first[i];
    most = std::max(most, Floor(high[i]) - weights.first[i]);
  }
  weights.count = std::min(static_cast<std::size_t>(most) + 1, kMaxCells);
  const Vec8d by_blur = 1.0 / blur;
  Step begin{.value = BroadcastVec(1.0), .hermite = {}};
  for (std::size_t i = 0; i < weights.count; ++i) {
    Step end;
    if (i + 1 < weights.count)
      end = StepAt((point - begin_at - static_cast<double>(i + 1)) * by_blur);
    Step& cell = weights.cells[i];
    cell.value = begin.value - end.value;
    for (std::size_t n = 0; n < 4; ++n) cell.hermite[n] = begin.hermite[n] - end.hermite[n];
    begin = end;
  }
}

// 1 for the vector elements whose cell is black.
SEXTANT_INLINE Vec8d BlackAt(const TagModel::Cells& cells, const Weights& us, const Weights& vs,
                             std::size_t column, std::size_t row) {
  Vec8d black;
  for (std::size_t i = 0; i < kSimdWidth; ++i) {
    const std::int32_t u =
        std::clamp(us.first[i] + static_cast<std::int32_t>(column), -1, cells.side) + 1;
    const std::int32_t v =
        std::clamp(vs.first[i] + static_cast<std::int32_t>(row), -1, cells.side) + 1;
    black[i] = cells.black[static_cast<std::size_t>(v * (cells.side + 2) + u)];
  }
  return black;
}

struct Blurred {
  Vec8d white;
  std::array<Vec8d, 2> by_step;  // Derivatives by the position in units of the blur.
  Vec8d by_blur;
};

// Subtracts black cells from white, so that the white surroundings need no terms.
SEXTANT_INLINE Blurred BlurAt(const TagModel::Cells& cells, const Weights& us, const Weights& vs,
                              const Vec8d& correlation) {
  const std::array<Vec8d, 3> series = {correlation, 0.5 * correlation * correlation,
                                       correlation * correlation * correlation / 6.0};
  Blurred sum{.white = BroadcastVec(1.0), .by_step = {}, .by_blur = {}};
  for (std::size_t row = 0; row < vs.count; ++row) {
    const Step& v = vs.cells[row];
    for (std::size_t column = 0; column < us.count; ++column) {
      const Vec8d black = BlackAt(cells, us, vs, column, row);
      if (HorizontalSum(black) == 0.0) continue;
      const Step& u = us.cells[column];
      Vec8d share = u.value * v.value;
      std::array<Vec8d, 2> by_step = {u.hermite[0] * v.value, u.value * v.hermite[0]};
      for (std::size_t n = 0; n < series.size(); ++n) {
        share += series[n] * u.hermite[n] * v.hermite[n];
        by_step[0] -= series[n] * u.hermite[n + 1] * v.hermite[n];
        by_step[1] -= series[n] * u.hermite[n] * v.hermite[n + 1];
      }
      sum.white -= black * share;
      for (std::size_t k = 0; k < 2; ++k) sum.by_step[k] -= black * by_step[k];
      sum.by_blur += black * (u.hermite[1] * v.value + u.value * v.hermite[1]);
    }
  }
  return sum;
}

SEXTANT_MULTIVERSION
void ModelPixels(const TagModel::Cells& cells, const EdgePixels& pixels, const TagState& state,
                 TagModel::Modelled& out) {
  const Eigen::Matrix3d& h = state.tag_from_straight;
  Weights us;
  Weights vs;
  for (std::size_t i = 0; i < pixels.x.size(); i += kSimdWidth) {
    const Vec8d px = LoadVec(pixels.x.data() + i);
    const Vec8d py = LoadVec(pixels.y.data() + i);
    const Vec8d scale = 1.0 / (h(2, 0) * px + h(2, 1) * py + h(2, 2));
    const Vec8d x = (h(0, 0) * px + h(0, 1) * py + h(0, 2)) * scale;
    const Vec8d y = (h(1, 0) * px + h(1, 1) * py + h(1, 2)) * scale;
    const Vec8d x_by_px = (h(0, 0) - x * h(2, 0)) * scale;
    const Vec8d x_by_py = (h(0, 1) - x * h(2, 1)) * scale;
    const Vec8d y_by_px = (h(1, 0) - y * h(2, 0)) * scale;
    const Vec8d y_by_py = (h(1, 1) - y * h(2, 1)) * scale;
    const Vec8d j00 = LoadVec(pixels.x_by_u.data() + i);
    const Vec8d j01 = LoadVec(pixels.x_by_v.data() + i);
    const Vec8d j10 = LoadVec(pixels.y_by_u.data() + i);
    const Vec8d j11 = LoadVec(pixels.y_by_v.data() + i);
    const Vec8d x_by_u = x_by_px * j00 + x_by_py * j10;
    const Vec8d x_by_v = x_by_px * j01 + x_by_py * j11;
    const Vec8d y_by_u = y_by_px * j00 + y_by_py * j10;
    const Vec8d y_by_v = y_by_px * j01 + y_by_py * j11;
    const Vec8d x_spread = Sqrt(x_by_u * x_by_u + x_by_v * x_by_v);
    const Vec8d y_spread = Sqrt(y_by_u * y_by_u + y_by_v * y_by_v);
    const Vec8d correlation = (x_by_u * y_by_u + x_by_v * y_by_v) / (x_spread * y_spread);
    const double blur = state.blur_px * cells.a_unit;
    WeightsAt((x + 1.0) * cells.a_unit + cells.first, blur * x_spread, us);
    WeightsAt((y + 1.0) * cells.a_unit + cells.first, blur * y_spread, vs);
    const Blurred blurred = BlurAt(cells, us, vs, correlation);
    const Vec8d gain = state.gain[0] + state.gain[1] * x + state.gain[2] * y;
    const Vec8d offset = state.offset[0] + state.offset[1] * x + state.offset[2] * y;
    StoreVec(x, out.x.data() + i);
    StoreVec(y, out.y.data() + i);
    StoreVec(blurred.white, out.white.data() + i);
    // The width of the blur in cells is blur times the spread; the cells per unit cancel.
    StoreVec(gain * blurred.by_step[0] / (state.blur_px * x_spread), out.by_x.data() + i);
    StoreVec(gain * blurred.by_step[1] / (state.blur_px * y_spread), out.by_y.data() + i);
    StoreVec(gain * blurred.by_blur, out.by_blur.data() + i);
    const Vec8d grey = LoadVec(pixels.grey.data() + i);
    StoreVec(grey - (gain * blurred.white + offset), out.residual.data() + i);
  }
}

constexpr std::size_t kRows = kTagUnknowns;
constexpr std::size_t kUpper = kRows * (kRows + 1) / 2;

struct Sums {
  std::array<double, kUpper> normal;
  std::array<double, kRows> right;
};

// The padding of the last vector has weight 0.
SEXTANT_MULTIVERSION
void Accumulate(const TagModel::Modelled& modelled, std::size_t count, double threshold,
                Sums& sums) {
  std::array<Vec8d, kUpper> normal{};
  std::array<Vec8d, kRows> right{};
  for (std::size_t i = 0; i < count; i += kSimdWidth) {
    const Vec8d x = LoadVec(modelled.x.data() + i);
    const Vec8d y = LoadVec(modelled.y.data() + i);
    const Vec8d by_x = LoadVec(modelled.by_x.data() + i);
    const Vec8d by_y = LoadVec(modelled.by_y.data() + i);
    const Vec8d white = LoadVec(modelled.white.data() + i);
    const Vec8d residual = LoadVec(modelled.residual.data() + i);
    const Vec8d along = x * by_x + y * by_y;
    const std::array<Vec8d, kRows> row = {x * by_x,
                                          y * by_x,
                                          by_x,
                                          x * by_y,
                                          y * by_y,
                                          by_y,
                                          -x * along,
                                          -y * along,
                                          LoadVec(modelled.by_blur.data() + i),
                                          white,
                                          white * x,
                                          white * y,
                                          BroadcastVec(1.0),
                                          x,
                                          y};
    Vec8d weight = Min(BroadcastVec(1.0), threshold / Max(Abs(residual), BroadcastVec(1e-12)));
    for (std::size_t k = count - i; k < kSimdWidth; ++k) weight[k] = 0.0;
    std::size_t next = 0;
    for (std::size_t a = 0; a < kRows; ++a) {
      const Vec8d weighted = weight * row[a];
      right[a] += weighted * residual;
      for (std::size_t b = a; b < kRows; ++b) normal[next++] += weighted * row[b];
    }
  }
  for (std::size_t k = 0; k < kUpper; ++k) sums.normal[k] = HorizontalSum(normal[k]);
  for (std::size_t k = 0; k < kRows; ++k) sums.right[k] = HorizontalSum(right[k]);
}

}  // namespace

TagModel::TagModel(const TagPattern& pattern, const EdgePixels& pixels) : pixels_(&pixels) {
  cells_.first = pattern.edge_first;
  cells_.a_unit = 0.5 * pattern.edge_cells;
  cells_.side = pattern.cells;
  const auto stride = static_cast<std::size_t>(pattern.cells) + 2;
  cells_.black.assign(stride * stride, 0.0);
  for (int row = 0; row < pattern.cells; ++row) {
    for (int column = 0; column < pattern.cells; ++column) {
      const auto at =
          static_cast<std::size_t>(row + 1) * stride + static_cast<std::size_t>(column + 1);
      cells_.black[at] = pattern.IsWhite(row, column) ? 0.0 : 1.0;
    }
  }
  for (std::vector<double>* field : {&modelled_.x, &modelled_.y, &modelled_.white, &modelled_.by_x,
                                     &modelled_.by_y, &modelled_.by_blur, &modelled_.residual}) {
    field->resize(pixels.x.size());
  }
}

void TagModel::Evaluate(const TagState& state) {
  ModelPixels(cells_, *pixels_, state, modelled_);
  residuals_ = Eigen::Map<const Eigen::VectorXd>(modelled_.residual.data(), pixels_->count);
}

void TagModel::Linearise(double threshold, TagNormal& normal, TagRow& right) const {
  Sums sums;
  Accumulate(modelled_, static_cast<std::size_t>(pixels_->count), threshold, sums);
  std::size_t next = 0;
  for (int a = 0; a < kTagUnknowns; ++a) {
    right[a] = sums.right[static_cast<std::size_t>(a)];
    for (int b = a; b < kTagUnknowns; ++b) normal(a, b) = normal(b, a) = sums.normal[next++];
  }
}

}  // namespace sextant
