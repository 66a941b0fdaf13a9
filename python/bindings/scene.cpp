// A scene's layers as arrays.
#include "python/bindings/scene.hpp"

#include <fmt/format.h>
#include <pybind11/numpy.h>

#include <cmath>
#include <utility>
#include <vector>

#include "base/error.h"
#include "base/files/files.h"
#include "haptics/window/surface.h"
#include "python/bindings/arrays.hpp"
#include "python/bindings/running.hpp"
#include "python/bindings/settings.hpp"

namespace sparsha::python {
namespace py = pybind11;

BuiltPointer scene_of(const py::handle& given) {
  if (py::isinstance<BuiltScene>(given)) {
    static_cast<void>(given.cast<const BuiltScene&>());  // raises for one that was never made
    return given.cast<std::shared_ptr<BuiltScene>>();
  }
  throw py::type_error(fmt::format("the scene is {}; expected a sparsha.Scene, e.g. of sparsha.open(folder)",
                                   Py_TYPE(given.ptr())->tp_name));
}

namespace {

constexpr std::size_t kMostReport = std::size_t{64} << 20;  // bytes

using LayersPointer = std::shared_ptr<const scene::Layers>;

void require_level(const BuiltScene& built, int level) {
  const std::size_t count = built.scene->description().levels.size();
  if (level < 0 || static_cast<std::size_t>(level) >= count) {
    throw usage_error(fmt::format("the scene has no level {}", level), fmt::format("0 to {}", count - 1));
  }
}

/// Of a scene in memory without a copy; else read from disk.
LayersPointer layers_of(const BuiltScene& built, int level) {
  require_level(built, level);
  if (const scene::Layers* layers = built.scene->in_memory(level)) return {built.scene, layers};
  const Unlocked unlocked;
  return std::make_shared<const scene::Layers>(built.scene->read_level(level));
}

template <typename Value>
py::object layer(const LayersPointer& layers, const std::vector<Value>& values) {
  if (values.empty()) return py::none();
  const scene::Lattice& lattice = layers->grid.lattice;
  return node_view(values, lattice.nx, lattice.ny, keeper_of(layers));
}

py::object floats_of(const BuiltScene& built, int level, std::vector<float> scene::Layers::*member) {
  const LayersPointer layers = layers_of(built, level);
  return layer(layers, (*layers).*member);
}

py::object heights(const BuiltScene& built, int level) {
  const LayersPointer layers = layers_of(built, level);
  return layer(layers, layers->grid.height_m);
}

py::object mask(const BuiltScene& built, int level) {
  const LayersPointer layers = layers_of(built, level);
  const scene::Lattice& lattice = layers->grid.lattice;
  static_assert(sizeof(scene::NodeState) == 1);
  return view(reinterpret_cast<const std::uint8_t*>(layers->grid.state.data()), {lattice.ny, lattice.nx},
              {lattice.nx, 1}, keeper_of(layers));
}

py::object texture(const BuiltScene& built, int level) {
  const LayersPointer layers = layers_of(built, level);
  if (layers->envelope_m.empty()) return py::none();
  const scene::Lattice& lattice = layers->grid.lattice;
  py::array_t<float> difference({lattice.ny, lattice.nx});
  float* const out = difference.mutable_data();
  for (std::size_t n = 0; n < lattice.count(); ++n) out[n] = layers->grid.height_m[n] - layers->envelope_m[n];
  return difference;
}

py::object friction(const BuiltScene& built, int level, double scale) {
  if (!(scale > 0.0) || !std::isfinite(scale)) throw usage_error("scale is not positive", "device metres a grid metre");
  const LayersPointer layers = layers_of(built, level);
  const auto map = std::make_shared<haptics::FrictionMap>();
  {
    const Unlocked unlocked;
    *map = haptics::evaluate_friction(built.scene->description(), *layers, level, scale);
  }
  if (map->mu_dynamic.empty()) return py::none();
  const scene::Lattice& lattice = layers->grid.lattice;
  const py::capsule keeper = keeper_of(std::shared_ptr<const haptics::FrictionMap>(map));
  return py::make_tuple(node_view(map->mu_dynamic, lattice.nx, lattice.ny, keeper),
                        node_view(map->mu_static, lattice.nx, lattice.ny, keeper));
}

py::object colour(const BuiltScene& built, int level) {
  const LayersPointer layers = layers_of(built, level);
  if (layers->colour_rgba.empty()) return py::none();
  const scene::Lattice& lattice = layers->grid.lattice;
  return colour_view(layers->colour_rgba, {lattice.ny, lattice.nx}, keeper_of(layers));
}

py::object report(const BuiltScene& built) {
  std::string text = built.report_json;
  const std::filesystem::path file = built.scene->folder() / "report.json";
  std::error_code code;
  if (text.empty() && !built.scene->folder().empty() && std::filesystem::exists(file, code)) {
    text = read_file(file, kMostReport);
  }
  if (text.empty()) return py::none();
  return py::module_::import("json").attr("loads")(text);
}

const scene::Lattice& lattice_of(const BuiltScene& built, int level) {
  require_level(built, level);
  return built.scene->description().levels[static_cast<std::size_t>(level)];
}

}  // namespace

void bind_scene(py::module_& module) {
  py::class_<BuiltScene, std::shared_ptr<BuiltScene>> scene(
      module, "Scene", R"(What can be touched: a depth grid z = f(x, y) with its layers, at several levels of detail.

By sparsha.build(...) or sparsha.open(folder). Immutable; several threads may use one or several scenes.

Arrays have the shape (ny, nx): row 0 lies at the smallest y, column 0 at the smallest x. Node (j, i) of level L lies
at x = origin[0] + i * spacing(L), y = origin[1] + j * spacing(L), z = origin[2] + heights(L)[j, i], in metres of the
grid frame; scan_from_grid takes that to the frame of the scans. Arrays are read-only; those of a scene in memory are
views of its own buffers. Methods raise UsageError for a level that is not there, InputError for tiles on disk that
cannot be read.)");
  require_made<BuiltScene>();
  const auto level = py::arg("level") = 0;
  scene
      .def_property_readonly(
          "levels", [](const BuiltScene& s) { return s.scene->description().levels.size(); }, "Number of levels.")
      .def(
          "shape", [](const BuiltScene& s, int l) { return py::make_tuple(lattice_of(s, l).ny, lattice_of(s, l).nx); },
          level, "(ny, nx) of a level.")
      .def(
          "spacing", [](const BuiltScene& s, int l) { return lattice_of(s, l).spacing_m; }, level,
          "Distance of neighbouring nodes of a level, metres.")
      .def_property_readonly(
          "origin", [](const BuiltScene& s) { return array_of(lattice_of(s, 0).origin_m); },
          "(3,) float64, metres of the grid frame: node (0, 0) and the zero of heights.")
      .def_property_readonly(
          "scan_from_grid", [](const BuiltScene& s) { return array_of(s.scene->description().scan_from_grid); },
          "(4, 4) float64: homogeneous points of the grid frame to the scans' frame, metres.")
      .def("heights", &heights, level, "(ny, nx) float32, metres above origin[2], NaN where unknown.")
      .def("mask", &mask, level, "(ny, nx) uint8: 0 unknown, 1 measured, 2 filled.")
      .def(
          "envelope", [](const BuiltScene& s, int l) { return floats_of(s, l, &scene::Layers::envelope_m); }, level,
          "(ny, nx) float32: heights without texture, metres above origin[2]; None without a block `texture`.")
      .def("texture", &texture, level, "(ny, nx) float32: heights less envelope, metres; None without it. A copy.")
      .def("friction", &friction, level, py::arg("scale") = 1.0,
           R"((mu_dynamic, mu_static), each (ny, nx) float32, by the scene's law of friction; None without one.

scale: device metres a grid metre, which curvatures depend on. 0 where nothing was measured or filled.)")
      .def(
          "curvature", [](const BuiltScene& s, int l) { return floats_of(s, l, &scene::Layers::curvature_per_m); },
          level, "(ny, nx) float32: root-mean-square curvature of the texture, 1/m; None without it.")
      .def("colour", &colour, level, "(ny, nx, 4) uint8: red, green, blue, alpha; None without colours.")
      .def(
          "intensity", [](const BuiltScene& s, int l) { return floats_of(s, l, &scene::Layers::intensity); }, level,
          "(ny, nx) float32 as the scans have it, NaN where unknown; None without it.")
      .def_property_readonly("report", &report, "What the build found, as a dict (report.json); None without one.")
      .def_property_readonly(
          "config", [](const BuiltScene& s) { return str_of(scene::to_yaml(s.scene->description().config)); },
          "The configuration as YAML, automatic values replaced by those that were used.")
      .def_property_readonly(
          "noise", [](const BuiltScene& s) { return s.scene->description().noise_m; },
          "Standard deviation of the scans' noise, metres, as it was estimated.")
      .def_property_readonly(
          "sheets",
          [](const BuiltScene& s) {
            const auto& charts = s.scene->description().charts;
            return charts ? charts->sheets.size() : std::size_t{0};
          },
          "Sheets of a whole object (a block `around`); 0 for a scene with one view alone.")
      .def_property_readonly(
          "folder",
          [](const BuiltScene& s) -> py::object {
            if (s.scene->folder().empty()) return py::none();
            return str_of(s.scene->folder().string());
          },
          "The folder on disk, or None for a scene in memory.")
      .def("__repr__", [](const BuiltScene& s) {
        const scene::Lattice& lattice = lattice_of(s, 0);
        return fmt::format("<sparsha.Scene of {} x {} nodes, {:.4g} mm apart, {} levels>", lattice.nx, lattice.ny,
                           1e3 * lattice.spacing_m, s.scene->description().levels.size());
      });
  bind_build(module, scene);
  bind_whole_object(scene);
}

}  // namespace sparsha::python
