// The module sparsha._core; the package around it is python/sparsha.
#include <pybind11/pybind11.h>

#include "base/system.h"
#include "python/bindings/cloud.hpp"
#include "python/bindings/monitor.hpp"
#include "python/bindings/renderer.hpp"
#include "python/bindings/running.hpp"
#include "python/bindings/scene.hpp"
#include "python/bindings/stages.hpp"

PYBIND11_MODULE(_core, module) {
  module.doc() = "Sparsha's core: clouds, scenes and the force on a hand.";
  module.attr("__version__") = SPARSHA_VERSION;
  // A scan that is cut short while it is read is an InputError and not the end of the interpreter.
  sparsha::system::survive_cut_files();
  sparsha::python::translate_errors();
  sparsha::python::bind_cloud(module);
  sparsha::python::bind_scene(module);
  sparsha::python::bind_renderer(module);
  sparsha::python::bind_stages(module);
  sparsha::python::bind_monitor(module);
}
