// SPDX-License-Identifier: Apache-2.0
#include "calibrate/match/motion.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

namespace sextant {
namespace {

CameraSighting* Find(SessionView& view, int board) {
  if (!view.seen) return nullptr;
  const auto found = std::ranges::find(view.seen->in_image, board, &CameraSighting::board);
  return found == view.seen->in_image.end() ? nullptr : &*found;
}

// Speed [m/s] between two views; none where it is unknown.
std::optional<double> Speed(const CameraSighting* a, const CameraSighting* b, double gap_s,
                            const Camera& camera, double max_gap_s) {
  if (a == nullptr || b == nullptr || gap_s > max_gap_s || gap_s <= 0.0) return std::nullopt;
  const std::optional<double> moved = MovedBetween(*a, *b, camera);
  if (!moved) return std::nullopt;
  return *moved / gap_s;
}

class BoardOverTime {
 public:
  BoardOverTime(std::vector<SessionView>& views, std::span<const double> times_s,
                const Camera& camera, const MotionOptions& options, int board)
      : times_s_(times_s), camera_(camera), options_(options) {
    for (SessionView& view : views) sightings_.push_back(Find(view, board));
  }

  void LeaveOutMoving() {
    std::vector<std::optional<double>> speeds;  // From view i to i + 1.
    for (std::size_t i = 0; i + 1 < sightings_.size(); ++i) {
      speeds.push_back(Speed(sightings_[i], sightings_[i + 1], times_s_[i + 1] - times_s_[i],
                             camera_, options_.max_gap_s));
    }
    for (std::size_t i = 0; i < sightings_.size(); ++i) {
      if (sightings_[i] == nullptr) continue;
      std::optional<double> slowest;
      if (i > 0) slowest = speeds[i - 1];
      if (i < speeds.size() && speeds[i] && (!slowest || *speeds[i] < *slowest)) {
        slowest = speeds[i];
      }
      if (!slowest || *slowest <= options_.still_m_s) continue;
      sightings_[i]->left_out = fmt::format(
          "it moves, by {:.2f} m/s or more relative to the neighbouring images", *slowest);
    }
  }

  void ThinPlaces() {
    std::vector<CameraSighting*> place;
    for (CameraSighting* sighting : sightings_) {
      if (sighting == nullptr || !sighting->left_out.empty()) continue;
      if (!place.empty()) {
        const std::optional<double> moved = MovedBetween(*place.front(), *sighting, camera_);
        if (!moved || *moved > options_.same_place_m) {
          Thin(place);
          place.clear();
        }
      }
      place.push_back(sighting);
    }
    Thin(place);
  }

 private:
  void Thin(const std::vector<CameraSighting*>& place) const {
    const std::size_t count = place.size();
    const auto max = static_cast<std::size_t>(options_.max_per_place);
    if (count <= max) return;
    std::vector<bool> is_kept(count, false);
    for (std::size_t k = 0; k < max; ++k) is_kept[k * count / max] = true;
    for (std::size_t i = 0; i < count; ++i) {
      if (is_kept[i]) continue;
      place[i]->left_out =
          fmt::format("it has not moved since: {} of {} views of this place are used", max, count);
    }
  }

  std::span<const double> times_s_;
  const Camera& camera_;
  const MotionOptions& options_;
  std::vector<CameraSighting*> sightings_;  // One per view; null where the board was not seen.
};

}  // namespace

std::optional<double> MovedBetween(const CameraSighting& a, const CameraSighting& b,
                                   const Camera& camera) {
  double squares = 0.0;
  int count = 0;
  for (const BoardPoints& first : a.printed) {
    for (const BoardPoints& second : b.printed) {
      if (first.in_board_m != second.in_board_m) continue;
      for (std::size_t i = 0; i < first.pixels.size(); ++i) {
        squares += (first.pixels[i] - second.pixels[i]).squaredNorm();
        ++count;
      }
    }
  }
  if (count == 0) return std::nullopt;
  const double range = a.pose.cam_from_board.translation.norm();
  return std::sqrt(squares / count) * range / std::sqrt(camera.fx_px * camera.fy_px);
}

void LeaveOutMotion(std::vector<SessionView>& views, std::span<const double> times_s,
                    const Camera& camera, const MotionOptions& options) {
  int boards = 0;
  for (const SessionView& view : views) {
    if (!view.seen) continue;
    for (const CameraSighting& sighting : view.seen->in_image) {
      boards = std::max(boards, sighting.board + 1);
    }
  }
  for (int b = 0; b < boards; ++b) {
    BoardOverTime board(views, times_s, camera, options, b);
    board.LeaveOutMoving();
    board.ThinPlaces();
  }
}

}  // namespace sextant
