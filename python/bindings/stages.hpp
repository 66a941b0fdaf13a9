// Single steps of the pipeline: registration, simulation, export.
#pragma once

#include <pybind11/pybind11.h>

namespace sparsha::python {

void bind_stages(pybind11::module_& module);

}  // namespace sparsha::python
