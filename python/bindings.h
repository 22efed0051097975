// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

// Each adds one idea to the module sextant._core. Classes first, as signatures name them.
namespace sextant::python {

void BindCamera(pybind11::module_& module);
void BindProblem(pybind11::module_& module);
void BindEstimate(pybind11::module_& module);
void BindSolve(pybind11::module_& module);
void BindOwnSolvers(pybind11::module_& module);
void BindExperiment(pybind11::module_& module);
void BindBoards(pybind11::module_& module);
void BindSimulate(pybind11::module_& module);
void BindCalibrate(pybind11::module_& module);
void BindCheck(pybind11::module_& module);

}  // namespace sextant::python
