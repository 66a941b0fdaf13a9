#include "python/bindings/renderer.hpp"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/inputs.h"
#include "base/error.h"
#include "haptics/replay/around_trace.h"
#include "haptics/replay/unrolled_trace.h"
#include "haptics/window/objects.h"
#include "python/bindings/arrays.hpp"
#include "python/bindings/running.hpp"
#include "python/bindings/settings.hpp"

namespace sparsha::python {
namespace py = pybind11;

namespace {

struct Trace : haptics::TraceResult {
  BuiltPointer touched;  ///< the scene, or null
};

constexpr py::ssize_t kMostNodes = 32768;  // of heights in one direction

/// Which of `names` a word is. Throws Error{usage}.
std::size_t choice(const std::string& key, const std::string& word, const std::vector<std::string>& names) {
  for (std::size_t n = 0; n < names.size(); ++n) {
    if (names[n] == word) return n;
  }
  std::string all;
  for (const std::string& name : names) all += (all.empty() ? "" : ", ") + name;
  throw usage_error(key + " is '" + word + "'", "one of " + all);
}

void refuse_around(bool given, const char* what) {
  if (given)
    throw usage_error(std::string(what) + " is not there for whole objects", "around=False for the front view");
}

double checked(double value, const char* name, double low, double high) {
  if (value >= low && value <= high) return value;
  throw usage_error(fmt::format("{} is {}", name, value), fmt::format("{:g} to {:g}", low, high));
}

std::unique_ptr<Renderer> make_renderer(const py::object& given, std::optional<int> level, const py::object& centre,
                                        bool texture, bool friction, double tip_radius_mm, const std::string& frame,
                                        const std::optional<std::string>& solver, const std::string& creases,
                                        std::optional<double> stiffness, std::optional<bool> around) {
  auto renderer = std::make_unique<Renderer>();
  renderer->scene = scene_of(given);
  const scene::SceneDescription& description = renderer->scene->scene->description();
  renderer->haptics = description.config.haptics;
  if (solver) {
    renderer->haptics.solver = choice("solver", *solver, {"exact", "paper"}) == 1 ? scene::HapticsConfig::Solver::paper
                                                                                  : scene::HapticsConfig::Solver::exact;
  }
  if (stiffness) renderer->haptics.stiffness_n_per_m = checked(*stiffness, "stiffness", 0.0, 1e6);
  if (choice("creases", creases, {"sharp", "rounded"}) == 1) renderer->options.shape = haptics::CellShape::rounded;
  if (renderer->haptics.surface == scene::HapticsConfig::Surface::c1) renderer->options.shape = haptics::CellShape::c1;
  constexpr haptics::HipFrame kFrames[] = {haptics::HipFrame::grid, haptics::HipFrame::scan, haptics::HipFrame::device};
  renderer->frame = kFrames[choice("frame", frame, {"grid", "scan", "device"})];
  renderer->grid_from_scan = description.scan_from_grid.inverse();
  haptics::TracedPart part;
  part.level = level.value_or(-1);
  if (level && *level < 0) throw usage_error(fmt::format("level is {}", *level), "0 or more");
  if (!centre.is_none()) {
    const Doubles xy = rows_of(centre, "centre", 0);
    if (xy.size() != 2) throw usage_error(fmt::format("centre has {} numbers", xy.size()), "2: x and y, grid frame");
    part.centre_m = {xy.data()[0], xy.data()[1]};
  }
  part.texture = texture;
  part.friction = friction;
  part.tip_radius_m = 1e-3 * checked(tip_radius_mm, "tip_radius_mm", 0.0, 2.0);
  const bool scans = renderer->frame == haptics::HipFrame::scan;
  if (around.value_or(scans && description.charts != nullptr)) {
    if (!description.charts) throw usage_error("the scene has no whole object", "a scene built with a block `around`");
    if (!scans) throw usage_error("a whole object is touched in the frame of its scans", "frame='scan'");
    refuse_around(renderer->haptics.solver == scene::HapticsConfig::Solver::paper, "the paper's solver");
    refuse_around(level || part.centre_m, "a window (level, centre)");
    refuse_around(part.tip_radius_m > 0.0, "tip_radius_mm");
    if (!texture && !haptics::has_envelope(*description.charts))
      throw usage_error("the sheets of this scene have no envelope for texture=False",
                        "a scene built with a block `texture`");
    const Eigen::Matrix3d turn = description.scan_from_grid.topLeftCorner<3, 3>();
    renderer->force_from_grid = turn / std::cbrt(std::abs(turn.determinant()));
    run_without_lock(py::none(), [&](Progress&) {
      renderer->object = haptics::whole_object(description, {texture, friction});
    });
    return renderer;
  }
  if (scans && description.config.unroll) {
    if (level || part.centre_m) {
      throw usage_error("a window (level, centre) has no scan frame on an unrolled object", "frame='grid' with it");
    }
    haptics::SurfaceOptions options;
    options.effects.texture = texture;
    options.effects.friction = friction;
    options.tip_radius_m = part.tip_radius_m;
    renderer->unrolled = options;
    return renderer;
  }
  run_without_lock(py::none(), [&](Progress& progress) {
    part.progress = &progress;
    renderer->surface = haptics::traced_surface(*renderer->scene->scene, part);
    progress.throw_if_cancelled();
  });
  return renderer;
}

/// A surface of the caller's own heights, without a scene.
std::unique_ptr<Renderer> renderer_of_heights(const py::object& given, double spacing, const py::object& origin,
                                              double mu_dynamic, std::optional<double> mu_static, double stiffness,
                                              const std::string& surface, const std::string& creases,
                                              const std::string& solver) {
  const py::array array = array_of(given, "heights", "real numbers");
  const Floats heights = float_rows_of(
      given, "heights", array.ndim() == 2 ? static_cast<int>(std::min(array.shape(1), kMostNodes)) : 2, Numbers::any);
  if (heights.shape(0) < 2 || heights.shape(1) < 2 || heights.shape(0) > kMostNodes) {
    throw usage_error(fmt::format("heights has the shape ({}, {})", heights.shape(0), heights.shape(1)),
                      fmt::format("2 to {} nodes in both directions", kMostNodes));
  }
  auto renderer = std::make_unique<Renderer>();
  haptics::SurfaceParts parts;
  parts.lattice.nx = static_cast<int>(heights.shape(1));
  parts.lattice.ny = static_cast<int>(heights.shape(0));
  parts.lattice.spacing_m = checked(spacing, "spacing", 1e-9, 1e6);
  if (!origin.is_none()) parts.lattice.origin_m = vector_of(origin, "origin");
  const double mu = checked(mu_dynamic, "mu_dynamic", 0.0, 10.0);
  const double mu_rest = checked(mu_static.value_or(mu), "mu_static", mu, 10.0);
  renderer->haptics.stiffness_n_per_m = checked(stiffness, "stiffness", 0.0, 1e6);
  if (choice("solver", solver, {"exact", "paper"}) == 1) renderer->haptics.solver = scene::HapticsConfig::Solver::paper;
  if (choice("creases", creases, {"sharp", "rounded"}) == 1) renderer->options.shape = haptics::CellShape::rounded;
  if (choice("surface", surface, {"bilinear", "c1"}) == 1) {
    renderer->haptics.surface = scene::HapticsConfig::Surface::c1;
    renderer->options.shape = haptics::CellShape::c1;
  }
  const float* const data = heights.data();
  const std::size_t count = parts.lattice.count();
  run_items(count, [&](Progress& progress) {
    parts.height_m.resize(count);
    in_pieces(count, progress, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        parts.height_m[n] = data[n];
        if (std::isinf(parts.height_m[n]))
          throw usage_error("heights has an infinite one", "finite ones, or NaN: unknown");
      }
    });
    if (mu_rest > 0.0) {
      parts.friction.mu_dynamic.assign(count, static_cast<float>(mu));
      parts.friction.mu_static.assign(count, static_cast<float>(mu_rest));
    }
    parts.progress = &progress;
    renderer->surface = haptics::make_surface(std::move(parts));
    progress.throw_if_cancelled();
  });
  return renderer;
}

