// SPDX-License-Identifier: Apache-2.0
#include "features/camera/plate_outline.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <vector>

#include "base/median.h"
#include "features/camera/board_pose.h"
#include "features/camera/grey_image.h"
#include "features/camera/plate_candidates.h"
#include "features/camera/undistortion.h"
#include "geometry/board_check.h"

namespace sextant {
namespace {

using Matrix8 = Eigen::Matrix<double, 8, 8>;

constexpr double kMinStep_grey = 8.0;   // Across a side, within two pixels.
constexpr double kMinSeen = 0.55;       // Of a side's samples within the image.
constexpr double kNearSide_px = 1.5;    // Of samples of one straight side.
constexpr double kSideFloor_px = 0.3;   // Of a side's place: bevels, blur, uneven light.
constexpr double kMaxChiSquare = 20.0;  // Of two degrees of freedom.
constexpr double kSameOutline = 0.04;   // Distance of corners, by the longest side.
constexpr double kEvenShare = 0.9;      // Of the plate's pixels that are of even grey.
constexpr double kEvenGrey = 0.3;       // Of the step at its sides.

// A side as a straight line of the undistorted image.
struct PlateSide {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  double angle_rad = 0.0;
  double sigma_px = 0.0;  // Across, at its middle.
  double sigma_rad = 0.0;
  double step_grey = 0.0;  // Median, across it.

