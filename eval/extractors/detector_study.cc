// SPDX-License-Identifier: Apache-2.0
#include "eval/extractors/detector_study.h"

#include <fmt/core.h>
#include <tbb/parallel_for.h>

#include <cmath>
#include <optional>

#include "base/median.h"
#include "base/random.h"
#include "eval/statistics/text_table.h"
#include "features/camera/edge_refine.h"
#include "features/camera/tag_detector.h"
#include "geometry/symmetric.h"
#include "simulator/camera/tag_picture.h"

namespace sextant {
namespace {

constexpr const char* kRefined = "refined";
constexpr const char* kDetectorExperiment = "detectors";
constexpr double kLarge_px = 100.0;
constexpr double kNotThisTag_px = 8.0;

using Vector8d = Eigen::Matrix<double, 8, 1>;

// The result of one detector for one image.
struct Answer {
  bool is_found = false;
  Vector8d error = Vector8d::Zero();
  double inward_px = 0.0;
  double nees = 0.0;
};

struct TagTrial {
  bool is_large = false;
  std::vector<Answer> answers;
};

Vector8d ErrorOf(const Quad& corners, const Quad& truth) {
  Vector8d error;
  for (std::size_t k = 0; k < 4; ++k) {
    error.segment<2>(2 * static_cast<Eigen::Index>(k)) = corners[k] - truth[k];
  }
  return error;
}

double InwardOf(const Vector8d& error, const Quad& truth) {
  double inward = 0.0;
  for (std::size_t k = 0; k < 4; ++k) {
    const Line2 edge = LineThrough(truth[k], truth[(k + 1) % 4]);
    const auto a = 2 * static_cast<Eigen::Index>(k);
    const auto b = 2 * static_cast<Eigen::Index>((k + 1) % 4);
    // Corners go clockwise with y down, so this normal points outwards.
    inward -= edge.normal.dot(error.segment<2>(a) + error.segment<2>(b)) / 8.0;
  }
  return inward;
}

// Corners in the numbering of the image's family, whichever library found the tag.
std::optional<Quad> FindTag(const TagDetector& detector, const TagPicture& picture, int id,
                            const TagPattern& pattern) {
  const Expected<Detections> found = detector.Detect(picture.image);
  if (!found) return std::nullopt;
  for (const TagDetection& tag : found->tags) {
    if (tag.id != id) continue;
    const Expected<TagPattern> own = MakeTagPattern(tag.family, id);
    const std::optional<int> turns = own ? QuarterTurns(pattern, *own) : std::nullopt;
    if (!turns) continue;
    const Quad corners = StartingAt(tag.corners_px, *turns);
    const double furthest = ErrorOf(corners, picture.corners_px).cwiseAbs().maxCoeff();
    if (furthest < kNotThisTag_px) return corners;
  }
  return std::nullopt;
}

Answer AnswerOf(const std::optional<Quad>& corners, const Quad& truth) {
  if (!corners) return {};
  Answer answer{.is_found = true, .error = ErrorOf(*corners, truth)};
  answer.inward_px = InwardOf(answer.error, truth);
  return answer;
}

Answer RefinedAnswer(const std::optional<Quad>& start, const TagPicture& picture,
                     const TagPattern& pattern) {
  if (!start) return {};
  const Expected<RefinedTag> refined =
      RefineTag(picture.image, *start, pattern, Undistortion(picture.camera));
  if (!refined) return {};
  Answer answer = AnswerOf(refined->corners_px, picture.corners_px);
  answer.nees = SquaredMahalanobis(answer.error, refined->covariance_px2) / 8.0;
  return answer;
}

TagPictureOptions DrawTagPicture(const DetectorStudyOptions& options, int trial) {
  Random random(
      DeriveSeed(options.seed, kDetectorExperiment, 0, static_cast<std::uint64_t>(trial)));
  TagPictureOptions picture;
  picture.family = options.family;
  picture.id = static_cast<int>(random.Below(30));
  const double log_side =
      random.Uniform(std::log(options.min_side_px), std::log(options.max_side_px));
  picture.side_px = std::exp(log_side);
  picture.tilt_rad = random.Uniform(0.0, options.max_tilt_rad);
  picture.seed =
      DeriveSeed(options.seed, kDetectorExperiment, 1, static_cast<std::uint64_t>(trial));
  picture.field = 0.35;  // The largest board must be completely in the image.
  picture.image.seed =
      DeriveSeed(options.seed, kDetectorExperiment, 2, static_cast<std::uint64_t>(trial));
  picture.image.blur_sigma_px = options.blur_px;
  picture.image.noise_sigma_grey = options.noise_grey;
  return picture;
}

Expected<TagTrial> RunTagTrial(const TagPictureOptions& drawn,
                               const std::vector<TagDetectorPtr>& detectors,
                               std::size_t first_of_ours) {
  SEXTANT_ASSIGN_OR_RETURN(const TagPicture picture, RenderTagPicture(drawn));
  SEXTANT_ASSIGN_OR_RETURN(const TagPattern pattern, MakeTagPattern(drawn.family, drawn.id));
  TagTrial trial{.is_large = drawn.side_px >= kLarge_px, .answers = {}};
  std::optional<Quad> start;
  for (std::size_t i = 0; i < detectors.size(); ++i) {
    const std::optional<Quad> corners = FindTag(*detectors[i], picture, drawn.id, pattern);
    if (i == first_of_ours) start = corners;
    trial.answers.push_back(AnswerOf(corners, picture.corners_px));
  }
  trial.answers.push_back(RefinedAnswer(start, picture, pattern));
  return trial;
}

DetectorRow SummariseDetector(const std::string& detector, const std::vector<TagTrial>& trials,
                              std::size_t index) {
  DetectorRow row{.detector = detector};
  double squares = 0.0;
  double large_squares = 0.0;
  std::vector<double> distances;
  for (const TagTrial& trial : trials) {
    const Answer& answer = trial.answers[index];
    if (!answer.is_found) continue;
    ++row.found;
    squares += answer.error.squaredNorm() / 4.0;
    if (trial.is_large) ++row.large_found;
    if (trial.is_large) large_squares += answer.error.squaredNorm() / 4.0;
    for (Eigen::Index k = 0; k < 4; ++k) {
      row.shift_px += answer.error.segment<2>(2 * k) / 4.0;
      distances.push_back(answer.error.segment<2>(2 * k).norm());
    }
    row.inward_px += answer.inward_px;
    row.nees += answer.nees;
  }
  if (row.found == 0) return row;
  row.rmse_px = std::sqrt(squares / row.found);
  row.large_rmse_px = row.large_found > 0 ? std::sqrt(large_squares / row.large_found) : 0.0;
  row.shift_px /= row.found;
  row.inward_px /= row.found;
  row.nees /= row.found;
  row.bias_sigma_px = row.rmse_px / std::sqrt(8.0 * row.found);
  row.median_px = UpperMedian(distances);
  return row;
}

}  // namespace

std::vector<std::string> StudiedDetectors(const std::string& family) {
  std::vector<std::string> names;
  for (const char* refine : {"none", "subpix", "contour", "apriltag"}) {
    names.push_back(fmt::format("aruco(dictionary={},refine={})", family, refine));
  }
  for (const char* refine : {"true", "false"}) {
    for (const char* decimate : {"1", "1.5", "2", "3"}) {
      names.push_back(
          fmt::format("apriltag(family={},decimate={},refine_edges={})", family, decimate, refine));
    }
  }
  names.emplace_back(kRefined);
  return names;
}

Expected<std::vector<DetectorRow>> StudyDetectors(const DetectorStudyOptions& options) {
  constexpr std::size_t kStart = 6;  // Index of apriltag(decimate=2).
  const std::vector<std::string> names = StudiedDetectors(options.family);
  std::vector<TagDetectorPtr> detectors;
  for (std::size_t i = 0; i + 1 < names.size(); ++i) {
    SEXTANT_ASSIGN_OR_RETURN(TagDetectorPtr detector, MakeTagDetector(names[i]));
    detectors.push_back(std::move(detector));
  }
  std::vector<Expected<TagTrial>> results(static_cast<std::size_t>(options.trials));
  tbb::parallel_for(std::size_t{0}, results.size(), [&](std::size_t i) {
    results[i] = RunTagTrial(DrawTagPicture(options, static_cast<int>(i)), detectors, kStart);
  });
  std::vector<TagTrial> trials;
  for (Expected<TagTrial>& trial : results) {
    if (!trial) return tl::unexpected<Error>(trial.error());
    trials.push_back(std::move(*trial));
  }
  std::vector<DetectorRow> rows;
  for (std::size_t i = 0; i < names.size(); ++i)
    rows.push_back(SummariseDetector(names[i], trials, i));
  return rows;
}

std::string FormatDetectorStudy(const std::vector<DetectorRow>& rows, bool markdown) {
  TextTable table({"detector", "found", "RMSE [px]", "100 px and more", "median", "mean x",
                   "mean y", "inward", "NEES"});
  for (const DetectorRow& row : rows) {
    table.AddRow({row.detector, std::to_string(row.found), Fixed(row.rmse_px, 4),
                  Fixed(row.large_rmse_px, 4), Fixed(row.median_px, 4), Fixed(row.shift_px.x(), 3),
                  Fixed(row.shift_px.y(), 3), Fixed(row.inward_px, 3),
                  row.nees > 0.0 ? Fixed(row.nees, 2) : "-"});
  }
  return markdown ? table.Markdown() : table.Plain();
}

}  // namespace sextant
