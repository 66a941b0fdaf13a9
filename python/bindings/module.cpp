// The module sparsha._core; the package around it is python/sparsha.
#include <pybind11/pybind11.h>

#include <cstdlib>
#include <string>

#include "base/system.h"
#include "python/bindings/cloud.hpp"
#include "python/bindings/monitor.hpp"
#include "python/bindings/renderer.hpp"
#include "python/bindings/running.hpp"
#include "python/bindings/scene.hpp"
#include "python/bindings/stages.hpp"

namespace {

/// pybind11 before 2.12 takes NumPy 2's types for those of NumPy 1, and would read past their ends.
void require_known_numpy() {
#if PYBIND11_VERSION_HEX < 0x020C0000
  const std::string version = pybind11::str(pybind11::module_::import("numpy").attr("__version__"));
  if (std::atoi(version.c_str()) >= 2) {
    throw pybind11::import_error("sparsha was built by a pybind11 that knows NumPy 1 alone, and NumPy is " + version +
                                 "; use numpy<2, or build sparsha with pybind11 2.12 or newer");
  }
#endif
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  require_known_numpy();
  module.doc() = "Sparsha's core: clouds, scenes and the force on a hand.";
  module.attr("__version__") = SPARSHA_VERSION;
  // A scan that is cut short while it is read is an InputError and not the end of the interpreter.
  sparsha::system::survive_cut_files();
  sparsha::python::end_work_with_the_interpreter();
  sparsha::python::translate_errors();
  sparsha::python::bind_cloud(module);
  sparsha::python::bind_scene(module);
  sparsha::python::bind_renderer(module);
  sparsha::python::bind_stages(module);
  sparsha::python::bind_monitor(module);
}