std::vector<haptics::HipSample> samples_of(const py::object& path, const py::object& time, double rate_hz) {
  const Doubles rows = rows_of(path, "path", 3, Numbers::any);
  checked(rate_hz, "rate", 1e-3, 1e6);
  std::optional<Doubles> times;
  if (!time.is_none()) {
    times = rows_of(time, "time", 0, Numbers::any);
    if (times->size() != rows.shape(0)) {
      throw usage_error(fmt::format("time has {} rows", times->size()), fmt::format("{}, as path", rows.shape(0)));
    }
  }
  const auto count = static_cast<std::size_t>(rows.shape(0));
  const double* const places = rows.data();
  const double* const time_s = times ? times->data() : nullptr;
  std::vector<haptics::HipSample> samples;
  run_items(count, [&](Progress& progress) {
    samples.resize(count);
    in_pieces(count, progress, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        samples[n].t_s = time_s != nullptr ? time_s[n] : static_cast<double>(n) / rate_hz;
        samples[n].position_m = Eigen::Map<const Eigen::Vector3d>(places + 3 * n);
      }
    });
  });
  return samples;
}

/// What `renderer` is made of does not change, so that it may be read without the interpreter's lock.
haptics::TraceResult traced(const Renderer& renderer, std::vector<haptics::HipSample>& samples, Progress& progress) {
  progress.begin("trace");
  const scene::HapticsConfig& config = renderer.haptics;
  const haptics::SolverOptions& options = renderer.options;
  if (!renderer.scene) return haptics::trace(*renderer.surface, samples, config, options, &progress);
  const scene::Scene& scene = *renderer.scene->scene;
  const scene::SceneDescription& description = scene.description();
  if (renderer.unrolled) {
    return haptics::trace_unrolled(scene, samples, *renderer.unrolled, config, options, &progress);
  }
  if (renderer.object) {
    return haptics::trace_around(*renderer.object, samples, description.scan_from_grid, config, options, &progress);
  }
  haptics::to_grid_frame(samples, renderer.frame, description, *renderer.surface);
  return haptics::trace(*renderer.surface, samples, config, options, &progress);
}