  Line2 Moved(double across_px, double turned_rad) const {
    const double angle = angle_rad + turned_rad;
    const Eigen::Vector2d normal(std::sin(angle), -std::cos(angle));
    return {normal, normal.dot(middle) + across_px};
  }
};

struct SideSample {
  Eigen::Vector2d straight_px = Eigen::Vector2d::Zero();
  double step_grey = 0.0;
};

// The place of the largest step across a side, from the plate outward, with its size.
std::optional<SideSample> SampleAt(const cv::Mat& grey, const Undistortion& undistortion,
                                   const Eigen::Vector2d& on_side, const Eigen::Vector2d& outward,
                                   int reach_px, double sign) {
  std::vector<double> levels;
  for (int i = -reach_px - 1; i <= reach_px + 1; ++i) {
    levels.push_back(GreyAt(grey, on_side + i * outward));
    if (levels.back() < 0.0) return std::nullopt;
  }
  const auto step = [&](std::size_t i) { return sign * (levels[i + 1] - levels[i - 1]); };
  std::size_t best = 1;
  for (std::size_t i = 2; i + 1 < levels.size(); ++i) {
    if (step(i) > step(best)) best = i;
  }
  if (step(best) < kMinStep_grey || best < 2 || best + 2 >= levels.size()) return std::nullopt;
  const double before = step(best - 1);
  const double after = step(best + 1);
  const double curve = before - 2.0 * step(best) + after;
  const double part = curve < 0.0 ? std::clamp(0.5 * (before - after) / curve, -0.5, 0.5) : 0.0;
  const double at = static_cast<double>(best) - 1.0 - reach_px + part;
  const auto straight = undistortion.Undistort(on_side + at * outward);
  if (!straight) return std::nullopt;
  return SideSample{straight->straight_px, step(best)};
}

// The line through two samples that most samples are near.
std::vector<SideSample> OnOneLine(const std::vector<SideSample>& samples) {
  constexpr std::size_t kTried = 24;
  const std::size_t stride = std::max<std::size_t>(1, samples.size() / kTried);
  const auto near = [](const Line2& line, const SideSample& sample) {
    return std::abs(line.normal.dot(sample.straight_px) - line.offset) < kNearSide_px;
  };
  Line2 best;
  std::ptrdiff_t most = 0;
  for (std::size_t i = 0; i < samples.size(); i += stride) {
    for (std::size_t k = i + 4 * stride; k < samples.size(); k += stride) {
      const Line2 line = LineThrough(samples[i].straight_px, samples[k].straight_px);
      const auto count =
          std::ranges::count_if(samples, [&](const SideSample& s) { return near(line, s); });
      if (count <= most) continue;
      most = count;
      best = line;
    }
  }
  std::vector<SideSample> on_line;
  for (const SideSample& sample : samples) {
    if (most > 0 && near(best, sample)) on_line.push_back(sample);
  }
  return on_line;
}

// Least squares of the distances; `along` gives the direction's sense.
PlateSide FitSide(const std::vector<SideSample>& samples, const Eigen::Vector2d& along) {
  // Blur makes neighbouring samples err alike.
  constexpr double kSamplesPerIndependent = 6.0;
  PlateSide side;
  const auto n = static_cast<double>(samples.size());
  for (const SideSample& sample : samples) side.middle += sample.straight_px / n;
  Eigen::Matrix2d scatter = Eigen::Matrix2d::Zero();
  std::vector<double> steps;
  for (const SideSample& sample : samples) {
    const Eigen::Vector2d d = sample.straight_px - side.middle;
    scatter += d * d.transpose();
    steps.push_back(sample.step_grey);
  }
  const double half_difference = 0.5 * (scatter(0, 0) - scatter(1, 1));
  side.angle_rad = 0.5 * std::atan2(scatter(0, 1), half_difference);
  if (std::cos(side.angle_rad) * along.x() + std::sin(side.angle_rad) * along.y() < 0.0) {
    side.angle_rad += std::numbers::pi;
  }
  const double radius = std::hypot(half_difference, scatter(0, 1));
  const double across = std::max(0.0, 0.5 * scatter.trace() - radius) / n;
  const double length = std::max(1.0, 0.5 * scatter.trace() + radius) / n;
  const double variance = kSamplesPerIndependent * across / n;
  side.sigma_px = std::sqrt(variance + kSideFloor_px * kSideFloor_px);
  side.sigma_rad = std::sqrt((variance + kSideFloor_px * kSideFloor_px) / length);
  side.step_grey = Median(steps);
  return side;
}

// None where too little of the side is seen as one straight step.
std::optional<PlateSide> FindSide(const cv::Mat& grey, const Undistortion& undistortion,
                                  const PlateCandidate::Side& rough, bool is_brighter) {
  constexpr int kMinSamples = 24;
  constexpr int kMaxSamples = 240;
  constexpr double kCornersLeftOut = 0.04;
  const Eigen::Vector2d along = rough.to - rough.from;
  const double length = along.norm();
  // Clockwise with y down, the plate is on the right; outward is on the left.
  const Eigen::Vector2d outward = Eigen::Vector2d(along.y(), -along.x()) / length;
  const int count = std::clamp(static_cast<int>(length / 3.0), kMinSamples, kMaxSamples);
  const int reach = std::clamp(static_cast<int>(0.02 * length), 5, 16);
  std::vector<SideSample> samples;
  for (int i = 0; i < count; ++i) {
    const double share = kCornersLeftOut + (1.0 - 2.0 * kCornersLeftOut) * (i + 0.5) / count;
    const auto sample = SampleAt(grey, undistortion, rough.from + share * along, outward, reach,
                                 is_brighter ? -1.0 : 1.0);
    if (sample) samples.push_back(*sample);
  }
  const std::vector<SideSample> on_line = OnOneLine(samples);
  if (static_cast<double>(on_line.size()) < kMinSeen * count) return std::nullopt;
  return FitSide(on_line, along);
}

using PlateSides = std::array<PlateSide, 4>;

// Corners for small changes of the sides: across and angle of each, in px and rad.
std::optional<Quad> CornersWith(const PlateSides& sides, const Undistortion& undistortion,
                                const Eigen::Matrix<double, 8, 1>& change) {
  Quad corners;
  for (std::size_t i = 0; i < 4; ++i) {
    const std::size_t before = (i + 3) % 4;
    const auto k = static_cast<Eigen::Index>(2 * i);
    const auto k_before = static_cast<Eigen::Index>(2 * before);
    const auto straight = Intersect(sides[before].Moved(change[k_before], change[k_before + 1]),
                                    sides[i].Moved(change[k], change[k + 1]));
    const auto distorted = straight ? undistortion.Distort(*straight) : std::nullopt;
    if (!distorted) return std::nullopt;
    corners[i] = distorted->pixel;
  }
  return corners;
}

std::optional<PlateOutline> OutlineOf(const PlateSides& sides, const Undistortion& undistortion) {
  Eigen::Matrix<double, 8, 1> change = Eigen::Matrix<double, 8, 1>::Zero();
  const std::optional<Quad> corners = CornersWith(sides, undistortion, change);
  if (!corners) return std::nullopt;
  Matrix8 jacobian;  // By the changes in their standard deviations.
  for (Eigen::Index k = 0; k < 8; ++k) {
    const PlateSide& side = sides[static_cast<std::size_t>(k / 2)];
    change[k] = k % 2 == 0 ? side.sigma_px : side.sigma_rad;
    const std::optional<Quad> moved = CornersWith(sides, undistortion, change);
    if (!moved) return std::nullopt;
    for (std::size_t i = 0; i < 4; ++i) {
      jacobian.block<2, 1>(2 * static_cast<Eigen::Index>(i), k) = (*moved)[i] - (*corners)[i];
    }
    change[k] = 0.0;
  }
  constexpr double kCornerFloor_px = 0.1;
  return PlateOutline{.corners_px = *corners,
                      .covariance_px2 = jacobian * jacobian.transpose() +
                                        kCornerFloor_px * kCornerFloor_px * Matrix8::Identity()};
}

// The same outline with its corners numbered from corner `first` on.
PlateOutline Renumbered(const PlateOutline& outline, int first) {
  PlateOutline turned{.corners_px = StartingAt(outline.corners_px, first)};
  for (int i = 0; i < 4; ++i) {
    for (int k = 0; k < 4; ++k) {
      turned.covariance_px2.block<2, 2>(2 * i, 2 * k) =
          outline.covariance_px2.block<2, 2>(2 * ((i + first) % 4), 2 * ((k + first) % 4));
    }
  }
  return turned;
}

// The outline in the numbering in which it is a rectangle of the board's sides, the highest corner
// first where that is open; none if it is not.
std::optional<PlateOutline> AsBoard(const PlateOutline& outline, const Camera& camera,
                                    const Board& board) {
  BoardPoints points;
  points.in_board_m = CornersInBoard(board);
  points.in_board_m.resize(4);
  std::optional<PlateOutline> best;
  double least = kMaxChiSquare;
  for (int first = 0; first < 4; ++first) {
    const PlateOutline turned = Renumbered(outline, first);
    points.pixels.assign(turned.corners_px.begin(), turned.corners_px.end());
    points.covariance_px2 = turned.covariance_px2;
    const Expected<BoardPose> pose = EstimateBoardPose(camera, {&points, 1});
    if (!pose || pose->chi_square > kMaxChiSquare) continue;
    // Half a turn of a rectangle, and each turn of a square, fit alike.
    constexpr double kAlike = 1e-3;
    const bool better = pose->chi_square < least - kAlike;
    const bool alike = std::abs(pose->chi_square - least) <= kAlike;
    const bool higher = best && turned.corners_px[0].y() < best->corners_px[0].y();
    if (!better && !(alike && (higher || !best))) continue;
    best = turned;
    least = std::min(least, pose->chi_square);
  }
  return best;
}

// Whether nearly all pixels within the outline differ from an even slope of grey by less than a
// part of the step at the sides.
bool IsEven(const cv::Mat& grey, const Quad& corners, double step_grey) {
  constexpr int kPerSide = 24;
  constexpr double kMargin = 0.06;
  const std::optional<Eigen::Matrix3d> pixel_from_unit = UnitSquareToQuad(corners);
  if (!pixel_from_unit) return false;
  std::vector<Eigen::Vector3d> places;
  std::vector<double> levels;
  for (int i = 0; i < kPerSide * kPerSide; ++i) {
    const Eigen::Vector2d unit(kMargin + (1.0 - 2.0 * kMargin) * (i % kPerSide) / (kPerSide - 1.0),
                               kMargin + (1.0 - 2.0 * kMargin) * (i / kPerSide) / (kPerSide - 1.0));
    const double level = GreyAt(grey, (*pixel_from_unit * unit.homogeneous()).hnormalized());
    if (level < 0.0) continue;
    places.emplace_back(1.0, unit.x(), unit.y());
    levels.push_back(level);
  }
  if (places.size() < static_cast<std::size_t>(kPerSide)) return false;
  Eigen::MatrixX3d slopes(std::ssize(places), 3);
  Eigen::VectorXd greys(std::ssize(places));
  for (std::size_t i = 0; i < places.size(); ++i) {
    slopes.row(static_cast<Eigen::Index>(i)) = places[i].transpose();
    greys[static_cast<Eigen::Index>(i)] = levels[i];
  }
  const Eigen::Vector3d fit = slopes.colPivHouseholderQr().solve(greys);
  const Eigen::VectorXd off = (greys - slopes * fit).cwiseAbs();
  const auto even = (off.array() < kEvenGrey * step_grey).count();
  return static_cast<double>(even) >= kEvenShare * static_cast<double>(places.size());
}

double LongestSide(const Quad& corners) {
  double longest = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    longest = std::max(longest, (corners[(i + 1) % 4] - corners[i]).norm());
  }
  return longest;
}

bool AreSame(const Quad& a, const Quad& b) {
  const double allowed = kSameOutline * LongestSide(a);
  return std::ranges::all_of(a, [&](const Eigen::Vector2d& corner) {
    return std::ranges::any_of(
        b, [&](const Eigen::Vector2d& other) { return (corner - other).norm() < allowed; });
  });
}

std::optional<PlateOutline> Refined(const cv::Mat& grey, const Undistortion& undistortion,
                                    const PlateCandidate& candidate) {
  PlateSides sides;
  for (std::size_t i = 0; i < 4; ++i) {
    const auto side = FindSide(grey, undistortion, candidate.sides[i], candidate.is_brighter);
    if (!side) return std::nullopt;
    sides[i] = *side;
  }
  std::optional<PlateOutline> outline = OutlineOf(sides, undistortion);
  double weakest = sides[0].step_grey;
  for (const PlateSide& side : sides) weakest = std::min(weakest, side.step_grey);
  if (!outline || !IsEven(grey, outline->corners_px, weakest)) return std::nullopt;
  return outline;
}

}  // namespace

bool IsPlain(const Board& board) { return board.tags.empty() && !board.checker; }

std::vector<PlateOutline> FindPlateOutlines(const cv::Mat& grey, const Camera& camera,
                                            const Board& board) {
  const Undistortion undistortion(camera);
  std::vector<PlateOutline> found;
  for (const PlateCandidate& candidate : FindPlateCandidates(grey)) {
    const std::optional<Quad> rough = CornersOf(candidate);
    const auto is_it = [&](const PlateOutline& other) { return AreSame(*rough, other.corners_px); };
    if (!rough || std::ranges::any_of(found, is_it)) continue;
    const std::optional<PlateOutline> outline = Refined(grey, undistortion, candidate);
    if (!outline) continue;
    const auto is_known = [&](const PlateOutline& other) {
      return AreSame(outline->corners_px, other.corners_px);
    };
    if (std::ranges::any_of(found, is_known)) continue;
    if (const auto placed = AsBoard(*outline, camera, board)) found.push_back(*placed);
  }
  std::ranges::stable_sort(found, std::greater<>{}, [](const PlateOutline& outline) {
    return std::abs(SignedArea(outline.corners_px));
  });
  return found;
}

}  // namespace sextant
