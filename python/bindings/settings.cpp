#include "python/bindings/settings.hpp"

#include <fmt/format.h>

#include "base/yaml/yaml.h"
#include "scene/config/override.h"

namespace sparsha::python {
namespace py = pybind11;

std::string text_of(const py::handle& value) {
  return py::module_::import("sparsha._settings").attr("text")(value).cast<std::string>();
}

std::vector<std::string> settings_of(const py::dict& settings) {
  std::vector<std::string> found;
  if (settings.empty()) return found;
  for (const py::handle& item : py::module_::import("sparsha._settings").attr("assignments")(settings)) {
    found.push_back(item.cast<std::string>());
  }
  return found;
}

namespace {

bool is_path(const py::handle& object) {
  return py::isinstance<py::str>(object) || py::isinstance<py::bytes>(object) || py::hasattr(object, "__fspath__");
}

std::string decoded(const py::handle& path) {
  return py::module_::import("os").attr("fsdecode")(path).cast<std::string>();
}

}  // namespace

std::string path_of(const py::handle& given, const char* name) {
  if (is_path(given)) return decoded(given);
  throw py::type_error(fmt::format("{} is {}; expected a path", name, Py_TYPE(given.ptr())->tp_name));
}

std::vector<std::string> paths_of(const py::handle& given, const char* name) {
  if (is_path(given)) return {decoded(given)};
  if (!py::isinstance<py::list>(given) && !py::isinstance<py::tuple>(given)) {
    throw py::type_error(
        fmt::format("{} is {}; expected a path or a list of paths", name, Py_TYPE(given.ptr())->tp_name));
  }
  std::vector<std::string> paths;
  for (const py::handle& item : given) paths.push_back(path_of(item, name));
  return paths;
}

scene::Config config_of_text(const std::string& text, const std::vector<std::string>& settings) {
  yaml::Node root = yaml::parse_text(text, "the configuration");
  scene::override_keys(root, settings);
  return scene::parse_config(root, {});
}

}  // namespace sparsha::python