std::shared_ptr<Trace> trace(const Renderer& renderer, const py::object& path, const py::object& time, double rate_hz,
                             const py::object& progress) {
  std::vector<haptics::HipSample> samples = samples_of(path, time, rate_hz);
  return std::make_shared<Trace>(Trace{run(progress,
                                           [&](Progress& told) {
                                             haptics::TraceResult result = traced(renderer, samples, told);
                                             for (const std::string& doubt : haptics::sentences(result.summary.path))
                                               told.warn(doubt);
                                             return result;
                                           }),
                                       renderer.scene});
}

constexpr auto kRow = static_cast<py::ssize_t>(sizeof(haptics::TraceRow));

py::array vectors(const py::object& self, Eigen::Vector3d haptics::TraceRow::*member) {
  const auto& rows = self.cast<const Trace&>().rows;
  const double* const first = rows.empty() ? nullptr : (rows.front().*member).data();
  return view(first, {static_cast<py::ssize_t>(rows.size()), 3}, {kRow, sizeof(double)}, self);
}

template <typename Value>
py::array column(const py::object& self, Value haptics::TraceRow::*member) {
  const auto& rows = self.cast<const Trace&>().rows;
  return view(rows.empty() ? nullptr : &(rows.front().*member), {static_cast<py::ssize_t>(rows.size())}, {kRow}, self);
}

py::dict summary(const Trace& trace) {
  const haptics::TraceSummary& s = trace.summary;
  py::dict told;
  told["updates"] = s.updates;
  told["contacts"] = s.contacts;
  told["below_surface"] = s.below_surface;
  told["not_a_number"] = s.not_a_number;
  told["unfinished"] = s.unfinished;
  told["outside"] = s.path.outside;
  told["outside_m"] = s.path.outside_m;
  told["largest_force_n"] = s.path.largest_force_n;
  told["ns_median"] = s.ns_p50;
  told["ns_p99"] = s.ns_p99;
  told["ns_max"] = s.ns_max;
  told["residual_cells_p99"] = s.residual_cells_p99;
  told["residual_cells_max"] = s.residual_cells_max;
  if (s.around) {
    told["sheets_touched"] = s.around->touched;
    told["hand_overs"] = s.around->hand_overs;
    told["edges"] = s.around->edges;
    told["releases"] = s.around->releases;
  }
  return told;
}

