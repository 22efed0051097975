// SPDX-License-Identifier: Apache-2.0
#include "python/raise.h"

namespace sextant::python {
namespace {

// Guarded by the GIL.
bool interrupt_noted = false;

}  // namespace

void NoteInterrupt() { interrupt_noted = true; }

void RaiseInterrupt() {
  if (interrupt_noted) {
    interrupt_noted = false;
    PyErr_SetNone(PyExc_KeyboardInterrupt);
    throw pybind11::error_already_set();
  }
  if (PyErr_CheckSignals() != 0) throw pybind11::error_already_set();
}

void EndIfInterrupted() {
  const pybind11::gil_scoped_acquire gil;
  RaiseInterrupt();
}

}  // namespace sextant::python
