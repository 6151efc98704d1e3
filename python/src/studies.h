#pragma once
// Batches, plans, charts, sweeps and pictures for Python, by the study and view libraries.

#include "handle.h"

#include <pybind11/pybind11.h>

namespace seldinger::python {

/// Adds batch(), plan(), chart(), sweep() and render().
void bind_studies(pybind11::module_& module);

}  // namespace seldinger::python
