// SPDX-License-Identifier: Apache-2.0
#include "features/camera/tag_model.h"

#include <algorithm>
#include <cstdint>
#include <numbers>

#include "base/lanes.h"

namespace sextant {
namespace {

constexpr double kReach = 4.0;          ///< Standard deviations beyond which a step is over.
constexpr std::size_t kMostCells = 24;  ///< Along one axis within reach.

// e^x for -700 < x <= 0: 2^k times a polynomial on half an octave to both sides, to 3e-10.
SEXTANT_INLINE Lanes Exp(const Lanes& x) {
  const Lanes shift = AllLanes(6755399441055744.0);  // 1.5 * 2^52: the integer is in the low bits.
  const Lanes shifted = x * (1.0 / std::numbers::ln2) + shift;
  const Lanes r = x - (shifted - shift) * std::numbers::ln2;
  LaneMask bits;
  std::memcpy(&bits, &shifted, sizeof bits);
  bits = (bits + 1023) << 52;
  Lanes power;
  std::memcpy(&power, &bits, sizeof power);
  Lanes sum = AllLanes(1.0 / 40320.0);
  for (const double c : {1.0 / 5040.0, 1.0 / 720.0, 1.0 / 120.0, 1.0 / 24.0, 1.0 / 6.0, 0.5, 1.0}) {
    sum = sum * r + c;
  }
  return (sum * r + 1.0) * power;
}

// Phi(h), and phi(h) He_n(h) for n = 0 to 3 (Hermite's polynomials, each the derivative of the one
// before but for its sign).
struct Step {
  Lanes value{};
  std::array<Lanes, 4> hermite{};
};

SEXTANT_INLINE Step StepAt(const Lanes& h) {
  const LaneMask is_in = (h > -kReach) & (h < kReach);
  const Lanes inside = is_in ? h : AllLanes(0.0);
  const Lanes density =
      Exp(-0.5 * inside * inside) * (0.5 * std::numbers::inv_sqrtpi * std::numbers::sqrt2);
  const Lanes t = 1.0 / (1.0 + 0.2316419 * Abs(inside));
  const Lanes tail =
      density * t *
      (0.319381530 + t * (-0.356563782 + t * (1.781477937 + t * (-1.821255978 + t * 1.330274429))));
  const Lanes outside = h > 0.0 ? AllLanes(1.0) : AllLanes(0.0);
  const Lanes lanes_density = is_in ? density : AllLanes(0.0);
  Step step;
  step.value = is_in ? (inside > 0.0 ? 1.0 - tail : tail) : outside;
  step.hermite = {lanes_density, inside * lanes_density, (inside * inside - 1.0) * lanes_density,
                  (inside * inside - 3.0) * inside * lanes_density};
  return step;
}

// How much of each cell from `first` the blur sees: differences over its two sides.
struct Weights {
  std::array<std::int32_t, kLanes> first;
  std::size_t count = 0;
  std::array<Step, kMostCells> cells;
};

SEXTANT_INLINE std::int32_t Floor(double value) {
  const auto whole = static_cast<std::int32_t>(value);
  return value < whole ? whole - 1 : whole;
}

SEXTANT_INLINE void WeightsAt(const Lanes& point, const Lanes& blur, Weights& weights) {
  const Lanes low = point - kReach * blur;
  const Lanes high = point + kReach * blur;
  Lanes begin_at;
  std::int32_t most = 0;
  for (std::size_t i = 0; i < kLanes; ++i) {
    weights.first[i] = Floor(low[i]);
    begin_at[i] = weights.first[i];
    most = std::max(most, Floor(high[i]) - weights.first[i]);
  }
  weights.count = std::min(static_cast<std::size_t>(most) + 1, kMostCells);
  const Lanes by_blur = 1.0 / blur;
  Step begin{.value = AllLanes(1.0), .hermite = {}};
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

// 1 for the lanes whose cell is black.
SEXTANT_INLINE Lanes BlackAt(const TagModel::Cells& cells, const Weights& us, const Weights& vs,
                             std::size_t column, std::size_t row) {
  Lanes black;
  for (std::size_t i = 0; i < kLanes; ++i) {
    const std::int32_t u =
        std::clamp(us.first[i] + static_cast<std::int32_t>(column), -1, cells.side) + 1;
    const std::int32_t v =
        std::clamp(vs.first[i] + static_cast<std::int32_t>(row), -1, cells.side) + 1;
    black[i] = cells.black[static_cast<std::size_t>(v * (cells.side + 2) + u)];
  }
  return black;
}

struct Blurred {
  Lanes white;
  std::array<Lanes, 2> by_step;  // Derivatives by the point in blurs.
  Lanes by_blur;
};

// Black cells are taken from white: most of the surroundings need no term then.
SEXTANT_INLINE Blurred BlurAt(const TagModel::Cells& cells, const Weights& us, const Weights& vs,
                              const Lanes& correlation) {
  const std::array<Lanes, 3> series = {correlation, 0.5 * correlation * correlation,
                                       correlation * correlation * correlation / 6.0};
  Blurred sum{.white = AllLanes(1.0), .by_step = {}, .by_blur = {}};
  for (std::size_t row = 0; row < vs.count; ++row) {
    const Step& v = vs.cells[row];
    for (std::size_t column = 0; column < us.count; ++column) {
      const Lanes black = BlackAt(cells, us, vs, column, row);
      if (SumLanes(black) == 0.0) continue;
      const Step& u = us.cells[column];
      Lanes share = u.value * v.value;
      std::array<Lanes, 2> by_step = {u.hermite[0] * v.value, u.value * v.hermite[0]};
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
  for (std::size_t i = 0; i < pixels.x.size(); i += kLanes) {
    const Lanes px = LoadLanes(pixels.x.data() + i);
    const Lanes py = LoadLanes(pixels.y.data() + i);
    const Lanes scale = 1.0 / (h(2, 0) * px + h(2, 1) * py + h(2, 2));
    const Lanes x = (h(0, 0) * px + h(0, 1) * py + h(0, 2)) * scale;
    const Lanes y = (h(1, 0) * px + h(1, 1) * py + h(1, 2)) * scale;
    const Lanes x_by_px = (h(0, 0) - x * h(2, 0)) * scale;
    const Lanes x_by_py = (h(0, 1) - x * h(2, 1)) * scale;
    const Lanes y_by_px = (h(1, 0) - y * h(2, 0)) * scale;
    const Lanes y_by_py = (h(1, 1) - y * h(2, 1)) * scale;
    const Lanes j00 = LoadLanes(pixels.x_by_u.data() + i);
    const Lanes j01 = LoadLanes(pixels.x_by_v.data() + i);
    const Lanes j10 = LoadLanes(pixels.y_by_u.data() + i);
    const Lanes j11 = LoadLanes(pixels.y_by_v.data() + i);
    const Lanes x_by_u = x_by_px * j00 + x_by_py * j10;
    const Lanes x_by_v = x_by_px * j01 + x_by_py * j11;
    const Lanes y_by_u = y_by_px * j00 + y_by_py * j10;
    const Lanes y_by_v = y_by_px * j01 + y_by_py * j11;
    const Lanes x_spread = Sqrt(x_by_u * x_by_u + x_by_v * x_by_v);
    const Lanes y_spread = Sqrt(y_by_u * y_by_u + y_by_v * y_by_v);
    const Lanes correlation = (x_by_u * y_by_u + x_by_v * y_by_v) / (x_spread * y_spread);
    const double blur = state.blur_px * cells.a_unit;
    WeightsAt((x + 1.0) * cells.a_unit + cells.first, blur * x_spread, us);
    WeightsAt((y + 1.0) * cells.a_unit + cells.first, blur * y_spread, vs);
    const Blurred blurred = BlurAt(cells, us, vs, correlation);
    const Lanes gain = state.gain[0] + state.gain[1] * x + state.gain[2] * y;
    const Lanes offset = state.offset[0] + state.offset[1] * x + state.offset[2] * y;
    StoreLanes(x, out.x.data() + i);
    StoreLanes(y, out.y.data() + i);
    StoreLanes(blurred.white, out.white.data() + i);
    // A blur's width in cells is blur times the spread; the cells by the square cancel.
    StoreLanes(gain * blurred.by_step[0] / (state.blur_px * x_spread), out.by_x.data() + i);
    StoreLanes(gain * blurred.by_step[1] / (state.blur_px * y_spread), out.by_y.data() + i);
    StoreLanes(gain * blurred.by_blur, out.by_blur.data() + i);
    const Lanes grey = LoadLanes(pixels.grey.data() + i);
    StoreLanes(grey - (gain * blurred.white + offset), out.residual.data() + i);
  }
}

constexpr std::size_t kRows = kTagUnknowns;
constexpr std::size_t kUpper = kRows * (kRows + 1) / 2;

struct Sums {
  std::array<double, kUpper> normal;
  std::array<double, kRows> right;
};

// Weights of the pixels that only fill up the last lanes are 0.
SEXTANT_MULTIVERSION
void Accumulate(const TagModel::Modelled& modelled, std::size_t count, double most, Sums& sums) {
  std::array<Lanes, kUpper> normal{};
  std::array<Lanes, kRows> right{};
  for (std::size_t i = 0; i < count; i += kLanes) {
    const Lanes x = LoadLanes(modelled.x.data() + i);
    const Lanes y = LoadLanes(modelled.y.data() + i);
    const Lanes by_x = LoadLanes(modelled.by_x.data() + i);
    const Lanes by_y = LoadLanes(modelled.by_y.data() + i);
    const Lanes white = LoadLanes(modelled.white.data() + i);
    const Lanes residual = LoadLanes(modelled.residual.data() + i);
    const Lanes along = x * by_x + y * by_y;
    const std::array<Lanes, kRows> row = {
        x * by_x,      y * by_x,   by_x,
        x * by_y,      y * by_y,   by_y,
        -x * along,    -y * along, LoadLanes(modelled.by_blur.data() + i),
        white,         white * x,  white * y,
        AllLanes(1.0), x,          y};
    Lanes weight = Min(AllLanes(1.0), most / Max(Abs(residual), AllLanes(1e-12)));
    for (std::size_t k = count - i; k < kLanes; ++k) weight[k] = 0.0;
    std::size_t next = 0;
    for (std::size_t a = 0; a < kRows; ++a) {
      const Lanes weighted = weight * row[a];
      right[a] += weighted * residual;
      for (std::size_t b = a; b < kRows; ++b) normal[next++] += weighted * row[b];
    }
  }
  for (std::size_t k = 0; k < kUpper; ++k) sums.normal[k] = SumLanes(normal[k]);
  for (std::size_t k = 0; k < kRows; ++k) sums.right[k] = SumLanes(right[k]);
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

void TagModel::Linearise(double most, TagNormal& normal, TagRow& right) const {
  Sums sums;
  Accumulate(modelled_, static_cast<std::size_t>(pixels_->count), most, sums);
  std::size_t next = 0;
  for (int a = 0; a < kTagUnknowns; ++a) {
    right[a] = sums.right[static_cast<std::size_t>(a)];
    for (int b = a; b < kTagUnknowns; ++b) normal(a, b) = normal(b, a) = sums.normal[next++];
  }
}

}  // namespace sextant
