// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"

namespace sextant {

/// Pictures of one tag each, that every detector gets.
struct DetectorStudyOptions {
  int trials = 200;
  std::uint64_t seed = 1;
  std::string family = "tag36h11";  ///< That both libraries read.
  double min_side_px = 30.0;        ///< Sides are drawn uniformly in their logarithm.
  double max_side_px = 200.0;
  double max_tilt_rad = 1.0472;  ///< Drawn uniformly from 0.
  double blur_px = 0.7;
  double noise_grey = 3.0;
};

/// What one setting of a detector does with them.
struct DetectorRow {
  std::string detector{};
  int found = 0;
  int large_found = 0;   ///< Of those of 100 px and more.
  double rmse_px = 0.0;  ///< Of the distance between a corner and its truth.
  double large_rmse_px = 0.0;
  double median_px = 0.0;
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();  ///< Mean error.
  double inward_px = 0.0;      ///< Mean of the edges' displacement towards the tag's middle.
  double bias_sigma_px = 0.0;  ///< Standard error of a component of the shift.
  double nees = 0.0;  ///< Mean of e^T C^-1 e / 8, for those that state a covariance; else 0.
};

/// The settings that the study compares: each of both libraries, as it normalises them, and ours,
/// "refined", which starts from "apriltag(decimate=2)".
std::vector<std::string> StudiedDetectors(const std::string& family);

/// A row for each of StudiedDetectors, in their order. All get the same pictures, in parallel; the
/// same seed gives the same figures on any number of threads. Errors: of RenderTagPicture;
/// kUnknownName for a family that one of the libraries lacks.
Expected<std::vector<DetectorRow>> StudyDetectors(const DetectorStudyOptions& options);

/// The rows as a table, for a terminal or as Markdown.
std::string FormatDetectorStudy(const std::vector<DetectorRow>& rows, bool markdown);

}  // namespace sextant
