// SPDX-License-Identifier: Apache-2.0
// sextant._core: the library for Python. The package around it is in python/sextant.
#include <string>

#include "base/version.h"
#include "python/bindings.h"
#include "python/raise.h"

namespace py = pybind11;

namespace sextant::python {
namespace {

// sextant.Error(message, code), as sextant/_error.py defines it.
void SetPythonError(const Error& error) {
  const py::object type = py::module_::import("sextant._error").attr("Error");
  const py::object value = type(error.message, std::string(ToString(error.code)));
  PyErr_SetObject(type.ptr(), value.ptr());
}

void TranslateErrors() {
  py::register_exception_translator([](std::exception_ptr thrown) {
    try {
      if (thrown) std::rethrow_exception(thrown);
    } catch (const ErrorException& exception) {
      SetPythonError(exception.error());
    }
  });
}

}  // namespace
}  // namespace sextant::python

PYBIND11_MODULE(_core, module) {
  using namespace sextant::python;
  module.doc() = "The compiled part of sextant; use the package sextant.";
  module.attr("__version__") = std::string(sextant::Version());
  TranslateErrors();
  BindCamera(module);
  BindProblem(module);
  BindEstimate(module);
  BindSolve(module);
  BindOwnSolvers(module);
  BindExperiment(module);
  BindBoards(module);
  BindSimulate(module);
  BindCalibrate(module);
  BindCheck(module);
}
