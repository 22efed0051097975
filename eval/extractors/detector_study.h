// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "base/error.h"

namespace sextant {

/// Simulated images of one tag each; every detector gets the same ones.
struct DetectorStudyOptions {
  int trials = 200;
  std::uint64_t seed = 1;
  std::string family = "tag36h11";  ///< A family that both libraries support.
  double min_side_px = 30.0;        ///< The logarithm of the side is drawn uniformly.
  double max_side_px = 200.0;
  double max_tilt_rad = 1.0472;  ///< The tilt is drawn uniformly from 0 to this.
  double blur_px = 0.7;
  double noise_grey = 3.0;
};

/// Results of one detector setting.
struct DetectorRow {
  std::string detector{};
  int found = 0;
  int large_found = 0;   ///< Tags found among those of 100 px and more.
  double rmse_px = 0.0;  ///< RMS distance between a corner and its true position.
  double large_rmse_px = 0.0;
  double median_px = 0.0;
  Eigen::Vector2d shift_px = Eigen::Vector2d::Zero();  ///< Mean error of the corners.
  double inward_px = 0.0;      ///< Mean displacement of the edges towards the tag's centre.
  double bias_sigma_px = 0.0;  ///< Standard error of one component of the shift.
  double nees = 0.0;  ///< Mean of e^T C^-1 e / 8; 0 for detectors that state no covariance.
};

/// The detector settings that the study compares, as canonical specs: those of both libraries, and
/// our "refined", which starts from "apriltag(decimate=2)".
std::vector<std::string> StudiedDetectors(const std::string& family);

/// Runs all StudiedDetectors on the same images and returns one row each, in their order. The same
/// seed gives the same figures on any number of threads. Errors: those of RenderTagPicture;
/// kUnknownName for a family that one of the libraries lacks.
Expected<std::vector<DetectorRow>> StudyDetectors(const DetectorStudyOptions& options);

/// The rows as a table, for a terminal or as Markdown.
std::string FormatDetectorStudy(const std::vector<DetectorRow>& rows, bool markdown);

}  // namespace sextant
