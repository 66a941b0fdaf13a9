// Devices that are listened to; no force is ever commanded from Python.
#pragma once

#include <pybind11/pybind11.h>

namespace sparsha::python {

void bind_monitor(pybind11::module_& module);

}  // namespace sparsha::python
