// SPDX-License-Identifier: Apache-2.0
#include "calibrate/observe/observe.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/median.h"
#include "calibrate/observe/face_returns.h"
#include "features/camera/explain_missing.h"
#include "features/camera/grey_image.h"
#include "features/camera/tags/tag_pattern.h"

namespace sextant {
namespace {

constexpr std::ptrdiff_t kMaxOthers = 4;
constexpr double kSameRange_m = 0.5;

// The reason why a board has no pose in the image.
std::string WhyUnseen(const Board& board, const SeenBoard& seen) {
  if (seen.pose) return seen.pose->error().message;
  if (!seen.duplicate_tags.empty()) {
    return fmt::format("its tag {} appears more than once in the image, so it is not used",
                       board.tags[seen.duplicate_tags.front()].id);
  }
  if (board.tags.size() > 1) {
    return fmt::format("none of its {} tags of {} was found", board.tags.size(),
                       board.tags.front().family);
  }
  if (!board.tags.empty()) {
    return fmt::format("tag {} of {} was not found", board.tags.front().id,
                       board.tags.front().family);
  }
  return fmt::format("no checkerboard of {} x {} inner corners was found",
                     board.checker->inner_columns, board.checker->inner_rows);
}

TagPattern MirrorImageOf(const TagPattern& pattern) {
  TagPattern mirrored = pattern;
  for (auto row = mirrored.white.begin(); row != mirrored.white.end(); row += pattern.cells) {
    std::reverse(row, row + pattern.cells);
  }
  return mirrored;
}

// Whether a mirror image of `seen` reads as the other tag of its family.
bool IsMirrorImage(const TagPattern& seen, const std::string& family, int id) {
  const Expected<TagPattern> other = MakeTagPattern(family, id);
  return other && QuarterTurns(MirrorImageOf(seen), *other);
}

// Whether a tag of a board shows that the image is as it should be: in a mirrored one it could be
// seen only if its mirror image were a tag of the boards.
bool ShowsNoMirroring(const BoardTag& seen, const std::vector<Board>& boards) {
  const Expected<TagPattern> pattern = MakeTagPattern(seen.family, seen.id);
  if (!pattern) return true;
  return std::ranges::none_of(boards, [&](const Board& board) {
    return std::ranges::any_of(board.tags, [&](const BoardTag& tag) {
      return tag.family == seen.family && IsMirrorImage(*pattern, tag.family, tag.id);
    });
  });
}

// The same for a tag of no board: any tag of its family may hang in the scene. Slow, a pattern for
// each id.
bool ShowsNoMirroring(const TagDetection& other) {
  const Expected<TagPattern> pattern = MakeTagPattern(other.family, other.id);
  const Expected<int> count = TagCount(other.family);
  if (!pattern || !count) return true;
  for (int id = 0; id < *count; ++id) {
    if (IsMirrorImage(*pattern, other.family, id)) return false;
  }
  return true;
}

bool ShowsNoMirroring(const std::vector<Board>& boards, const SeenBoard& seen) {
  const std::vector<BoardTag>& tags = boards[seen.index].tags;
  return std::ranges::any_of(
             seen.tags,
             [&](const SeenTag& tag) { return ShowsNoMirroring(tags[tag.index], boards); }) ||
         std::ranges::any_of(seen.duplicate_tags, [&](std::size_t index) {
           return ShowsNoMirroring(tags[index], boards);
         });
}

// The first tag of the boards that is missing, and found without an error in the mirror image.
const BoardTag* FirstMirrored(const cv::Mat& grey, const std::vector<Board>& boards,
                              const SeenBoards& seen) {
  TagTrials trials(grey);
  for (const SeenBoard& board : seen.boards) {
    for (const std::size_t missing : board.missing_tags) {
      const BoardTag& tag = boards[board.index].tags[missing];
      const std::optional<TagDetection> found = trials.InMirrorImage(tag);
      if (found && found->hamming == 0) return &tag;
    }
  }
  return nullptr;
}

// Why the image is a mirror image; none where a tag was found that no mirrored image shows, and
// where none that is missing is in the mirror image. A checkerboard alone does not show it.
std::optional<std::string> WhyMirrored(const cv::Mat& grey, const std::vector<Board>& boards,
                                       const SeenBoards& seen) {
  const auto denies = [&](const SeenBoard& board) { return ShowsNoMirroring(boards, board); };
  if (std::ranges::any_of(seen.boards, denies)) return std::nullopt;
  const BoardTag* const tag = FirstMirrored(grey, boards, seen);
  if (tag == nullptr) return std::nullopt;
  const auto other_denies = [](const TagDetection& other) { return ShowsNoMirroring(other); };
  if (std::ranges::any_of(seen.other_tags, other_denies)) return std::nullopt;
  return fmt::format(
      "it is mirrored: tag {} of {} is found in its mirror image only, so every pose from it would "
      "be wrong; switch off the mirroring of the camera or of the program that wrote the image, or "
      "print the tag unmirrored",
      tag->id, tag->family);
}

CameraSighting MakeSighting(const Board& board, const SeenBoard& seen) {
  CameraSighting sighting{.board = static_cast<int>(seen.index),
                          .printed = seen.printed,
                          .pose = **seen.pose,
                          .corners = seen.corners};
  if (sighting.pose.ambiguous_with) {
    for (const Eigen::Vector3d& corner : BoardCorners(board)) {
      sighting.other_corners.push_back(*sighting.pose.ambiguous_with * corner);
    }
  }
  return sighting;
}

// The median elevation of each ring that has returns.
LidarPattern PatternOf(const ScanRings& rings, const LidarBeam& beam) {
  LidarPattern pattern{.azimuth_step_rad = rings.azimuth_step_rad(),
                       .range_sigma_m = rings.range_sigma_m(),
                       .aperture_m = beam.aperture_h_m,
                       .divergence_rad = beam.divergence_h_rad};
  for (int i = 0; i < rings.rings(); ++i) {
    std::vector<double> elevations;
    for (const RingPoint& point : rings.ring(i)) {
      elevations.push_back(std::asin(point.point.z() / point.range_m));
    }
    if (elevations.empty()) continue;
    pattern.elevations_rad.push_back(UpperMedian(elevations));
  }
  std::ranges::sort(pattern.elevations_rad);
  return pattern;
}

// Lengths of the placement's sides by lines through its edge points; empty where these are too few.
std::vector<double> MeasuredSides(const BoardPatch& patch, const BoardPlacement& placement,
                                  const Board& board) {
  BoardPatch placed = patch;
  placed.fit = placement.fit;
  const Expected<LidarCorners> corners = ExtractCorners("plane_lines", placed, board);
  if (!corners) return {};
  const std::vector<double>& lengths = corners->checks.edge_lengths_m;
  return {lengths.begin(), lengths.begin() + kCornersPerBoard};
}

// The rejected patches nearest to where the image shows a board; without one, those with the most
// points.
std::vector<RejectedPatch> MostLikely(const BoardSearch& search,
                                      const std::vector<CameraSighting>& in_image) {
  constexpr std::size_t kMaxNamed = 2;
  std::vector<RejectedPatch> patches = search.rejected;
  if (!in_image.empty()) {
    const auto off = [&](const RejectedPatch& patch) {
      double least = std::numeric_limits<double>::infinity();
      for (const CameraSighting& sighting : in_image) {
        least = std::min(least, std::abs(patch.center_in_lidar.norm() -
                                         sighting.pose.cam_from_board.translation.norm()));
      }
      return std::round(least / kSameRange_m);
    };
    std::ranges::stable_sort(patches, {}, off);
  }
  patches.resize(std::min(kMaxNamed, patches.size()));
  return patches;
}

std::string WhyNotInScan(const BoardSearch& search, std::span<const Board> boards,
                         const std::vector<CameraSighting>& in_image) {
  std::string text;
  if (search.found.empty()) {
    text = fmt::format("the scan shows no board of {:.3f} x {:.3f} m", boards[0].top_right_m,
                       boards[0].right_bottom_m);
  } else {
    text = fmt::format("the scan shows {} of {} boards", search.found.size(), boards.size());
  }
  for (const CameraSighting& sighting : in_image) {
    text += fmt::format("; the photo shows board {} {:.1f} m away",
                        boards[static_cast<std::size_t>(sighting.board)].id,
                        sighting.pose.cam_from_board.translation.norm());
  }
  for (const RejectedPatch& patch : MostLikely(search, in_image)) {
    text += fmt::format("; not the flat object {:.1f} m away at ({:.2f}, {:.2f}, {:.2f}) m: {}",
                        patch.center_in_lidar.norm(), patch.center_in_lidar.x(),
                        patch.center_in_lidar.y(), patch.center_in_lidar.z(), patch.why);
  }
  return text;
}

}  // namespace

Expected<Observer> Observer::Make(std::vector<Board> boards, const Camera& camera,
                                  const ObserveOptions& options) {
  if (boards.empty()) {
    return MakeError(ErrorCode::kInvalidInput,
                     "expected at least one known board to look for, got none");
  }
  if (const auto known = ExtractCorners(options.extractor, {}, {});
      !known && known.error().code == ErrorCode::kUnknownName) {
    return tl::unexpected<Error>(known.error());
  }
  for (const Board& board : boards) {
    if (board.top_right_m > 0.0 && board.right_bottom_m > 0.0) continue;
    return MakeError(ErrorCode::kInvalidInput,
                     fmt::format("board {} has no size ({} x {} m)", board.id, board.top_right_m,
                                 board.right_bottom_m));
  }
  SEXTANT_ASSIGN_OR_RETURN(BoardFinder finder,
                           BoardFinder::Make(std::move(boards), camera, options.detector));
  return Observer(std::move(finder), options);
}

Expected<Observation> Observer::Observe(const cv::Mat& image, const PointCloud& cloud) const {
  Observation observation;
  if (Expected<void> ok = ObserveImage(image, observation); !ok) {
    return MakeError(ok.error().code, "image: " + ok.error().message);
  }
  if (Expected<void> ok = ObserveScan(cloud, observation); !ok) {
    return MakeError(ok.error().code, "scan: " + ok.error().message);
  }
  return observation;
}

Expected<void> Observer::ObserveImage(const cv::Mat& image, Observation& observation) const {
  SEXTANT_ASSIGN_OR_RETURN(const cv::Mat grey, ToGrey(image));
  SEXTANT_ASSIGN_OR_RETURN(const SeenBoards seen, finder_.Find(grey));
  if (const auto why = WhyMirrored(grey, boards(), seen)) {
    return MakeError(ErrorCode::kMirrored, *why);
  }
  for (const SeenBoard& board : seen.boards) {
    if (board.pose && *board.pose) {
      observation.in_image.push_back(MakeSighting(boards()[board.index], board));
    } else {
      observation.missing.push_back({.board = static_cast<int>(board.index),
                                     .image = true,
                                     .why = WhyUnseen(boards()[board.index], board)});
    }
  }
  return {};
}

Expected<void> Observer::ObserveScan(const PointCloud& cloud, Observation& observation) const {
  SEXTANT_ASSIGN_OR_RETURN(const ScanRings rings, ScanRings::Build(cloud));
  observation.lidar = PatternOf(rings, options_.search.beam);
  SEXTANT_ASSIGN_OR_RETURN(const BoardSearch search, FindBoards(rings, boards(), options_.search));
  // Further patches compete, because the image may distinguish them by their distance.
  std::vector<BoardPatch> patches = search.found;
  patches.insert(patches.end(), search.others.begin(),
                 search.others.begin() + std::min(kMaxOthers, std::ssize(search.others)));
  for (const BoardPatch& patch : patches) {
    std::string why;
    SEXTANT_ASSIGN_OR_RETURN(std::vector<BoardPlacement> placements,
                             PlaceBoards(patch, boards(), options_.extractor, why));
    if (placements.empty()) {
      observation.missing.push_back({.why = why});
      continue;
    }
    FaceOfBoard face = FaceReturns(rings, patch, boards());
    LidarSighting sighting{.placements = std::move(placements),
                           .plane = patch.plane,
                           .edges = patch.edges,
                           .face = std::move(face.in_lidar),
                           .face_rings = std::move(face.rings)};
    sighting.range_sigma_m = RangeSigma(sighting.face, patch.plane);
    sighting.measured_sides_m =
        MeasuredSides(patch, sighting.placements.front(),
                      boards()[static_cast<std::size_t>(sighting.placements.front().board)]);
    observation.in_scan.push_back(std::move(sighting));
  }
  if (search.found.size() < boards().size()) {
    observation.missing.push_back({.why = WhyNotInScan(search, boards(), observation.in_image)});
  }
  return {};
}

}  // namespace sextant
