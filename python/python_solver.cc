// SPDX-License-Identifier: Apache-2.0
#include "python/python_solver.h"

#include <fmt/core.h>

#include <utility>

#include "python/module_types.h"
#include "python/own_estimate.h"
#include "python/raise.h"

namespace sextant::python {
namespace {

namespace py = pybind11;

// Guarded by the GIL.
std::map<std::string, SolverFaults>& Faults() {
  static std::map<std::string, SolverFaults> faults;
  return faults;
}

tl::unexpected<Error> Fault(const std::string& solver, ErrorCode code, std::string message) {
  SolverFaults& faults = Faults()[solver];
  if (++faults.count == 1) faults.first = message;
  return MakeError(code, solver + ": " + std::move(message));
}

std::shared_ptr<const py::function> ReleasedUnderGil(py::function function) {
  return {new py::function(std::move(function)), [](const py::function* held) {
            const py::gil_scoped_acquire gil;
            delete held;
          }};
}

// " (my_solver.py:12)": where the innermost frame was; empty where Python does not know.
std::string PlaceOf(const py::error_already_set& raised) {
  if (!raised.trace()) return {};
  const py::list frames = py::module_::import("traceback").attr("extract_tb")(raised.trace());
  if (frames.empty()) return {};
  const py::object frame = frames[frames.size() - 1];
  return fmt::format(" ({}:{})", frame.attr("filename").cast<std::string>(),
                     frame.attr("lineno").cast<int>());
}

bool IsOfType(const py::error_already_set& raised, const char* module, const char* name) {
  return raised.matches(py::module_::import(module).attr(name));
}

// sextant.Error keeps its code; numpy's LinAlgError means degenerate data.
ErrorCode CodeOf(const py::error_already_set& raised) {
  if (IsOfType(raised, "numpy.linalg", "LinAlgError")) return ErrorCode::kDegenerate;
  if (!IsOfType(raised, "sextant._error", "Error")) return ErrorCode::kInvalidInput;
  const std::string code = py::str(raised.value().attr("code"));
  for (int i = 0; i <= static_cast<int>(ErrorCode::kUnwritable); ++i) {
    if (ToString(static_cast<ErrorCode>(i)) == code) return static_cast<ErrorCode>(i);
  }
  return ErrorCode::kInvalidInput;
}

tl::unexpected<Error> Refusal(const std::string& solver, const py::error_already_set& raised) {
  if (raised.matches(PyExc_KeyboardInterrupt)) NoteInterrupt();
  const std::string message = py::str(raised.value());
  if (IsOfType(raised, "sextant._error", "Error")) {
    return MakeError(CodeOf(raised), solver + ": " + message);
  }
  const std::string type = py::str(raised.type().attr("__name__"));
  const std::string text =
      fmt::format("{}{}{}{}", type, message.empty() ? "" : ": ", message, PlaceOf(raised));
  const ErrorCode code = CodeOf(raised);
  // Degenerate data is no mistake of the function.
  if (code == ErrorCode::kDegenerate) return MakeError(code, solver + ": " + text);
  return Fault(solver, code, text);
}

}  // namespace

PythonSolver::PythonSolver(SolverSpec spec, py::function function)
    : Solver(std::move(spec)), function_(ReleasedUnderGil(std::move(function))) {}

Expected<Estimate> PythonSolver::DoSolve(const CalibrationProblem& problem) const {
  const py::gil_scoped_acquire gil;
  try {
    // A copy, because the function may keep it.
    const ModuleProblem seen{.data = std::make_shared<CalibrationProblem>(problem)};
    return EstimateFromAnswer((*function_)(seen), problem, spec().needs);
  } catch (const py::error_already_set& raised) {
    try {
      return Refusal(spec().name, raised);
    } catch (const py::error_already_set&) {
      return Fault(spec().name, ErrorCode::kInvalidInput, "an exception whose text raises another");
    }
  } catch (const ErrorException& exception) {
    const Error& error = exception.error();
    // None is the way to say that there is no pose.
    if (error.code == ErrorCode::kNoConsensus) {
      return MakeError(error.code, spec().name + ": " + error.message);
    }
    return Fault(spec().name, error.code, error.message);
  } catch (const std::exception& exception) {
    return Fault(spec().name, ErrorCode::kInvalidInput, exception.what());
  }
}

std::map<std::string, SolverFaults> TakeFaults() { return std::exchange(Faults(), {}); }

}  // namespace sextant::python
