// SPDX-License-Identifier: Apache-2.0
#include "solvers/opencv/opencv_pnp.h"

#include <fmt/core.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <opencv2/calib3d.hpp>
#include <optional>

#include "solvers/pnp/correspondences.h"

namespace sextant {
namespace {

/// Pairs in OpenCV's types, with pixels of a camera without distortion and with principal point 0.
struct OpenCvPairs {
  std::vector<cv::Point3d> points;
  std::vector<cv::Point2d> pixels;
  cv::Matx33d intrinsics = cv::Matx33d::eye();
};

template <class Indices>
OpenCvPairs ToOpenCv(const PnpInput& input, const Indices& indices) {
  OpenCvPairs pairs;
  for (const std::size_t i : indices) {
    const Eigen::Vector3d& point = input.points[i];
    const Eigen::Vector2d pixel = input.focal_length_px * input.image_points[i];
    pairs.points.emplace_back(point.x(), point.y(), point.z());
    pairs.pixels.emplace_back(pixel.x(), pixel.y());
  }
  pairs.intrinsics(0, 0) = pairs.intrinsics(1, 1) = input.focal_length_px;
  return pairs;
}

OpenCvPairs ToOpenCv(const PnpInput& input) {
  std::vector<std::size_t> all(input.points.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = i;
  return ToOpenCv(input, all);
}

Rigid3d ToRigid(const cv::Mat& rotation_vector, const cv::Mat& translation) {
  const auto vector = [](const cv::Mat& m) {
    return Eigen::Vector3d(m.at<double>(0), m.at<double>(1), m.at<double>(2));
  };
  return {ExpSo3(vector(rotation_vector)), vector(translation)};
}

// OpenCV's message has line ends and indents.
std::string OnOneLine(const std::string& text) {
  std::string line;
  for (const char c : text) {
    const bool is_space = c == '\n' || c == '\r' || c == '\t' || c == ' ';
    if (!is_space) {
      line += c;
    } else if (!line.empty() && line.back() != ' ') {
      line += ' ';
    }
  }
  while (!line.empty() && line.back() == ' ') line.pop_back();
  return line;
}

/// Calls OpenCV and converts its exceptions to an error.
template <class Function>
Expected<void> Guard(const Function& function) {
  try {
    function();
  } catch (const cv::Exception& exception) {
    return MakeError(ErrorCode::kDegenerate,
                     fmt::format("OpenCV rejects the pairs ({})", OnOneLine(exception.err)));
  }
  return {};
}

/// Keeps finite poses with most points in front of the camera, smallest reprojection error first.
Expected<PnpPoses> Rank(const Correspondences& data, std::span<const Rigid3d> poses) {
  struct Ranked {
    Rigid3d pose;
    ImageFit fit;
  };
  std::vector<Ranked> ranked;
  for (const Rigid3d& pose : poses) {
    if (!pose.IsFinite()) continue;
    const ImageFit fit = FitOf(data, pose.rotation.toRotationMatrix(), pose * data.frame.centroid);
    if (2 * fit.behind <= data.points.size()) ranked.push_back({pose, fit});
  }
  if (ranked.empty()) {
    return MakeError(ErrorCode::kNoConsensus,
                     "OpenCV's answer is not finite, or has the points behind the camera");
  }
  std::sort(ranked.begin(), ranked.end(), [](const Ranked& a, const Ranked& b) {
    return a.fit.behind != b.fit.behind ? a.fit.behind < b.fit.behind
                                        : a.fit.sum_squares < b.fit.sum_squares;
  });
  PnpPoses found;
  for (const Ranked& next : ranked) {
    if (static_cast<std::size_t>(found.count) == found.poses.size()) break;
    found.poses[static_cast<std::size_t>(found.count++)] = next.pose;
  }
  return found;
}

Expected<PnpPoses> Rank(const Correspondences& data, const std::vector<cv::Mat>& rotation_vectors,
                        const std::vector<cv::Mat>& translations) {
  std::vector<Rigid3d> poses;
  for (std::size_t i = 0; i < rotation_vectors.size(); ++i) {
    poses.push_back(ToRigid(rotation_vectors[i], translations[i]));
  }
  return Rank(data, poses);
}

int FlagOf(OpenCvPnp method) {
  switch (method) {
    case OpenCvPnp::kEpnp:
      return cv::SOLVEPNP_EPNP;
    case OpenCvPnp::kSqpnp:
      return cv::SOLVEPNP_SQPNP;
    case OpenCvPnp::kIppe:
      return cv::SOLVEPNP_IPPE;
    case OpenCvPnp::kIterative:
      break;
  }
  return cv::SOLVEPNP_ITERATIVE;
}

constexpr std::size_t kMinPairs = 4;

/// `run` fills a rotation vector, a translation and inliers, and returns whether it found them.
template <class Run>
Expected<PnpPoses> Consensus(const PnpInput& input, const Run& run) {
  SEXTANT_ASSIGN_OR_RETURN(const Correspondences data,
                           PrepareCorrespondences(input.image_points, input.points, kMinPairs));
  cv::Mat rotation_vector;
  cv::Mat translation;
  cv::Mat inliers;
  bool ok = false;
  SEXTANT_RETURN_IF_ERROR(
      Guard([&] { ok = run(ToOpenCv(input), rotation_vector, translation, inliers); }));
  if (!ok || inliers.total() < kMinPairs) {
    return MakeError(ErrorCode::kNoConsensus,
                     "OpenCV finds no pose that four pairs agree on; raise threshold_px or "
                     "max_iterations, or check the pairing");
  }
  Expected<PnpPoses> found = Rank(data, std::vector<cv::Mat>{rotation_vector}, {translation});
  if (!found) return found;
  for (int i = 0; i < static_cast<int>(inliers.total()); ++i) {
    found->inliers.push_back(inliers.at<int>(i));
  }
  std::sort(found->inliers.begin(), found->inliers.end());
  return found;
}

}  // namespace

Expected<PnpPoses> SolveOpenCvPnp(const PnpInput& input, OpenCvPnp method) {
  const std::size_t needed = method == OpenCvPnp::kSqpnp ? 3 : kMinPairs;
  SEXTANT_ASSIGN_OR_RETURN(const Correspondences data,
                           PrepareCorrespondences(input.image_points, input.points, needed));
  const OpenCvPairs pairs = ToOpenCv(input);
  std::vector<cv::Mat> rotation_vectors;
  std::vector<cv::Mat> translations;
  SEXTANT_RETURN_IF_ERROR(Guard([&] {
    cv::solvePnPGeneric(pairs.points, pairs.pixels, pairs.intrinsics, cv::noArray(),
                        rotation_vectors, translations, /*useExtrinsicGuess=*/false,
                        static_cast<cv::SolvePnPMethod>(FlagOf(method)));
  }));
  return Rank(data, rotation_vectors, translations);
}

Expected<PnpPoses> SolveOpenCvP3p(const PnpInput& input) {
  SEXTANT_ASSIGN_OR_RETURN(const Correspondences data,
                           PrepareCorrespondences(input.image_points, input.points, 3));
  const Triple triangle = WidestTriangle(data);
  const OpenCvPairs pairs = ToOpenCv(input, triangle);
  std::vector<cv::Mat> rotation_vectors;
  std::vector<cv::Mat> translations;
  SEXTANT_RETURN_IF_ERROR(Guard([&] {
    cv::solveP3P(pairs.points, pairs.pixels, pairs.intrinsics, cv::noArray(), rotation_vectors,
                 translations, cv::SOLVEPNP_P3P);
  }));
  Expected<PnpPoses> found = Rank(data, rotation_vectors, translations);
  if (found) found->fixed_by = triangle;
  return found;
}

Expected<PnpPoses> SolveOpenCvRansacEpnp(const PnpInput& input,
                                         const OpenCvRansacOptions& options) {
  return Consensus(input, [&](const OpenCvPairs& pairs, cv::Mat& rotation_vector,
                              cv::Mat& translation, cv::Mat& inliers) {
    return cv::solvePnPRansac(pairs.points, pairs.pixels, pairs.intrinsics, cv::noArray(),
                              rotation_vector, translation, /*useExtrinsicGuess=*/false,
                              options.max_iterations, static_cast<float>(options.threshold_px),
                              options.confidence, inliers, cv::SOLVEPNP_EPNP);
  });
}

Expected<PnpPoses> SolveOpenCvMagsac(const PnpInput& input, const OpenCvRansacOptions& options) {
  cv::UsacParams usac;
  usac.confidence = options.confidence;
  usac.isParallel = false;
  usac.maxIterations = options.max_iterations;
  usac.randomGeneratorState = 0;
  usac.sampler = cv::SAMPLING_UNIFORM;
  usac.score = cv::SCORE_METHOD_MAGSAC;
  usac.threshold = options.threshold_px;
  usac.loMethod = cv::LOCAL_OPTIM_SIGMA;
  usac.loIterations = 10;
  return Consensus(input, [&](const OpenCvPairs& pairs, cv::Mat& rotation_vector,
                              cv::Mat& translation, cv::Mat& inliers) {
    cv::Mat intrinsics(pairs.intrinsics);
    return cv::solvePnPRansac(pairs.points, pairs.pixels, intrinsics, cv::noArray(),
                              rotation_vector, translation, inliers, usac);
  });
}

}  // namespace sextant
