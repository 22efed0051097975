// SPDX-License-Identifier: Apache-2.0
// solve and compare, and the list of solvers.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include "base/version.h"
#include "eval/metrics/compare.h"
#include "eval/metrics/default_specs.h"
#include "python/arrays.h"
#include "python/bindings.h"
#include "python/catalogue.h"
#include "python/module_types.h"
#include "python/raise.h"
#include "report/report_text.h"

namespace sextant::python {
namespace {

/// sextant.Comparison: the answers of several solvers to one problem.
struct ModuleComparison {
  ModuleProblem problem;
  std::vector<SolverPtr> solvers;
  std::vector<ComparisonRow> rows;
};

// The message that `sextant solve` prints.
Error NoAnswer(const ModuleProblem& problem, const std::string& solver, const Error& error) {
  const std::string place = problem.input.path.empty() ? "" : problem.input.path + ": ";
  return {error.code, fmt::format("{}no answer of {}: {}", place, solver, error.message)};
}

ModuleSolution SolveProblem(const ModuleProblem& problem, std::string spec) {
  const std::shared_ptr<const SolverRegistry> registry = Catalogue();
  if (spec.empty()) spec = WithoutGil([&] { return DefaultSpec(*registry, *problem.data); });
  const SolverPtr solver = ValueOf(registry->Make(spec));
  Expected<SolveReport> report = WithoutGil([&] { return solver->Solve(*problem.data); });
  if (!report) throw ErrorException(NoAnswer(problem, solver->spec().name, report.error()));
  return {problem, solver, *std::move(report)};
}

ModuleComparison CompareSolvers(const ModuleProblem& problem, std::vector<std::string> specs) {
  const std::shared_ptr<const SolverRegistry> registry = Catalogue();
  if (specs.empty()) specs = WithoutGil([&] { return DefaultSpecs(*registry, *problem.data); });
  if (specs.empty()) {
    throw ErrorException({ErrorCode::kMissingData,
                          fmt::format("no solver finds a pose from {} 3D-3D pairs and {} 2D-3D "
                                      "pairs; expected at least 3, and the camera for 2D-3D pairs",
                                      problem.input.pairs_3d3d, problem.input.pairs_2d3d)});
  }
  ModuleComparison comparison{.problem = problem, .solvers = {}, .rows = {}};
  for (const std::string& spec : specs) {
    comparison.solvers.push_back(ValueOf(registry->Make(spec)));
  }
  comparison.rows = WithoutGil(
      [&] { return Compare(*problem.data, comparison.solvers, problem.true_cam_from_lidar); });
  return comparison;
}

py::list SolutionsOf(const ModuleComparison& comparison) {
  py::list solutions;
  for (std::size_t i = 0; i < comparison.rows.size(); ++i) {
    const Expected<SolveReport>& report = comparison.rows[i].report;
    if (report) {
      solutions.append(ModuleSolution{comparison.problem, comparison.solvers[i], *report});
    } else {
      solutions.append(py::none());
    }
  }
  return solutions;
}

std::vector<std::string> NamesOf(const ModuleComparison& comparison) {
  std::vector<std::string> names;
  for (const ComparisonRow& row : comparison.rows) names.push_back(row.solver);
  return names;
}

py::dict FailuresOf(const ModuleComparison& comparison) {
  py::dict failures;
  for (const ComparisonRow& row : comparison.rows) {
    if (!row.report) failures[py::str(row.solver)] = row.report.error().message;
  }
  return failures;
}

// Distances (rotation [rad], translation [m]), NaN where there is none: (N, 2).
py::array_t<double> DistancesOf(const ModuleComparison& comparison,
                                std::optional<PoseDistance> ComparisonRow::*member) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::vector<Eigen::Vector2d> distances;
  for (const ComparisonRow& row : comparison.rows) {
    const std::optional<PoseDistance>& distance = row.*member;
    distances.emplace_back(distance ? distance->rotation_rad : kNone,
                           distance ? distance->translation_m : kNone);
  }
  return ArrayOf(distances);
}

std::string ComparisonJson(const ModuleComparison& comparison) {
  ResultFile file{
      .version = std::string(Version()), .input = comparison.problem.input, .results = {}};
  for (const ComparisonRow& row : comparison.rows) file.results.push_back({row.solver, row.report});
  return FormatResults(file);
}

py::list ListSolvers() {
  py::list solvers;
  for (const SolverEntry& entry : Catalogue()->entries()) {
    py::dict fields;
    fields["name"] = entry.name;
    fields["summary"] = entry.summary;
    fields["needs"] = entry.needs;
    fields["example"] = entry.example;
    fields["wraps_solver"] = entry.wraps_solver;
    solvers.append(fields);
  }
  return solvers;
}

void BindComparison(py::module_& module) {
  using C = ModuleComparison;
  py::class_<C>(module, "Comparison", "The answers of several solvers to one problem.")
      .def_property_readonly("solvers", &NamesOf, "Canonical names, in the order given.")
      .def_property_readonly("solutions", &SolutionsOf,
                             "A Solution for each solver, or None where it has no answer.")
      .def_property_readonly("failures", &FailuresOf, "{solver: why it has no answer}.")
      .def_property_readonly(
          "from_first", [](const C& c) { return DistancesOf(c, &ComparisonRow::from_first); },
          "Distance of each answer from the first one, (N, 2) [rad, m].")
      .def_property_readonly(
          "from_truth", [](const C& c) { return DistancesOf(c, &ComparisonRow::from_truth); },
          "Distance of each answer from the truth, where known, (N, 2) [rad, m].")
      .def("to_json", &ComparisonJson, "What `sextant compare --json` writes.")
      .def("__repr__", [](const C& c) { return DescribeComparison(c.rows); })
      .def("_repr_html_", [](const py::object& self) {
        return py::module_::import("sextant._notebook").attr("comparison_html")(self);
      });
}

}  // namespace

void BindSolve(py::module_& module) {
  BindComparison(module);
  module.def("solve_problem", &SolveProblem, py::arg("problem"), py::arg("solver"));
  module.def("compare_solvers", &CompareSolvers, py::arg("problem"), py::arg("solvers"));
  module.def("solvers", &ListSolvers,
             "Every solver: dicts with name, summary, needs, example, wraps_solver.");
}

}  // namespace sextant::python
