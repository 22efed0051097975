// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "geometry/calibration_problem.h"

namespace sextant {

/// What is wrong with the data as a whole, where one change of all numbers would explain it: one
/// sentence each, with the cause and the remedy. Empty for data that is as it should be, and where
/// no such change helps.

/// For 3D-3D pairs, at least three: one sensor's lengths are a multiple of the other's (units, or a
/// scale with its factor) or of a board's; both are in millimetres; camera points behind the
/// camera (most, or more than of the LiDAR's), as when the sensors are exchanged; camera points in
/// a frame of the world; one set is a mirror image of the other.
///
/// A factor is reported if it halves the RMSE and by an F-test at 100, so that a few bad points do
/// not pass for one. O(n) time.
std::vector<std::string> CausesInPoints(const CalibrationProblem& problem);

/// A reflection that leaves less than half the RMSE of the best rotation.
struct Reflection {
  double rmse_m = 0.0;
  bool is_certain = false;  ///< Less than a fifth of it: FitKabsch's kMirrored.
};

/// The best reflection of the LiDAR's points onto the camera's, if it is such a one.
std::optional<Reflection> FindReflection(const std::vector<Eigen::Vector3d>& in_cam,
                                         const std::vector<Eigen::Vector3d>& in_lidar);

/// For 2D-3D pairs, at least six (four for units), whose pose leaves more than a fiftieth of the
/// spread of the pixels: u and v exchanged, u from the right, v from below, normalised pixels, an
/// image of another size, another focal length, a LiDAR axis with the wrong sign, LiDAR points in
/// millimetres. Each change is undone on up to 24 pairs and the pose found again; it is reported if
/// it leaves less than a quarter of the residual relative to the spread of the pixels. Changes that
/// explain the data about equally well are named in one sentence, the best first. Time independent
/// of the number of pairs.
std::vector<std::string> CausesInPixels(const CalibrationProblem& problem);

/// For the camera and the pixels: a field of view, focal length or principal point that no camera
/// has, and pixels outside its image.
std::vector<std::string> CausesInCamera(const CalibrationProblem& problem);

/// For at least eight 3D-3D pairs: a factor between the sensors' lengths that noise hides from
/// CausesInPoints, by an F-test at 30, and at 8 with about the same factor in every second pair and
/// in the others; and not one that the sizes of complete boards contradict. The pose is then still
/// near the truth.
std::optional<std::string> SlightScale(const CalibrationProblem& problem);

/// For at least ten 2D-3D pairs without outliers: whether focal length and principal point,
/// estimated along with the pose, halve the sum of squares, by an F-test at 15. A pose with wrong
/// intrinsics absorbs most of their error, and is off by it.
std::optional<std::string> OtherIntrinsics(const CalibrationProblem& problem);

}  // namespace sextant
