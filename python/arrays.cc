// SPDX-License-Identifier: Apache-2.0
#include "python/arrays.h"

#include <fmt/core.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "python/raise.h"

namespace sextant::python {
namespace {

using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

constexpr double kRotationTolerance = 1e-6;

[[noreturn]] void Refuse(std::string message) {
  throw ErrorException({ErrorCode::kInvalidInput, std::move(message)});
}

std::string ShapeOf(const Numbers& array) {
  std::string text = "(";
  for (py::ssize_t i = 0; i < array.ndim(); ++i) {
    text += fmt::format("{}{}", i > 0 ? ", " : "", array.shape(i));
  }
  return text + (array.ndim() == 1 ? ",)" : ")");
}

// Conversions to double that would lose what the array says.
void CheckKeepsValues(const py::handle& object, const char* name) {
  if (!py::isinstance<py::array>(object)) return;
  if (py::hasattr(object, "mask")) {
    Refuse(fmt::format("{}: expected an array without a mask; leave out the masked rows", name));
  }
  if (py::reinterpret_borrow<py::array>(object).dtype().kind() == 'c') {
    Refuse(fmt::format("{}: expected real numbers, got complex ones", name));
  }
}

Numbers NumericArray(const py::handle& object, const char* name) {
  CheckKeepsValues(object, name);
  Numbers array = Numbers::ensure(object);
  if (!array) {
    PyErr_Clear();
    Refuse(fmt::format("{}: expected an array of numbers, got {}", name,
                       std::string(py::str(py::type::of(object).attr("__name__")))));
  }
  return array;
}

Numbers ArrayOfColumns(const py::handle& object, const char* name, py::ssize_t columns) {
  Numbers array = NumericArray(object, name);
  const bool is_empty = array.ndim() == 1 && array.shape(0) == 0;
  if (!is_empty && (array.ndim() != 2 || array.shape(1) != columns)) {
    Refuse(fmt::format("{}: expected an array of shape (N, {}), got {}", name, columns,
                       ShapeOf(array)));
  }
  return array;
}

template <int kColumns>
std::vector<Eigen::Matrix<double, kColumns, 1>> PointsFrom(const py::handle& object,
                                                           const char* name) {
  const Numbers array = ArrayOfColumns(object, name, kColumns);
  std::vector<Eigen::Matrix<double, kColumns, 1>> points(static_cast<std::size_t>(array.shape(0)));
  if (!points.empty()) {
    std::memcpy(points.front().data(), array.data(), points.size() * kColumns * sizeof(double));
  }
  return points;
}

template <int kColumns>
py::array_t<double> RowsOf(std::span<const Eigen::Matrix<double, kColumns, 1>> points) {
  py::array_t<double> array({static_cast<py::ssize_t>(points.size()), py::ssize_t{kColumns}});
  if (!points.empty()) {
    std::memcpy(array.mutable_data(), points.front().data(), points.size_bytes());
  }
  return array;
}

void WriteMatrix(const Eigen::MatrixXd& matrix, double* out) {
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Eigen::Map<RowMajor>(out, matrix.rows(), matrix.cols()) = matrix;
}

void CheckRotation(const Eigen::Matrix3d& matrix, const char* name) {
  const double off = (matrix * matrix.transpose() - Eigen::Matrix3d::Identity()).norm();
  if (off >= kRotationTolerance) {
    Refuse(
        fmt::format("{}: its 3x3 part is not a rotation: |R R^T - I| is {:.2g}, expected less "
                    "than {:.0e}",
                    name, off, kRotationTolerance));
  }
  if (matrix.determinant() < 0.0) {
    Refuse(fmt::format("{}: its 3x3 part is a reflection (determinant -1), expected a rotation",
                       name));
  }
}

}  // namespace

std::vector<Eigen::Vector3d> Points3From(const py::handle& array, const char* name) {
  return PointsFrom<3>(array, name);
}

std::vector<Eigen::Vector2d> Points2From(const py::handle& array, const char* name) {
  return PointsFrom<2>(array, name);
}

std::vector<double> NumbersFrom(const py::handle& object, const char* name, std::size_t count) {
  if (PyFloat_Check(object.ptr()))
    return std::vector<double>(count, PyFloat_AsDouble(object.ptr()));
  const Numbers array = NumericArray(object, name);
  if (array.ndim() == 0) return std::vector<double>(count, *array.data());
  if (array.ndim() != 1 || array.shape(0) != static_cast<py::ssize_t>(count)) {
    Refuse(fmt::format("{}: expected a number or an array of shape ({},), got {}", name, count,
                       ShapeOf(array)));
  }
  return {array.data(), array.data() + count};
}

std::vector<int> IntegersFrom(const py::handle& object, const char* name, std::size_t count) {
  std::vector<int> integers;
  integers.reserve(count);
  for (const double number : NumbersFrom(object, name, count)) {
    constexpr double kMax = std::numeric_limits<int>::max();
    if (!(std::abs(number) <= kMax) || number != std::floor(number)) {
      Refuse(fmt::format("{}: expected whole numbers, got {}", name, number));
    }
    integers.push_back(static_cast<int>(number));
  }
  return integers;
}

Eigen::MatrixXd MatrixFrom(const py::handle& object, const char* name, Eigen::Index rows,
                           Eigen::Index columns) {
  const Numbers array = NumericArray(object, name);
  if (array.ndim() != 2 || array.shape(0) != rows || array.shape(1) != columns) {
    Refuse(fmt::format("{}: expected an array of shape ({}, {}), got {}", name, rows, columns,
                       ShapeOf(array)));
  }
  using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return Eigen::Map<const RowMajor>(array.data(), rows, columns);
}

Rigid3d PoseFrom(const py::handle& object, const char* name) {
  const Numbers array = NumericArray(object, name);
  const bool is_pose =
      array.ndim() == 2 && array.shape(1) == 4 && (array.shape(0) == 4 || array.shape(0) == 3);
  if (!is_pose) {
    Refuse(fmt::format("{}: expected a matrix of shape (4, 4) or (3, 4), got {}", name,
                       ShapeOf(array)));
  }
  using Rows = Eigen::Matrix<double, 3, 4, Eigen::RowMajor>;
  const Rows rows = Eigen::Map<const Rows>(array.data());
  if (!rows.allFinite()) Refuse(fmt::format("{}: it has a NaN or infinite number", name));
  const bool is_homogeneous =
      array.shape(0) == 3 || (Eigen::Map<const Eigen::RowVector4d>(array.data() + 12) -
                              Eigen::RowVector4d(0.0, 0.0, 0.0, 1.0))
                                     .norm() < kRotationTolerance;
  if (!is_homogeneous) Refuse(fmt::format("{}: expected 0 0 0 1 as its last row", name));
  const Eigen::Matrix3d rotation = rows.leftCols<3>();
  CheckRotation(rotation, name);
  return {Eigen::Quaterniond(rotation).normalized(), rows.col(3)};
}

py::array_t<double> ArrayOf(std::span<const Eigen::Vector3d> points) { return RowsOf<3>(points); }

py::array_t<double> ArrayOf(std::span<const Eigen::Vector2d> points) { return RowsOf<2>(points); }

py::array_t<double> ArrayOf(std::span<const double> numbers) {
  return py::array_t<double>(static_cast<py::ssize_t>(numbers.size()), numbers.data());
}

py::array_t<int> ArrayOf(std::span<const int> numbers) {
  return py::array_t<int>(static_cast<py::ssize_t>(numbers.size()), numbers.data());
}

py::array_t<double> MatrixArray(const Eigen::MatrixXd& matrix) {
  py::array_t<double> array({matrix.rows(), matrix.cols()});
  WriteMatrix(matrix, array.mutable_data());
  return array;
}

py::array_t<double> PoseArray(const Rigid3d& pose) { return MatrixArray(pose.Matrix()); }

py::array_t<double> PosesArray(std::span<const Rigid3d> poses) {
  py::array_t<double> array(
      {static_cast<py::ssize_t>(poses.size()), py::ssize_t{4}, py::ssize_t{4}});
  for (std::size_t i = 0; i < poses.size(); ++i) {
    WriteMatrix(poses[i].Matrix(), array.mutable_data() + 16 * i);
  }
  return array;
}

}  // namespace sextant::python
