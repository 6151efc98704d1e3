#pragma once
// Forces that are written in Python.

#include "handle.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

namespace seldinger::python {

namespace py = pybind11;

/// The world whose force this thread is calling, null: none. It is locked, and in the middle of a step.
[[nodiscard]] const Handle* asking_handle();
/// @param own  a seldinger.Force   @param about  what it says of itself, checked by the package
[[nodiscard]] std::shared_ptr<const Force> python_force(const Handle& handle, const py::object& own, const py::dict& about);

}  // namespace seldinger::python