void bind_trace(py::module_& module) {
  using Row = haptics::TraceRow;
  py::class_<Trace, std::shared_ptr<Trace>> trace(module, "Trace",
                                                  R"(What a path of the hand was rendered to, row by row.

Arrays are read-only views. Places are metres in the grid frame, of a whole or an unrolled object that is touched in the
frame of its scans in that; forces newtons.)");
  require_made<Trace>();
  const auto vector_column = [&](const char* name, Eigen::Vector3d Row::*member, const char* text) {
    trace.def_property_readonly(
        name, [member](const py::object& self) { return vectors(self, member); }, text);
  };
  vector_column("hip", &Row::hip_m, "(n, 3) float64: the hand.");
  vector_column("proxy", &Row::proxy_m, "(n, 3) float64: where it is held; the hand itself where it is free.");
  vector_column("force", &Row::force_n, "(n, 3) float64: on the hand; zero where it is free.");
  trace.def("__len__", [](const Trace& t) { return t.rows.size(); })
      .def_property_readonly(
          "time", [](const py::object& self) { return column(self, &Row::t_s); }, "(n,) float64, seconds.")
      .def_property_readonly(
          "contact", [](const py::object& self) { return column(self, &Row::contact); }, "(n,) bool.")
      .def_property_readonly(
          "tick_ns", [](const py::object& self) { return column(self, &Row::tick_ns); },
          "(n,) float64: what the tick took, nanoseconds.")
      .def_property_readonly(
          "sheet", [](const py::object& self) { return column(self, &Row::sheet); },
          "(n,) int64: the sheet of a whole object that the proxy lies on; -1: none.")
      .def_property_readonly("summary", &summary, "Counts, times and residuals of all rows, as a dict.")
      .def(
          "save",
          [](const Trace& t, const py::object& file, const py::object& progress) {
            const std::string path = path_of(file, "file");
            if (t.touched) app::check_outputs({{"the file", path}}, *t.touched->scene);
            run(progress, [&](Progress& told) {
              told.begin("write");
              haptics::write_trace(path, t, &told);
              return 0;
            });
          },
          py::arg("file"), py::kw_only(), py::arg("progress") = py::none(),
          R"(Writes trace.csv as `sparsha trace` does.

progress: called with ("write", fraction). Raises Failure, UsageError; KeyboardInterrupt on Ctrl-C, which leaves no
file.)");
}

}  // namespace

void bind_renderer(py::module_& module) {
  bind_trace(module);
  py::class_<Renderer> renderer(module, "Renderer", R"(The force on a hand that touches a scene.

Renderer(scene, *, level=None, centre=None, texture=True, friction=True, tip_radius_mm=0.0, frame="grid", solver=None,
         creases="sharp", stiffness=None, around=None)

level, centre: a window of that level around (x, y), metres of the grid frame; neither: all of level 0 at its own size.
texture, friction: False leaves them out. tip_radius_mm: of the ball that touches, 0 to 2. frame: of places of the
hand, "grid", "scan" or "device"; an unrolled object in "scan" is traced along whole paths, without step().
solver: "exact", "paper" or None, the scene's. creases: "sharp" or "rounded". stiffness: N/m of the device, None: the
scene's. around: touch the whole object (frame="scan"); None: where there is one. Without governor, effects and the
limits of a device: the force is stiffness times the way from hand to proxy.

Raises UsageError. A Renderer is for one thread at a time; several of them share a scene.)");
  require_made<Renderer>();
  renderer
      .def(py::init(&make_renderer), py::arg("scene"), py::kw_only(), py::arg("level") = py::none(),
           py::arg("centre") = py::none(), py::arg("texture") = true, py::arg("friction") = true,
           py::arg("tip_radius_mm") = 0.0, py::arg("frame") = "grid", py::arg("solver") = py::none(),
           py::arg("creases") = "sharp", py::arg("stiffness") = py::none(), py::arg("around") = py::none())
      .def("trace", &trace, py::arg("path"), py::kw_only(), py::arg("time") = py::none(), py::arg("rate") = 1000.0,
           py::arg("progress") = py::none(),
           R"(Renders a whole path from its beginning, as `sparsha trace` does; step() goes on where it was.

path: (n, 3) metres; rows that are masked or not numbers are rendered as no number. time: (n,) seconds; None: n / rate, hertz.
progress: called with ("trace", fraction). Returns a Trace. The interpreter's lock is released. Raises TypeError,
UsageError; KeyboardInterrupt on Ctrl-C, within some milliseconds.)")
      .def_static("of_heights", &renderer_of_heights, py::arg("heights"), py::arg("spacing"), py::kw_only(),
                  py::arg("origin") = py::none(), py::arg("mu_dynamic") = 0.0, py::arg("mu_static") = py::none(),
                  py::arg("stiffness") = 800.0, py::arg("surface") = "bilinear", py::arg("creases") = "sharp",
                  py::arg("solver") = "exact",
                  R"(A Renderer of one's own heights, without a scene; they are touched as they are given.

heights: (ny, nx) metres above origin[2], row 0 at the smallest y, NaN or masked where unknown; kept in single precision.
spacing: of the nodes, metres. origin: (3,) metres, None: zero. mu_dynamic, mu_static: of all nodes. stiffness: N/m.
surface: "bilinear" or "c1", bicubic patches through the nodes. Raises TypeError, UsageError.)")
      .def("reset", &Renderer::reset, "The next step() starts the proxy anew.")
      .def_readonly("contact", &Renderer::contact, "Whether the last step() touched.")
      .def_property_readonly(
          "scale", [](const Renderer& r) { return r.surface ? r.surface->scale : 1.0; }, "Device metres a grid metre.");
  add_step(renderer);
}

}  // namespace sparsha::python
