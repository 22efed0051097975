// SPDX-License-Identifier: Apache-2.0
// Solvers in Python: sextant.Estimate, and the registration of functions.
#include <pybind11/stl.h>

#include <algorithm>

#include "python/bindings.h"
#include "python/catalogue.h"
#include "python/own_estimate.h"
#include "python/python_solver.h"
#include "python/raise.h"

namespace sextant::python {
namespace {

namespace py = pybind11;

SolverEntry OwnEntry(const std::string& name, const std::string& summary, const SolverSpec& spec,
                     const py::function& bind, const std::vector<OptionDoc>& options) {
  // bind(options) -> f(problem): the function with its options set, which Python converts.
  const auto held = std::make_shared<py::function>(bind);
  return {.name = name,
          .summary = summary,
          .needs = "as registered in Python",
          .reference = "Python",
          .example = name,
          .options = options,
          .make = [spec, held](const SolverArguments& arguments) -> Expected<SolverPtr> {
            const py::gil_scoped_acquire gil;
            SolverSpec named = spec;
            named.name = arguments.name;
            py::dict values;
            for (const auto& [key, text] : arguments.options) values[py::str(key)] = text;
            try {
              return std::make_shared<PythonSolver>(named, (*held)(values).cast<py::function>());
            } catch (const py::error_already_set& raised) {
              return MakeError(ErrorCode::kInvalidOption,
                               named.name + ": " + std::string(py::str(raised.value())));
            }
          }};
}

void RegisterFunction(const std::string& name, const py::function& bind, const std::string& summary,
                      const std::vector<std::pair<std::string, std::string>>& options,
                      int pairs_3d3d, int pairs_2d3d, int points_per_set, bool initial_pose) {
  SolverSpec spec{.name = name};
  spec.needs = {.pairs_3d3d = pairs_3d3d,
                .pairs_2d3d = pairs_2d3d,
                .points_per_set = points_per_set,
                .initial_pose = initial_pose};
  spec.is_global = !initial_pose;
  std::vector<OptionDoc> docs;
  for (const auto& [key, value] : options) docs.push_back({key, value, "1", "an option of Python"});
  ValueOf(Register(OwnEntry(name, summary, spec, bind, docs)));
}

py::dict FaultsByName() {
  py::dict result;
  for (const auto& [name, faults] : TakeFaults()) {
    result[py::str(name)] = py::make_tuple(faults.count, faults.first);
  }
  return result;
}

}  // namespace

void BindOwnSolvers(py::module_& module) {
  py::class_<OwnEstimate>(
      module, "Estimate",
      "What a solver of your own may return instead of a matrix.\n\n"
      "matrix: cam_from_lidar, (4, 4) or (3, 4), metres. covariance: (6, 6) of\n"
      "(dphi [rad], dt [m]), R = Exp(dphi) R_hat, t = t_hat + dt. inliers:\n"
      "numbers of the pairs used; None: all. alternatives: (K, 4, 4).")
      .def(py::init(&MakeOwnEstimate), py::arg("matrix"), py::kw_only(),
           py::arg("covariance") = py::none(), py::arg("inliers") = py::none(),
           py::arg("alternatives") = py::tuple(), py::arg("warnings") = py::tuple(),
           py::arg("iterations") = 0);
  module.def("register_function", &RegisterFunction, py::arg("name"), py::arg("bind"),
             py::arg("summary"), py::arg("options"), py::kw_only(), py::arg("pairs_3d3d"),
             py::arg("pairs_2d3d"), py::arg("points_per_set"), py::arg("initial_pose"));
  module.def("take_faults", &FaultsByName);
}

}  // namespace sextant::python
