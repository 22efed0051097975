// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "geometry/point_cloud.h"
#include "python/arrays.h"

// Scans and images as numpy arrays. Throws ErrorException (kInvalidInput, kNonFinite) that names
// `name`, an argument.
namespace sextant::python {

/// An array of shape (N, 3) to (N, 6): x y z [m], intensity, ring (0 the lowest), time [s]. A
/// column of NaN is one that the sensor does not provide; a row whose point is NaN is a ray without
/// a return.
PointCloud CloudFrom(const py::handle& array, const std::string& name);

/// The same, with as many columns as the cloud has fields, at least 3.
py::array_t<double> ArrayOf(const PointCloud& cloud);

/// An array of shape (H, W) or (H, W, 3), of uint8 or uint16: grey or BGR. A copy.
cv::Mat ImageFrom(const py::handle& array, const std::string& name);
py::array ArrayOf(const cv::Mat& image);

}  // namespace sextant::python
