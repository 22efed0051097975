// SPDX-License-Identifier: Apache-2.0
#include "calibrate/capture/live_session.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "calibrate/capture/live_pairs.h"
#include "calibrate/session/observe_files.h"
#include "io/boards/board_file.h"
#include "io/cameras/camera_file.h"

namespace sextant {
namespace {

using FilesByPath = std::map<std::filesystem::path, WatchedFile>;

FilesByPath ByPath(const std::vector<WatchedFile>& files) {
  FilesByPath by_path;
  for (const WatchedFile& file : files) by_path.emplace(file.path, file);
  return by_path;
}

std::vector<std::filesystem::path> PathsOf(const std::vector<WatchedFile>& files) {
  std::vector<std::filesystem::path> paths;
  for (const WatchedFile& file : files) paths.push_back(file.path);
  return paths;
}

// "board 0", "boards 0, 1", or "no board".
std::string BoardsIn(const std::vector<CameraSighting>& sightings,
                     const std::vector<Board>& boards) {
  std::string ids;
  for (const CameraSighting& sighting : sightings) {
    const Board& board = boards[static_cast<std::size_t>(sighting.board)];
    ids += fmt::format("{}{}", ids.empty() ? "" : ", ", board.id);
  }
  if (ids.empty()) return "no board";
  return (sightings.size() == 1 ? "board " : "boards ") + ids;
}

std::string PossibleBoards(std::size_t count) {
  if (count == 0) return "no board";
  return fmt::format("{} possible board{}", count, count == 1 ? "" : "s");
}

}  // namespace

Expected<LiveSession> LiveSession::Make(const std::filesystem::path& boards,
                                        const std::filesystem::path& camera,
                                        const CalibrateOptions& options, double tolerance_s) {
  SEXTANT_ASSIGN_OR_RETURN(std::vector<Board> known, ReadBoards(boards));
  SEXTANT_ASSIGN_OR_RETURN(const Camera lens, ReadCamera(camera));
  SEXTANT_ASSIGN_OR_RETURN(Observer observer,
                           Observer::Make(std::move(known), lens, options.observe));
  LiveSession session(std::move(observer), options, tolerance_s);
  session.session_.boards = boards;
  session.session_.camera = camera;
  return session;
}

bool LiveSession::Take(const FolderFiles& files) {
  const FilesByPath images = ByPath(files.images);
  const FilesByPath clouds = ByPath(files.clouds);
  session_.files = PairSoFar(PathsOf(files.images), PathsOf(files.clouds), tolerance_s_);
  std::map<std::filesystem::path, View*> before;  // By the photo, which is in one pair.
  for (View& view : views_) before.emplace(view.image.path, &view);
  std::vector<View> views;
  std::vector<FilePair> unseen;
  newest_.clear();
  std::size_t kept = 0;
  ++takes_;
  for (const FilePair& pair : session_.files.pairs) {
    View view{.image = images.at(pair.image), .cloud = clouds.at(pair.cloud), .arrival = takes_};
    const auto known = before.find(pair.image);
    if (known != before.end() && known->second->image == view.image &&
        known->second->cloud == view.cloud) {
      view.arrival = known->second->arrival;
      view.seen = std::move(known->second->seen);
      view.seen.name = pair.name;
      ++kept;
    } else {
      newest_.push_back(views.size());
      unseen.push_back(pair);
    }
    views.push_back(std::move(view));
  }
  const bool has_changed = !unseen.empty() || kept != views_.size();
  std::vector<SessionView> seen = ObserveFiles(observer_, unseen, {});
  for (std::size_t i = 0; i < seen.size(); ++i) views[newest_[i]].seen = std::move(seen[i]);
  views_ = std::move(views);
  return has_changed;
}

std::vector<std::size_t> LiveSession::ByArrival() const {
  std::vector<std::size_t> order(views_.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, [this](std::size_t a, std::size_t b) {
    return views_[a].arrival > views_[b].arrival;
  });
  return order;
}

Calibration LiveSession::Solve() const {
  ObservedSession observed{
      .session = session_, .boards = observer_.boards(), .camera = observer_.camera()};
  for (const View& view : views_) observed.views.push_back(view.seen);
  // A file without a partner is one whose partner is still to come.
  observed.session.files.without_partner.clear();
  return CalibrateObserved(std::move(observed), options_);
}

std::string DescribeSighting(const SessionView& view, const std::vector<Board>& boards) {
  if (!view.seen) return fmt::format("{}: {}", view.name, view.seen.error().message);
  const std::vector<CameraSighting>& in_photo = view.seen->in_image;
  const std::size_t in_scan = view.seen->in_scan.size();
  std::string text = fmt::format("{}: {} in the photo; {} in the scan", view.name,
                                 BoardsIn(in_photo, boards), PossibleBoards(in_scan));
  for (const CameraSighting& sighting : in_photo) {
    if (!sighting.left_out.empty()) text += fmt::format(" ({})", sighting.left_out);
  }
  for (const MissingBoard& missing : view.seen->missing) {
    const bool is_news = missing.image ? in_photo.empty() : in_scan == 0;
    if (is_news && !missing.why.empty()) text += fmt::format(" ({})", missing.why);
  }
  return text;
}

}  // namespace sextant
