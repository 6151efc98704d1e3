#pragma once
// Arrays of an Output as read-only NumPy views that keep it alive.

#include "output.h"

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <memory>

namespace seldinger::python {

namespace py = pybind11;

/// An Output as Python holds it: shared with the world until that steps on, never changed while anything refers to it.
struct OutputView {
    std::shared_ptr<const Output> data;
};

/// One instrument's part of it.
struct WireView {
    std::shared_ptr<const Output> data;
    std::size_t index = 0;
    [[nodiscard]] const WireOutput& wire() const { return data->wires[index]; }
};

/// Python itself makes no objects of this class: `Class.__new__(Class)` would be one without contents, and reading it a crash.
template <class... What>
void made_here_only(py::class_<What...>& made)
{
    auto* type = reinterpret_cast<PyTypeObject*>(made.ptr());
    type->tp_new = nullptr;
    PyType_Modified(type);
}

/// Adds the classes Output and InstrumentOutput.
void bind_output(py::module_& module);

}  // namespace seldinger::python
