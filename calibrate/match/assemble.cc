// SPDX-License-Identifier: Apache-2.0
#include "calibrate/match/assemble.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <numbers>
#include <set>
#include <utility>

#include "calibrate/match/sensor_agreement.h"

namespace sextant {
namespace {

// Why a board was not found in the image, or in the scan.
std::string WhyMissing(const Observation& seen, int board, bool image) {
  for (const MissingBoard& missing : seen.missing) {
    if (missing.image == image && (missing.board == board || missing.board < 0)) return missing.why;
  }
  return image ? "not found" : "every board-like patch belongs to another board";
}

class Rows {
 public:
  Rows(std::span<const SessionView> views, std::span<const Board> boards, const Matching& matching,
       std::span<const std::optional<std::size_t>> copies, const MatchSettings& settings)
      : views_(views), boards_(boards), copies_(copies), max_apart_m_(MaxApart(settings)) {
    for (const MatchedBoard& kept : matching.kept) {
      fates_[{Index(kept.view), BoardOf(kept)}] = {.fate = BoardStatus::kKept};
    }
    for (const DroppedBoard& dropped : matching.dropped) {
      fates_[{Index(dropped.match.view), BoardOf(dropped.match)}] = {
          .fate = BoardStatus::kDisagrees,
          .why = fmt::format(
              "its corners are {:.0f} mm and its face {:.1f} deg off the pose of the other views: "
              "image and scan of different moments, or not this board",
              1e3 * dropped.off_m, dropped.off_rad * 180.0 / std::numbers::pi)};
    }
  }

  std::vector<BoardRow> All() const {
    std::vector<BoardRow> rows;
    for (std::size_t i = 0; i < views_.size(); ++i) {
      const SessionView& view = views_[i];
      if (!view.seen) {
        rows.push_back({i, -1, BoardStatus::kUnreadable, view.seen.error().message});
      } else if (!copies_.empty() && copies_[i]) {
        rows.push_back({i, -1, BoardStatus::kCopy,
                        fmt::format("its image and scan are those of view {}, so it adds nothing",
                                    views_[*copies_[i]].name)});
      } else {
        for (int b = 0; b < static_cast<int>(boards_.size()); ++b) rows.push_back(RowOf(i, b));
      }
    }
    return rows;
  }

 private:
  static std::size_t Index(int i) { return static_cast<std::size_t>(i); }

  int BoardOf(const MatchedBoard& match) const {
    return views_[Index(match.view)].seen->in_image[Index(match.sighting)].board;
  }

  BoardRow RowOf(std::size_t view, int board) const {
    BoardRow row{.view = view, .board = board};
    const auto known = fates_.find({view, board});
    if (known != fates_.end()) {
      row.fate = known->second.fate;
      row.why = known->second.why;
      return row;
    }
    const Observation& seen = *views_[view].seen;
    const auto sighting = std::ranges::find(seen.in_image, board, &CameraSighting::board);
    const bool in_image = sighting != seen.in_image.end();
    if (in_image && !sighting->left_out.empty()) {
      row.fate = BoardStatus::kLeftOut;
      row.why = sighting->left_out;
      return row;
    }
    if (in_image) {
      const auto index = static_cast<int>(sighting - seen.in_image.begin());
      if (const auto why = WhyNoneIsSameBoard(seen, index, max_apart_m_)) {
        row.fate = BoardStatus::kDisagrees;
        row.why = *why;
        return row;
      }
    }
    row.fate = in_image ? BoardStatus::kNotInScan : BoardStatus::kNotInImage;
    row.why = WhyMissing(seen, board, !in_image);
    return row;
  }

  std::span<const SessionView> views_;
  std::span<const Board> boards_;
  std::span<const std::optional<std::size_t>> copies_;
  double max_apart_m_;
  std::map<std::pair<std::size_t, int>, BoardRow> fates_;
};

// Appends the first boards that are not used, with their reasons.
void ListRows(std::span<const SessionView> views, std::span<const Board> boards,
              const std::vector<BoardRow>& rows, Error& error) {
  constexpr std::size_t kShown = 3;
  std::size_t shown = 0;
  for (const BoardRow& row : rows) {
    if (row.fate == BoardStatus::kKept || row.fate == BoardStatus::kLeftOut) continue;
    if (++shown > kShown) break;
    const std::string board =
        row.board < 0 ? std::string()
                      : fmt::format(", board {}", boards[static_cast<std::size_t>(row.board)].id);
    error.AddLine(
        fmt::format("view {}{}: {}: {}", views[row.view].name, board, ToString(row.fate), row.why));
  }
}

// The views whose image shows a board, by what the scans show of it.
struct Support {
  std::size_t kept = 0;
  std::size_t missing = 0;
  std::size_t disagreeing = 0;

