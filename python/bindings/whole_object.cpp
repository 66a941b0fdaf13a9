// A whole object's nodes and its mesh as arrays.
#include <fmt/format.h>
#include <pybind11/numpy.h>

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "base/error.h"
#include "base/threads/thread_pool.h"
#include "pipeline/export/chart_nodes.h"
#include "pipeline/export/whole_mesh.h"
#include "python/bindings/arrays.hpp"
#include "python/bindings/running.hpp"
#include "python/bindings/scene.hpp"
#include "python/bindings/settings.hpp"

namespace sparsha::python {
namespace py = pybind11;

namespace {

const scene::Charts& charts_of(const BuiltScene& built) {
  const auto& charts = built.scene->description().charts;
  if (!charts) throw usage_error("the scene has no whole object", "a scene built with a block `around`");
  return *charts;
}

/// What the nodes have, in the order of their sheets.
struct Nodes {
  std::vector<Eigen::Vector3d> place_m;
  std::vector<Eigen::Vector3f> normal;
  std::vector<std::int32_t> sheet;
  std::vector<float> texture_m, intensity;
  std::vector<std::uint32_t> colour;
};

/// Rows of three numbers.
template <typename Row>
py::object rows(const std::vector<Row>& values, const py::object& keeper) {
  using Value = typename Row::value_type;
  static_assert(sizeof(Row) == 3 * sizeof(Value));
  const auto step = static_cast<py::ssize_t>(sizeof(Value));
  const auto* data = reinterpret_cast<const Value*>(values.data());
  return view(data, {static_cast<py::ssize_t>(values.size()), 3}, {3 * step, step}, keeper);
}

/// One number a row, or None where there are none.
template <typename Value>
py::object column(const std::vector<Value>& values, const py::object& keeper) {
  if (values.empty()) return py::none();
  const auto step = static_cast<py::ssize_t>(sizeof(Value));
  return view(values.data(), {static_cast<py::ssize_t>(values.size())}, {step}, keeper);
}

py::object colours(const std::vector<std::uint32_t>& rgba, const py::object& keeper) {
  if (rgba.empty()) return py::none();
  return colour_view(rgba, {static_cast<py::ssize_t>(rgba.size())}, keeper);
}

py::dict nodes(const BuiltScene& built, const py::object& progress) {
  const scene::Charts& charts = charts_of(built);
  const auto found = std::make_shared<Nodes>();
  run_without_lock(progress, [&](Progress& told) {
    told.begin("nodes");
    pipeline::for_each_chart_node(
        *built.scene, told,
        [&](const Eigen::Vector3d& place_m, const Eigen::Vector3d& normal, std::size_t number, std::size_t node) {
          const scene::Sheet& sheet = charts.sheets[number];
          found->place_m.push_back(place_m);
          found->normal.emplace_back(normal.cast<float>());
          found->sheet.push_back(static_cast<std::int32_t>(number));
          if (!sheet.texture_m.empty()) found->texture_m.push_back(sheet.texture_m[node]);
          if (!sheet.intensity.empty()) found->intensity.push_back(sheet.intensity[node]);
          if (!sheet.colour_rgba.empty()) found->colour.push_back(sheet.colour_rgba[node]);
        });
    told.finish();
  });
  const py::capsule keeper = keeper_of(std::shared_ptr<const Nodes>(found));
  py::dict result;
  result["place"] = rows(found->place_m, keeper);
  result["normal"] = rows(found->normal, keeper);
  result["sheet"] = column(found->sheet, keeper);
  result["texture"] = column(found->texture_m, keeper);
  result["colour"] = colours(found->colour, keeper);
  result["intensity"] = column(found->intensity, keeper);
  return result;
}

py::dict mesh(const BuiltScene& built, const std::string& holes, const py::object& threads,
              const py::object& progress) {
  (void)charts_of(built);
  if (holes != "close" && holes != "leave")
    throw usage_error(fmt::format("holes is '{}'", holes), "'close', or 'leave': open where no scan saw the object");
  const unsigned count = threads_of(threads);
  const auto found = std::make_shared<pipeline::WholeMesh>();
  run_without_lock(progress, [&](Progress& told) {
    ThreadPool pool(count);
    *found = pipeline::whole_mesh(*built.scene, holes == "close" ? pipeline::Holes::close : pipeline::Holes::leave,
                                  {pool, told});
  });
  const py::capsule keeper = keeper_of(std::shared_ptr<const pipeline::WholeMesh>(found));
  py::dict result;
  result["vertices"] = rows(found->places_m, keeper);
  result["triangles"] = rows(found->triangles, keeper);
  result["colour"] = colours(found->colours, keeper);
  result["unseen"] = found->facts.unseen();
  return result;
}

}  // namespace

void bind_whole_object(py::class_<BuiltScene, std::shared_ptr<BuiltScene>>& scene) {
  scene
      .def("nodes", &nodes, py::kw_only(), py::arg("progress") = py::none(),
           R"(The measured nodes of a whole object, sheet by sheet, as a dict of arrays with one row a node.

"place" (n, 3) float64, metres, and "normal" (n, 3) float32, outward: in the frame of the scans. "sheet" (n,) int32.
"texture" (n,) float32, metres before the envelope along the normal; "colour" (n, 4) uint8: red, green, blue, alpha,
all 0 where no point near has any; "intensity" (n,) float32, NaN likewise: None without them. Raises UsageError for a
scene with one view alone; KeyboardInterrupt.)")
      .def("mesh", &mesh, py::kw_only(), py::arg("holes") = "close", py::arg("threads") = 0,
           py::arg("progress") = py::none(),
           R"(One mesh of a whole object in the frame of the scans, as `sparsha export` writes it: a dict of arrays.

"vertices" (n, 3) float64, metres; "triangles" (m, 3) uint32, counter-clockwise as seen from outside; "colour" (n, 4)
uint8 or None; "unseen": the share of the surface that no scan saw. holes: "close" or "leave" what that is. Raises
UsageError for a scene with one view alone or an object too large for its spacing; InputError where half of the closed
surface would be made up; KeyboardInterrupt.)");
}

}  // namespace sparsha::python
