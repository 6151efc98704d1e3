#pragma once
// Fluoroscopic pictures of a world as it is, for a policy or an eye.

#include <pybind11/pybind11.h>

namespace seldinger::python {

/// Adds fluoroscopy().
void bind_fluoroscopy(pybind11::module_& module);

}  // namespace seldinger::python
