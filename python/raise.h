// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/pybind11.h>

#include <exception>
#include <type_traits>
#include <utility>

#include "base/error.h"

namespace sextant::python {

/// An Error on its way to Python, where it becomes sextant.Error with its message and code.
class ErrorException final : public std::exception {
 public:
  explicit ErrorException(Error error) : error_(std::move(error)) {}
  const char* what() const noexcept override { return error_.message.c_str(); }
  const Error& error() const { return error_; }

 private:
  Error error_;
};

/// The value, or an ErrorException with the error.
template <class T>
T ValueOf(Expected<T> expected) {
  if (!expected) throw ErrorException(std::move(expected.error()));
  if constexpr (!std::is_void_v<T>) return *std::move(expected);
}

/// Notes that Python's interrupt ended a function that a solver called: the computation goes on
/// until RaiseInterrupt. Needs the GIL.
void NoteInterrupt();

/// Throws Python's KeyboardInterrupt where one was noted, or is pending on the main thread. Needs
/// the GIL; from any thread.
void RaiseInterrupt();

/// The same without the GIL, for the callbacks of long computations: the exception ends them.
void EndIfInterrupted();

/// Runs the computation while other Python threads run. It may touch no Python object.
template <class Computation>
auto WithoutGil(Computation&& computation) {
  const auto run = [&computation] {
    const pybind11::gil_scoped_release released;
    return computation();
  };
  if constexpr (std::is_void_v<decltype(computation())>) {
    run();
    RaiseInterrupt();
  } else {
    auto result = run();
    RaiseInterrupt();
    return result;
  }
}

}  // namespace sextant::python
