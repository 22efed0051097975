// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "calibrate/observe/face_returns.h"
#include "features/lidar/lidar_plane.h"

namespace sextant {

/// Moves the returns from dark print to the range of those from bright material: a weak echo is
/// measured too far, by 14 mm from black in a VLP-16. Returns the range that was subtracted from
/// the darkest returns [m]; 0 where nothing was changed.
///
/// The intensities are divided into two classes of least variance (Otsu 1979), whose means are the
/// darkness 1 and 0. The excess range per darkness is least squares over the deviations from the
/// plane, with an offset and a slope of each ring as unknowns, and a normal prior of 15 mm. Nothing
/// is changed where the intensities form one class (means less than four standard deviations
/// apart, or a class under a tenth of the returns), or the excess is under three of its sigmas.
/// `intensity`: one for each return, in any unit. O(n log n).
double CorrectDarkReturns(std::span<const float> intensity, const LidarPlane& plane,
                          FaceOfBoard& face);

}  // namespace sextant