  std::size_t All() const { return kept + missing + disagreeing; }
};

Support SupportOf(const std::vector<BoardRow>& rows) {
  std::map<std::size_t, std::set<BoardStatus>> views;
  for (const BoardRow& row : rows) views[row.view].insert(row.fate);
  Support support;
  for (const auto& [view, fates] : views) {
    if (fates.contains(BoardStatus::kKept)) {
      ++support.kept;
    } else if (fates.contains(BoardStatus::kDisagrees)) {
      ++support.disagreeing;
    } else if (fates.contains(BoardStatus::kNotInScan)) {
      ++support.missing;
    }
  }
  return support;
}

// A pose that most views do not support may be that of another object.
Expected<void> CheckSupport(std::span<const SessionView> views, std::span<const Board> boards,
                            const std::vector<BoardRow>& rows) {
  const Support support = SupportOf(rows);
  const bool contradicted = support.disagreeing > 0 && support.disagreeing >= support.kept;
  if (2 * support.kept >= support.All() && !contradicted) return {};
  Error error(ErrorCode::kMissingData,
              fmt::format("no pose: of {} views whose photo shows a board, the scan agrees in {}, "
                          "disagrees in {} and shows no board in {}. What a minority of the views "
                          "agrees on may be another object",
                          support.All(), support.kept, support.disagreeing, support.missing));
  ListRows(views, boards, rows, error);
  return tl::unexpected<Error>(std::move(error));
}

}  // namespace

std::string_view ToString(BoardStatus fate) {
  switch (fate) {
    case BoardStatus::kKept:
      return "kept";
    case BoardStatus::kUnreadable:
      return "unreadable";
    case BoardStatus::kLeftOut:
      return "left out";
    case BoardStatus::kNotInImage:
      return "not in the image";
    case BoardStatus::kNotInScan:
      return "not in the scan";
    case BoardStatus::kDisagrees:
      return "disagrees";
    case BoardStatus::kContradicts:
      return "left out";
    case BoardStatus::kCopy:
      return "copy";
  }
  return "unknown";
}

Expected<Assembly> Assemble(std::span<const SessionView> views, std::span<const Board> boards,
                            const Camera& camera, const MatchSettings& settings) {
  // Views that could not be read take part as empty ones, so that indices stay those of the
  // session.
  std::vector<Observation> observations(views.size());
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (views[i].seen) observations[i] = *views[i].seen;
  }
  const std::vector<std::optional<std::size_t>> copies = FindCopies(observations);
  for (std::size_t i = 0; i < views.size(); ++i) {
    if (copies[i]) observations[i] = {};
  }
  Expected<Matching> matching = MatchViews(observations, settings);
  if (!matching && matching.error().code == ErrorCode::kTooFewPairs) {
    Error error(ErrorCode::kMissingData,
                fmt::format("no board was seen by both sensors in any of {} views, so there is "
                            "nothing to calibrate from",
                            views.size()));
    ListRows(views, boards, Rows(views, boards, {}, copies, settings).All(), error);
    return tl::unexpected<Error>(std::move(error));
  }
  if (!matching) return tl::unexpected<Error>(matching.error());
  Assembly assembly;
  CalibrationProblem& problem = assembly.problem;
  problem.camera = camera;
  problem.boards.assign(boards.begin(), boards.end());
  problem.initial_cam_from_lidar = matching->cam_from_lidar;
  for (const MatchedBoard& kept : matching->kept) {
    const Observation& seen = observations[static_cast<std::size_t>(kept.view)];
    problem.board_views.push_back(MakeBoardView(seen, kept, boards));
    problem.board_views.back().name = views[static_cast<std::size_t>(kept.view)].name;
    AppendPairs(seen, kept, boards, matching->cam_from_lidar, problem);
  }
  assembly.repeated = FindRepeatedPlacements(observations, matching->kept, settings.floor_m);
  CountPlacementsOnce(assembly.repeated, boards, problem);
  problem.point_sets = WithholdPairing(problem.pairs_3d3d);
  assembly.rows = Rows(views, boards, *matching, copies, settings).All();
  SEXTANT_RETURN_IF_ERROR(CheckSupport(views, boards, assembly.rows));
  assembly.matching = std::move(*matching);
  return assembly;
}

}  // namespace sextant
