#include "python/bindings/settings.hpp"

#include <fmt/format.h>

#include "base/error.h"
#include "base/yaml/yaml.h"
#include "scene/config/override.h"

namespace sparsha::python {
namespace py = pybind11;

std::string text_of(const py::handle& value) {
  return py::module_::import("sparsha._settings").attr("text")(value).cast<std::string>();
}

py::str str_of(std::string_view text) {
  PyObject* const made = PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "surrogateescape");
  if (made == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(made);
}

std::string bytes_of(const py::handle& text) {
  const auto bytes =
      py::reinterpret_steal<py::bytes>(PyUnicode_AsEncodedString(text.ptr(), "utf-8", "surrogateescape"));
  if (!bytes) throw py::error_already_set();
  return bytes;
}

std::vector<std::string> settings_of(const py::dict& settings) {
  std::vector<std::string> found;
  if (settings.empty()) return found;
  for (const py::handle& item : py::module_::import("sparsha._settings").attr("assignments")(settings)) {
    found.push_back(bytes_of(item));
  }
  return found;
}

namespace {

bool is_path(const py::handle& object) {
  return py::isinstance<py::str>(object) || py::isinstance<py::bytes>(object) || py::hasattr(object, "__fspath__");
}

std::string encoded(const py::handle& path, const char* name) {
  const std::string bytes = py::bytes(py::module_::import("os").attr("fsencode")(path));
  if (bytes.find('\0') != std::string::npos) {
    throw usage_error(fmt::format("{} has a NUL character in it", name), "a path without one");
  }
  return bytes;
}

}  // namespace

std::string path_of(const py::handle& given, const char* name) {
  if (is_path(given)) return encoded(given, name);
  throw py::type_error(fmt::format("{} is {}; expected a path", name, Py_TYPE(given.ptr())->tp_name));
}

std::optional<py::list> items_of(const py::handle& given) {
  if (is_path(given)) return std::nullopt;
  if (!py::isinstance(given, py::module_::import("collections.abc").attr("Sequence"))) return std::nullopt;
  return py::list(py::reinterpret_borrow<py::object>(given));
}

std::vector<std::string> paths_of(const py::handle& given, const char* name) {
  if (is_path(given)) return {encoded(given, name)};
  const std::optional<py::list> items = items_of(given);
  if (!items) {
    throw py::type_error(
        fmt::format("{} is {}; expected a path or a list of paths", name, Py_TYPE(given.ptr())->tp_name));
  }
  std::vector<std::string> paths;
  for (const py::handle& item : *items) paths.push_back(path_of(item, name));
  return paths;
}

unsigned threads_of(const py::handle& given) {
  constexpr long long kMost = 1024;
  const py::object whole = py::reinterpret_steal<py::object>(PyNumber_Index(given.ptr()));
  if (!whole) {
    PyErr_Clear();
    throw py::type_error(fmt::format("threads is {}; expected a whole number", Py_TYPE(given.ptr())->tp_name));
  }
  int beyond = 0;
  const long long threads = PyLong_AsLongLongAndOverflow(whole.ptr(), &beyond);
  if (beyond != 0 || threads < 0 || threads > kMost) {
    throw usage_error("threads is " + py::str(whole).cast<std::string>(),
                      fmt::format("0 to {}, where 0 is one a core", kMost));
  }
  return static_cast<unsigned>(threads);
}

scene::Config config_of_text(const std::string& text, const std::vector<std::string>& settings) {
  yaml::Node root = yaml::parse_text(text, "the configuration");
  scene::override_keys(root, settings);
  return scene::parse_config(root, {});
}

}  // namespace sparsha::python
