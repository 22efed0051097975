// SPDX-License-Identifier: Apache-2.0
#include "python/sensor_arrays.h"

#include <fmt/core.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "io/clouds/cloud_builder.h"
#include "python/raise.h"

namespace sextant::python {
namespace {

using Rows = py::array_t<double, py::array::c_style | py::array::forcecast>;

enum Column : py::ssize_t { kIntensity = 3, kRing = 4, kTime = 5, kMaxColumns = 6 };

[[noreturn]] void RefuseArray(ErrorCode code, std::string message) {
  throw ErrorException({code, std::move(message)});
}

Rows CloudRows(const py::handle& object, const std::string& name) {
  Rows rows = Rows::ensure(object);
  if (!rows) PyErr_Clear();
  if (rows && rows.ndim() == 2 && rows.shape(1) >= 3 && rows.shape(1) <= kMaxColumns) return rows;
  RefuseArray(ErrorCode::kInvalidInput,
              fmt::format("{}: expected an array of shape (N, 3) to (N, 6): x y z intensity ring "
                          "time",
                          name));
}

// Whether the column is there and not all NaN.
bool HasColumn(const Rows& rows, py::ssize_t column) {
  if (column >= rows.shape(1)) return false;
  const auto at = rows.unchecked<2>();
  for (py::ssize_t i = 0; i < rows.shape(0); ++i) {
    if (!std::isnan(at(i, column))) return true;
  }
  return false;
}

std::uint16_t RingFrom(double value, const std::string& name, py::ssize_t row) {
  if (value >= 0.0 && value <= 65535.0 && value == std::floor(value)) {
    return static_cast<std::uint16_t>(value);
  }
  RefuseArray(ErrorCode::kInvalidInput,
              fmt::format("{}: row {} has ring {}, expected a whole number from 0 to 65535", name,
                          row, value));
}

}  // namespace

PointCloud CloudFrom(const py::handle& object, const std::string& name) {
  const Rows rows = CloudRows(object, name);
  const auto at = rows.unchecked<2>();
  const py::ssize_t count = rows.shape(0);
  PointCloud cloud;
  cloud.points.reserve(static_cast<std::size_t>(count));
  for (py::ssize_t i = 0; i < count; ++i) {
    const Eigen::Vector3d point(at(i, 0), at(i, 1), at(i, 2));
    const double none = std::numeric_limits<double>::quiet_NaN();
    cloud.points.push_back(point.allFinite() ? point : Eigen::Vector3d(none, none, none));
  }
  if (HasColumn(rows, kIntensity)) {
    for (py::ssize_t i = 0; i < count; ++i) {
      cloud.intensity.push_back(static_cast<float>(at(i, kIntensity)));
    }
  }
  if (HasColumn(rows, kRing)) {
    for (py::ssize_t i = 0; i < count; ++i) cloud.ring.push_back(RingFrom(at(i, kRing), name, i));
    OrderRings(cloud);
  }
  if (HasColumn(rows, kTime)) {
    for (py::ssize_t i = 0; i < count; ++i) cloud.time_s.push_back(at(i, kTime));
  }
  return cloud;
}

py::array_t<double> ArrayOf(const PointCloud& cloud) {
  const py::ssize_t columns = !cloud.time_s.empty()      ? kTime + 1
                              : !cloud.ring.empty()      ? kRing + 1
                              : !cloud.intensity.empty() ? kIntensity + 1
                                                         : 3;
  py::array_t<double> array({static_cast<py::ssize_t>(cloud.points.size()), columns});
  auto at = array.mutable_unchecked<2>();
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const auto row = static_cast<py::ssize_t>(i);
    for (py::ssize_t k = 0; k < columns; ++k) at(row, k) = std::numeric_limits<double>::quiet_NaN();
    for (int k = 0; k < 3; ++k) at(row, k) = cloud.points[i][k];
    if (!cloud.intensity.empty()) at(row, kIntensity) = static_cast<double>(cloud.intensity[i]);
    if (!cloud.ring.empty()) at(row, kRing) = cloud.ring[i];
    if (!cloud.time_s.empty()) at(row, kTime) = cloud.time_s[i];
  }
  return array;
}

cv::Mat ImageFrom(const py::handle& object, const std::string& name) {
  const py::array array = py::array::ensure(object, py::array::c_style);
  if (!array) PyErr_Clear();
  const bool is_deep = array && py::isinstance<py::array_t<std::uint16_t>>(array);
  const bool is_known = is_deep || (array && py::isinstance<py::array_t<std::uint8_t>>(array));
  const bool is_colour = is_known && array.ndim() == 3 && array.shape(2) == 3;
  if (!is_known || (array.ndim() != 2 && !is_colour) || array.size() == 0) {
    RefuseArray(ErrorCode::kInvalidInput,
                fmt::format("{}: expected an image of shape (H, W) or (H, W, 3), uint8 or uint16, "
                            "grey or BGR",
                            name));
  }
  cv::Mat image(static_cast<int>(array.shape(0)), static_cast<int>(array.shape(1)),
                CV_MAKETYPE(is_deep ? CV_16U : CV_8U, is_colour ? 3 : 1));
  std::memcpy(image.data, array.data(), static_cast<std::size_t>(array.nbytes()));
  return image;
}

py::array ArrayOf(const cv::Mat& image) {
  const cv::Mat whole = image.isContinuous() ? image : image.clone();
  std::vector<py::ssize_t> shape = {whole.rows, whole.cols};
  if (whole.channels() > 1) shape.push_back(whole.channels());
  const py::dtype type =
      whole.depth() == CV_16U ? py::dtype::of<std::uint16_t>() : py::dtype::of<std::uint8_t>();
  return py::array(type, shape, whole.data);
}

}  // namespace sextant::python
