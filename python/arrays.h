// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/numpy.h>

#include <Eigen/Core>
#include <span>
#include <string>
#include <vector>

#include "geometry/rigid3d.h"

// numpy arrays to and from the library's types. `name` is the argument's, for the message of the
// ErrorException (kInvalidInput) that a wrong shape or type causes.
namespace sextant::python {

namespace py = pybind11;

/// Rows of an array of shape (N, 3), or (N, 2); any type that numpy converts to float64.
std::vector<Eigen::Vector3d> Points3From(const py::handle& array, const char* name);
std::vector<Eigen::Vector2d> Points2From(const py::handle& array, const char* name);
/// A number for all of `count`, or an array of shape (count,).
std::vector<double> NumbersFrom(const py::handle& array, const char* name, std::size_t count);
/// The same of whole numbers.
std::vector<int> IntegersFrom(const py::handle& array, const char* name, std::size_t count);
/// A matrix of this shape.
Eigen::MatrixXd MatrixFrom(const py::handle& array, const char* name, Eigen::Index rows,
                           Eigen::Index columns);

/// A rigid transform of shape (4, 4) or (3, 4). Also refuses numbers that are not finite, a last
/// row other than 0 0 0 1, and a 3x3 part that is not a rotation to 1e-6 (a reflection, a scale).
Rigid3d PoseFrom(const py::handle& array, const char* name);

py::array_t<double> ArrayOf(std::span<const Eigen::Vector3d> points);  ///< (N, 3).
py::array_t<double> ArrayOf(std::span<const Eigen::Vector2d> points);  ///< (N, 2).
py::array_t<double> ArrayOf(std::span<const double> numbers);          ///< (N,).
py::array_t<int> ArrayOf(std::span<const int> numbers);                ///< (N,).
py::array_t<double> MatrixArray(const Eigen::MatrixXd& matrix);
py::array_t<double> PoseArray(const Rigid3d& pose);              ///< (4, 4).
py::array_t<double> PosesArray(std::span<const Rigid3d> poses);  ///< (K, 4, 4).

}  // namespace sextant::python
