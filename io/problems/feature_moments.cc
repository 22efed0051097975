// SPDX-License-Identifier: Apache-2.0
#include "io/problems/feature_moments.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <set>
#include <tuple>

#include "base/nearest_name.h"
#include "io/text/number_text.h"

namespace sextant {
namespace {

// Stamps of one moment may be late by the jitter of a recording.
constexpr double kJitter_s = 0.02;

/// Puts the rows into the observations of a problem.
class FeatureCollector {
 public:
  FeatureCollector(const FeatureTable& table, const std::map<int, FeatureBoard>& boards,
                   RigProblem& problem)
      : rows_(table.rows), file_(table.file), boards_(boards), problem_(problem) {
    for (std::size_t i = 0; i < problem.placements.size(); ++i) {
      const RigPlacement& placement = problem.placements[i];
      placements_[{placement.moment, placement.board}] = i;
      next_moment_ = std::max(next_moment_, placement.moment + 1);
      if (!placement.name.empty()) moments_[placement.name] = placement.moment;
      for (std::size_t k = 0; k < placement.seen.size(); ++k) AddKeys({i, k}, placement.seen[k]);
    }
  }

  Expected<void> Run() {
    for (const FeatureRow& row : rows_) {
      if (!error_) Add(row);
    }
    for (auto& [key, pixels] : pixels_) Store(key, std::move(pixels));
    if (error_) return tl::unexpected<Error>(*error_);
    std::ranges::stable_sort(problem_.placements, [](const RigPlacement& a, const RigPlacement& b) {
      return std::tie(a.moment, a.board) < std::tie(b.moment, b.board);
    });
    return {};
  }

 private:
  /// Placement, and index of the observation in it.
  using Spot = std::pair<std::size_t, std::size_t>;
  struct Pixels {
    BoardPoints points;
    std::vector<double> sigmas;
  };

  // What earlier tables, or the rig file, state already.
  void AddKeys(const Spot& spot, const RigObservation& seen) {
    for (const BoardPoints& printed : seen.raw.printed) {
      for (const Eigen::Vector2d& at : printed.in_board_m) {
        pixel_keys_.insert({spot.first, spot.second, at.x(), at.y()});
      }
    }
    for (const MeasuredPoint& point : seen.points) {
      point_keys_.insert({spot.first, spot.second, point.in_board_m.x(), point.in_board_m.y()});
    }
  }

  void Fail(const FeatureRow& row, const std::string& message) {
    if (error_) return;
    error_ =
        Error{ErrorCode::kParse, ToString(Place{.file = file_, .line = row.line}) + ": " + message};
  }

  std::optional<std::size_t> SensorOf(const FeatureRow& row) {
    std::vector<std::string> names;
    for (std::size_t s = 0; s < problem_.sensors.size(); ++s) {
      if (problem_.sensors[s].name == row.sensor) return s;
      names.push_back(problem_.sensors[s].name);
    }
    Fail(row, fmt::format("no sensor {} in the rig file; there are: {}", Quoted(row.sensor),
                          fmt::join(names, ", ")));
    return std::nullopt;
  }

  const FeatureBoard* BoardOf(const FeatureRow& row) {
    if (!row.board && boards_.size() == 1) return &boards_.begin()->second;
    if (!row.board) {
      Fail(row, fmt::format("expected a board, as the rig file has {}", boards_.size()));
      return nullptr;
    }
    const auto at = boards_.find(*row.board);
    if (at != boards_.end()) return &at->second;
    Fail(row, fmt::format("the rig file has no board {}", *row.board));
    return nullptr;
  }

  Spot SpotOf(const FeatureRow& row, int board, std::size_t sensor) {
    const auto [number, is_new] = moments_.try_emplace(row.moment, next_moment_);
    if (is_new) ++next_moment_;
    const auto [at, is_first] =
        placements_.try_emplace({number->second, board}, problem_.placements.size());
    if (is_first) problem_.placements.push_back({number->second, board, row.moment, {}});
    auto& seen = problem_.placements[at->second].seen;
    const auto same = std::ranges::find_if(seen, [&](const RigObservation& one) {
      return one.sensor == sensor && one.time_s == row.time_s;
    });
    const auto index = static_cast<std::size_t>(same - seen.begin());
    if (same == seen.end()) seen.push_back({.sensor = sensor, .time_s = row.time_s});
    return {at->second, index};
  }

  std::optional<Eigen::Vector2d> InBoard(const FeatureRow& row, const FeatureBoard& board) {
    if (row.in_board_m) return row.in_board_m;
    if (*row.corner < std::ssize(board.points)) {
      return board.points[static_cast<std::size_t>(*row.corner)];
    }
    Fail(row, fmt::format("corner {}: board {} has the points 0 to {}", *row.corner, board.board.id,
                          board.points.size() - 1));
    return std::nullopt;
  }

