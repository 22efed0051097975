// SPDX-License-Identifier: Apache-2.0
// sextant.Solution: the answer of a solver as numpy arrays and texts.
#include <fmt/core.h>
#include <pybind11/stl.h>

#include "base/version.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/module_types.h"
#include "report/report_text.h"

namespace sextant::python {
namespace {

py::object CovarianceOf(const ModuleSolution& solution) {
  if (!solution.report.covariance) return py::none();
  return MatrixArray(*solution.report.covariance);
}

py::object SigmaOf(const ModuleSolution& solution) {
  if (!solution.report.covariance) return py::none();
  const Vector6d sigma = solution.report.covariance->diagonal().cwiseMax(0.0).cwiseSqrt();
  return ArrayOf(std::span<const double>(sigma.data(), 6));
}

py::array_t<double> QuaternionOf(const ModuleSolution& solution) {
  const Eigen::Quaterniond& q = solution.report.cam_from_lidar.rotation;
  const double sign = q.w() < 0.0 ? -1.0 : 1.0;
  const double numbers[] = {sign * q.w(), sign * q.x(), sign * q.y(), sign * q.z()};
  return ArrayOf(std::span<const double>(numbers));
}

py::dict ExtrasOf(const ModuleSolution& solution) {
  py::dict extras;
  const auto add = [&extras](const std::vector<EstimatedNumber>& numbers) {
    for (const EstimatedNumber& number : numbers) {
      extras[py::str(number.name)] = py::make_tuple(number.value, number.sigma);
    }
  };
  add(solution.report.extras);
  if (solution.report.camera) add(solution.report.camera->estimated);
  return extras;
}

std::string JsonOf(const ModuleSolution& solution) {
  return FormatResults({.version = std::string(Version()),
                        .input = solution.problem.input,
                        .results = {{solution.report.solver, solution.report}}});
}

std::string TextOf(const ModuleSolution& solution) {
  return DescribeReport(*solution.problem.data, solution.solver->spec(), solution.report);
}

void BindPose(py::class_<ModuleSolution>& solution) {
  using S = ModuleSolution;
  solution
      .def_property_readonly(
          "matrix", [](const S& s) { return PoseArray(s.report.cam_from_lidar); },
          "cam_from_lidar, (4, 4) [m]: point_in_cam = matrix @ point_in_lidar.")
      .def_property_readonly(
          "inverse", [](const S& s) { return PoseArray(s.report.cam_from_lidar.Inverse()); },
          "lidar_from_cam, (4, 4) [m].")
      .def_property_readonly("quaternion", &QuaternionOf, "Rotation as w, x, y, z with w >= 0.")
      .def_property_readonly(
          "covariance", &CovarianceOf,
          "(6, 6) of (dphi [rad], dt [m]): R = Exp(dphi) R_hat, t = t_hat + dt.\n"
          "None where no redundant data determines it.")
      .def_property_readonly("sigma", &SigmaOf,
                             "1 sigma of (dphi [rad], dt [m]), (6,); None without a covariance.")
      .def_property_readonly(
          "alternatives", [](const S& s) { return PosesArray(s.report.alternatives); },
          "Other poses that explain the data about as well, (K, 4, 4).");
}

void BindFit(py::class_<ModuleSolution>& solution) {
  using S = ModuleSolution;
  solution
      .def_property_readonly(
          "inliers", [](const S& s) { return ArrayOf(std::span<const int>(s.report.inliers)); },
          "Numbers, ascending, of the pairs that the answer rests on.")
      .def_property_readonly(
          "rmse_m", [](const S& s) { return s.report.evaluation.rmse_m; },
          "RMSE over all 3D-3D pairs [m]; None without them.")
      .def_property_readonly(
          "rmse_px", [](const S& s) { return s.report.evaluation.rmse_px; },
          "Reprojection RMSE [px]; None without 2D-3D pairs.")
      .def_property_readonly(
          "residuals_m", [](const S& s) { return ArrayOf(s.report.evaluation.per_pair_m); },
          "Distance of each 3D-3D pair [m], (N,).")
      .def_property_readonly(
          "residuals_px", [](const S& s) { return ArrayOf(s.report.evaluation.per_pair_px); },
          "Distance of each 2D-3D pair [px], (M,); inf where the point does not project.")
      .def_property_readonly("extras", &ExtrasOf,
                             "Other estimated numbers: {name: (value, sigma or None)}.")
      .def_property_readonly(
          "camera",
          [](const S& s) {
            return s.report.camera ? std::optional(s.report.camera->camera) : std::nullopt;
          },
          "The camera, where the solver estimates it too.");
}

}  // namespace

void BindEstimate(py::module_& module) {
  using S = ModuleSolution;
  py::class_<S> solution(module, "Solution", "The answer of one solver to one problem.");
  BindPose(solution);
  BindFit(solution);
  solution.def_property_readonly("solver", [](const S& s) { return s.report.solver; })
      .def_property_readonly("problem", [](const S& s) { return s.problem; })
      .def_property_readonly("warnings", [](const S& s) { return s.report.warnings; })
      .def_property_readonly("iterations", [](const S& s) { return s.report.iterations; })
      .def_property_readonly("termination",
                             [](const S& s) { return std::string(ToString(s.report.termination)); })
      .def_property_readonly(
          "wall_time_us", [](const S& s) { return s.report.wall_time_us; },
          "What the solver itself took [us].")
      .def("to_json", &JsonOf, "What `sextant solve --json` writes.")
      .def("__repr__", &TextOf)
      .def("_repr_html_", [](const py::object& self) {
        return py::module_::import("sextant._notebook").attr("solution_html")(self);
      });
}

}  // namespace sextant::python