  void Add(const FeatureRow& row) {
    const auto sensor = SensorOf(row);
    if (!sensor) return;
    const FeatureBoard* board = BoardOf(row);
    if (board == nullptr) return;
    const Spot spot = SpotOf(row, board->board.id, *sensor);
    if (row.pixel || row.position_m) AddPoint(row, *board, spot);
    RigObservation& seen = problem_.placements[spot.first].seen[spot.second];
    if (row.plane) {
      if (seen.plane)
        return Fail(row, "the plane of this moment, sensor and board is a second one");
      seen.plane = row.plane;
    }
    if (row.side) AddSide(row, *board, seen);
  }

  void AddPoint(const FeatureRow& row, const FeatureBoard& board, const Spot& spot) {
    const auto in_board = InBoard(row, board);
    if (!in_board) return;
    const auto key = std::tuple(spot.first, spot.second, in_board->x(), in_board->y());
    if (row.pixel) {
      if (!pixel_keys_.insert(key).second) return Fail(row, "the pixel of this corner is a second");
      Pixels& pixels = pixels_[spot];
      if (std::ssize(pixels.sigmas) == kMaxPointsSeen) {
        return Fail(row, fmt::format("expected at most {} points of one board", kMaxPointsSeen));
      }
      pixels.points.in_board_m.push_back(*in_board);
      pixels.points.pixels.push_back(*row.pixel);
      pixels.sigmas.push_back(row.sigma_px.value_or(kUsualSigma_px));
    }
    if (!row.position_m) return;
    if (!point_keys_.insert(key).second) return Fail(row, "the point of this corner is a second");
    MeasuredPoint point{.in_sensor_m = *row.position_m};
    point.in_board_m << *in_board, 0.0;
    point.sigma_m = row.sigma_m.value_or(point.sigma_m);
    problem_.placements[spot.first].seen[spot.second].points.push_back(point);
  }

  void AddSide(const FeatureRow& row, const FeatureBoard& board, RigObservation& seen) {
    if (!board.has_size) {
      return Fail(row, fmt::format("the line of a side needs the size of board {}: state "
                                   "top_right_m and right_bottom_m",
                                   board.board.id));
    }
    if (!board.board.HasSide(row.side->side) || row.side->side >= kFirstRim) {
      return Fail(
          row, fmt::format("side {}: expected 0 top, 1 right, 2 bottom, 3 left", row.side->side));
    }
    if (std::ranges::count(seen.lines, row.side->side, &MeasuredLine::side) > 0) {
      return Fail(row, "the line of this side is a second one");
    }
    seen.lines.push_back(*row.side);
  }

  void Store(const Spot& spot, Pixels pixels) {
    const auto size = 2 * std::ssize(pixels.sigmas);
    pixels.points.covariance_px2 = Eigen::MatrixXd::Zero(size, size);
    for (Eigen::Index i = 0; i < size; ++i) {
      const double sigma = pixels.sigmas[static_cast<std::size_t>(i / 2)];
      pixels.points.covariance_px2(i, i) = sigma * sigma;
    }
    problem_.placements[spot.first].seen[spot.second].raw.printed.push_back(
        std::move(pixels.points));
  }

  const std::vector<FeatureRow>& rows_;
  const std::string& file_;
  const std::map<int, FeatureBoard>& boards_;
  RigProblem& problem_;
  std::map<std::string, int, std::less<>> moments_;
  int next_moment_ = 0;
  std::map<std::pair<int, int>, std::size_t> placements_;
  std::map<Spot, Pixels> pixels_;
  std::set<std::tuple<std::size_t, std::size_t, double, double>> pixel_keys_;
  std::set<std::tuple<std::size_t, std::size_t, double, double>> point_keys_;
  std::optional<Error> error_;
};

// Names the moments of rows that only have a time: by the first time of each moment.
void NameMoments(std::vector<FeatureTable>& tables) {
  std::vector<FeatureRow*> timed;
  for (FeatureTable& table : tables) {
    for (FeatureRow& row : table.rows) {
      if (row.moment.empty()) timed.push_back(&row);
    }
  }
  std::ranges::stable_sort(
      timed, [](const FeatureRow* a, const FeatureRow* b) { return *a->time_s < *b->time_s; });
  std::optional<double> first;
  for (FeatureRow* row : timed) {
    if (!first || *row->time_s > *first + kMoment_s + kJitter_s) first = *row->time_s;
    row->moment = fmt::format("{:.3f} s", *first);
  }
}

}  // namespace

Expected<void> AddFeatures(std::vector<FeatureTable> tables,
                           const std::map<int, FeatureBoard>& boards, RigProblem& problem) {
  NameMoments(tables);
  for (const FeatureTable& table : tables) {
    SEXTANT_RETURN_IF_ERROR(FeatureCollector(table, boards, problem).Run());
  }
  return {};
}

}  // namespace sextant
