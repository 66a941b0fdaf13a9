#include "python/bindings/cloud.hpp"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <optional>
#include <utility>

#include "app/inputs.h"
#include "base/error.h"
#include "base/threads/thread_pool.h"
#include "base/yaml/yaml.h"
#include "pipeline/filter/filter.h"
#include "pipeline/scan/origin.h"
#include "pipeline/scan/set.h"
#include "python/bindings/arrays.hpp"
#include "python/bindings/running.hpp"
#include "python/bindings/settings.hpp"
#include "scene/config/reader.h"

namespace sparsha::python {
namespace py = pybind11;
using pipeline::Cloud;

CloudPointer cloud_of(const py::handle& given) {
  static_cast<void>(given.cast<const Cloud&>());
  return given.cast<CloudPointer>();
}

namespace {

void require_rows(py::ssize_t rows, std::size_t points, const std::string& name) {
  if (static_cast<std::size_t>(rows) == points) return;
  throw usage_error(fmt::format("{} has {} rows", name, rows), fmt::format("{}, one for each point", points));
}

void set_points(Cloud& cloud, const Doubles& rows, const py::object& origin) {
  const auto count = static_cast<std::size_t>(rows.shape(0));
  if (count == 0) throw usage_error("points has no rows", "at least one point");
  const Eigen::Map<const Eigen::Matrix<double, 3, Eigen::Dynamic>> points(rows.data(), 3, rows.shape(0));
  const bool given = !origin.is_none();
  if (given) cloud.origin_m = vector_of(origin, "origin");
  run_items(count, [&](Progress& progress) {
    if (!given) {
      pipeline::PointSample sample;
      in_pieces(count, progress, [&](std::size_t begin, std::size_t end) {
        for (std::size_t n = begin; n < end; ++n) sample.add(points.col(static_cast<Eigen::Index>(n)));
      });
      cloud.origin_m = pipeline::common_origin(sample);
    }
    cloud.resize_points(count);
    float* const xyz1 = cloud.xyz1();
    in_pieces(count, progress, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) {
        const Eigen::Vector3f p = (points.col(static_cast<Eigen::Index>(n)) - cloud.origin_m).cast<float>();
        if (!p.allFinite()) {
          throw usage_error(fmt::format("row {} of points is too far from the others for single precision", n),
                            "coordinates in metres, or an origin nearby");
        }
        for (int axis = 0; axis < 3; ++axis) xyz1[4 * n + static_cast<std::size_t>(axis)] = p[axis];
      }
    });
  });
}

/// Fills `values`, one or several for each of `count` items, by fill(n); other threads go on meanwhile.
template <typename Values, typename Fill>
void fill_items(Values& values, std::size_t count, const Fill& fill) {
  run_items(count, [&](Progress& progress) {
    values.resize(count);
    in_pieces(count, progress, [&](std::size_t begin, std::size_t end) {
      for (std::size_t n = begin; n < end; ++n) values[n] = fill(n);
    });
  });
}

void set_colour(Cloud& cloud, const py::object& colour) {
  if (colour.is_none()) return;
  const py::array array = array_of(colour, "colour", "red, green, blue");
  const int columns = array.ndim() == 2 && array.shape(1) == 4 ? 4 : 3;
  const bool whole = array.dtype().kind() == 'u' || array.dtype().kind() == 'i';
  const auto pack = [columns](const auto* parts, const auto& part_of) {
    std::uint32_t rgba = columns == 4 ? 0 : 0xFF000000U;
    for (int c = 0; c < columns; ++c) rgba |= static_cast<std::uint32_t>(part_of(parts[c])) << (8 * c);
    return rgba;
  };
  const auto step = static_cast<std::size_t>(columns);
  if (whole) {
    const Integers rows = whole_rows_of(colour, "colour", columns, 0, 255);
    require_rows(rows.shape(0), cloud.size(), "colour");
    const std::int64_t* const parts = rows.data();
    fill_items(cloud.rgba, cloud.size(),
               [&](std::size_t n) { return pack(parts + step * n, [](std::int64_t part) { return part & 0xFF; }); });
    return;
  }
  const Doubles rows = rows_of(colour, "colour", columns);  // 0 to 1, as Open3D has them
  require_rows(rows.shape(0), cloud.size(), "colour");
  const double* const parts = rows.data();
  fill_items(cloud.rgba, cloud.size(), [&](std::size_t n) {
    return pack(parts + step * n, [&](double part) {
      if (!(part >= 0.0 && part <= 1.0)) {
        throw usage_error(fmt::format("row {} of colour holds {}", n, part),
                          "fractions from 0 to 1, or whole numbers from 0 to 255");
      }
      return std::lround(255.0 * part);
    });
  });
}

std::vector<float> one_a_point(const Cloud& cloud, const py::handle& given, const std::string& name) {
  const Floats rows = float_rows_of(given, name, 0, Numbers::any);
  require_rows(rows.shape(0), cloud.size(), name);
  const float* const data = rows.data();
  std::vector<float> values;
  fill_items(values, cloud.size(), [&](std::size_t n) { return data[n]; });
  return values;
}

void set_normals(Cloud& cloud, const py::object& normals) {
  if (normals.is_none()) return;
  const Floats rows = float_rows_of(normals, "normals", 3);
  require_rows(rows.shape(0), cloud.size(), "normals");
  const float* const data = rows.data();
  fill_items(cloud.normals, cloud.size(),
             [&](std::size_t n) { return Eigen::Vector3f(Eigen::Map<const Eigen::Vector3f>(data + 3 * n)); });
}

void set_faces(Cloud& cloud, const py::object& faces) {
  if (faces.is_none()) return;
  const Integers rows = whole_rows_of(faces, "faces", 3, 0, static_cast<std::int64_t>(cloud.size()) - 1);
  const std::int64_t* const data = rows.data();
  const auto last = static_cast<std::int64_t>(cloud.size()) - 1;
  fill_items(cloud.faces, static_cast<std::size_t>(rows.shape(0)), [&](std::size_t n) {
    std::array<std::uint32_t, 3> face{};
    for (std::size_t k = 0; k < 3; ++k) {
      // Within the points whatever another thread writes into the array meanwhile.
      face[k] = static_cast<std::uint32_t>(std::clamp<std::int64_t>(data[3 * n + k], 0, last));
    }
    return face;
  });
}

void set_fields(Cloud& cloud, const py::dict& fields) {
  for (const auto& [name, values] : fields) {
    const std::string key = pipeline::field_key(py::str(name).cast<std::string>());
    const bool plain = !key.empty() && std::all_of(key.begin(), key.end(),
                                                   [](unsigned char c) { return std::isalnum(c) != 0 || c == '_'; });
    if (!plain || pipeline::is_known_otherwise(key) || key == pipeline::kIntensityField) {
      throw usage_error("the field '" + key + "' cannot be one",
                        "a name of letters, digits and _ that is no coordinate, colour, normal or intensity");
    }
    const bool there = std::any_of(cloud.fields.begin(), cloud.fields.end(),
                                   [&](const pipeline::PointField& field) { return field.name == key; });
    if (there) throw usage_error("two fields are named '" + key + "'", "names that differ by more than their case");
    cloud.fields.push_back({key, one_a_point(cloud, values, "fields['" + key + "']")});
  }
}

CloudPointer cloud_of_arrays(const py::object& points, const py::object& origin, const py::object& colour,
                             const py::object& intensity, const py::object& normals, const py::object& faces,
                             const py::dict& fields) {
  auto cloud = std::make_shared<Cloud>();
  set_points(*cloud, rows_of(points, "points", 3), origin);
  set_colour(*cloud, colour);
  if (!intensity.is_none()) cloud->intensity = one_a_point(*cloud, intensity, "intensity");
  set_normals(*cloud, normals);
  set_faces(*cloud, faces);
  set_fields(*cloud, fields);
  return cloud;
}

/// Of scans as they are named, or of a configuration's.
std::vector<scene::ScanConfig> scans_of(const py::object& files, const py::object& units) {
  std::vector<scene::ScanConfig> scans;
  const auto with_units = [&](py::dict entry) {
    if (!units.is_none() && !entry.contains("units")) entry["units"] = units;
    return entry;
  };
  py::list entries;
  const std::optional<py::list> listed = items_of(files);
  const auto add = [&](const py::handle& scan) {
    if (py::isinstance<py::dict>(scan)) return entries.append(with_units(py::dict(scan.attr("copy")())));
    const std::string path = path_of(scan, "files");
    if (app::is_config(path)) {
      if (listed && py::len(*listed) > 1) {
        throw usage_error("a configuration and something else", "one CONFIG, or SCANs only");
      }
      scans = scene::load_config(path).scans;
      return;
    }
    py::dict entry;
    entry["file"] = str_of(path);
    entries.append(with_units(entry));
  };
  if (!listed) {
    add(files);
  } else {
    for (const py::handle& scan : *listed) add(scan);
  }
  if (!scans.empty()) return scans;
  if (py::len(entries) == 0) throw usage_error("no scans are named", "at least one file");
  py::dict config;
  config["scans"] = entries;
  return config_of_text(text_of(config), {}).scans;
}

CloudPointer read(const py::object& files, const py::object& units, const std::vector<std::string>& fields,
                  const py::object& progress) {
  const std::vector<scene::ScanConfig> scans = scans_of(files, units);
  std::vector<std::string> keys;
  for (const std::string& field : fields) keys.push_back(pipeline::field_key(field));
  return run(progress, [&](Progress& told) {
    told.begin("read");
    pipeline::ScanSet set(scans, pipeline::ScanSet::Keep::quickest, false, told, keys);
    set.require_fields();
    return std::make_shared<Cloud>(set.load(set.origin_m(), told, true));
  });
}

py::tuple filtered(const Cloud& cloud, const py::list& filters, double spacing_mm, const py::object& threads,
                   const py::object& progress) {
  const unsigned count = threads_of(threads);
  const yaml::Node node = yaml::parse_text(text_of(filters), "the filters");
  const std::vector<scene::FilterConfig> configs = scene::parse_filters(node);
  for (const scene::FilterConfig& config : configs) {
    const std::string field = pipeline::field_of(config);
    const bool known = field.empty() || field == pipeline::kIntensityField ||
                       std::any_of(cloud.fields.begin(), cloud.fields.end(),
                                   [&](const pipeline::PointField& f) { return f.name == field; });
    if (!known) throw usage_error("the cloud has no field '" + field + "'", "read(..., fields=['" + field + "'])");
  }
  const auto result = run(progress, [&](Progress& told) {
    told.begin("filter");
    auto left = std::make_shared<Cloud>(cloud);
    left->points = Cloud().points;
    left->resize_points(cloud.size());
    std::copy_n(cloud.xyz1(), 4 * cloud.size(), left->xyz1());
    ThreadPool pool(count);
    pipeline::FilterNeeds needs;
    needs.spacing_m = [&](const Cloud&) {
      if (!(spacing_mm > 0.0)) throw usage_error("the filter 'thin' needs the spacing of a grid", "spacing_mm=...");
      return 1e-3 * spacing_mm;
    };
    pipeline::FilterSteps steps = pipeline::apply_filters(*left, configs, {pool, told}, needs);
    return std::pair(left, std::move(steps));
  });
  py::list steps;
  for (const pipeline::FilterStep& step : result.second.steps) {
    py::dict told;
    told["name"] = step.name;
    told["removed"] = step.removed;
    told["found"] = str_of(step.found);
    steps.append(told);
  }
  return py::make_tuple(result.first, steps);
}

py::object view_of(const py::object& self, const char* what) {
  const Cloud& cloud = self.cast<const Cloud&>();
  const auto count = static_cast<py::ssize_t>(cloud.size());
  const std::string name = what;
  if (name == "points") return view(cloud.xyz1(), {count, 3}, {16, 4}, self);
  if (name == "colour") return cloud.rgba.empty() ? py::object(py::none()) : colour_view(cloud.rgba, {count}, self);
  if (name == "intensity") {
    if (cloud.intensity.empty()) return py::none();
    return view(cloud.intensity.data(), {count}, {4}, self);
  }
  if (name == "normals") {
    if (cloud.normals.empty()) return py::none();
    return view(cloud.normals.front().data(), {count, 3}, {12, 4}, self);
  }
  return view(cloud.faces.empty() ? nullptr : cloud.faces.front().data(),
              {static_cast<py::ssize_t>(cloud.faces.size()), 3}, {12, 4}, self);
}

py::dict fields_of_cloud(const py::object& self) {
  py::dict fields;
  for (const pipeline::PointField& field : self.cast<const Cloud&>().fields) {
    fields[py::str(field.name)] = view(field.values.data(), {static_cast<py::ssize_t>(field.values.size())}, {4}, self);
  }
  return fields;
}

}  // namespace

void bind_cloud(py::module_& module) {
  py::class_<Cloud, CloudPointer> cloud(module, "Cloud", R"(Points of one or several scans, in metres.

Cloud(points, *, origin=None, colour=None, intensity=None, normals=None, faces=None, fields={})

points: (n, 3) real numbers, metres, finite; any strides, byte order and precision. origin: (3,), what single
precision is relative to; None: the median in whole metres, so that georeferenced points keep 0.1 mm.
colour: (n, 3) or (n, 4), whole numbers 0 to 255 or fractions 0 to 1. intensity: (n,), NaN or masked where unknown.
normals: (n, 3), they tell the outer side. faces: (m, 3) indices of triangles. fields: name -> (n,).

Raises TypeError for what is no array of numbers; UsageError for a wrong shape, numbers that are masked or not finite
(with their row), rows that are one row repeated, and more memory than the machine or the array has.

All arrays that a cloud gives are read-only views of its own buffers; they keep it alive.)");
  require_made<Cloud>();
  cloud
      .def(py::init(&cloud_of_arrays), py::arg("points"), py::kw_only(), py::arg("origin") = py::none(),
           py::arg("colour") = py::none(), py::arg("intensity") = py::none(), py::arg("normals") = py::none(),
           py::arg("faces") = py::none(), py::arg("fields") = py::dict())
      .def("__len__", [](const Cloud& c) { return c.size(); })
      .def("__repr__",
           [](const Cloud& c) {
             return fmt::format("<sparsha.Cloud of {} points, {} triangles>", c.size(), c.faces.size());
           })
      .def_property_readonly(
          "points", [](const py::object& self) { return view_of(self, "points"); },
          "(n, 3) float32, metres relative to `origin`; a view.")
      .def_property_readonly(
          "origin", [](const Cloud& c) { return array_of(c.origin_m); },
          "(3,) float64, metres of the scan frame: what `points` is relative to.")
      .def_property_readonly(
          "colour", [](const py::object& self) { return view_of(self, "colour"); },
          "(n, 4) uint8: red, green, blue, alpha; 0 0 0 0 where unknown. None without colours. A view.")
      .def_property_readonly(
          "intensity", [](const py::object& self) { return view_of(self, "intensity"); },
          "(n,) float32 as the scan has it, NaN where unknown. None without intensities. A view.")
      .def_property_readonly(
          "normals", [](const py::object& self) { return view_of(self, "normals"); },
          "(n, 3) float32 as they were given or as the scans state them, turned by their poses; 0 0 0 where a scan of "
          "several states none. None without normals. A view.")
      .def_property_readonly(
          "faces", [](const py::object& self) { return view_of(self, "faces"); },
          "(m, 3) uint32: triangles, indices into `points`. A view.")
      .def_property_readonly("fields", &fields_of_cloud, "Name -> (n,) float32, NaN where the scan says none; views.")
      .def_readonly("invalid", &Cloud::invalid, "Records of the files that were not finite or flagged invalid.")
      .def("filtered", &filtered, py::arg("filters"), py::kw_only(), py::arg("spacing_mm") = 0.0,
           py::arg("threads") = 0, py::arg("progress") = py::none(),
           R"(Applies filters in order, as a configuration's block `filters` has them.

filters: e.g. [{"outliers": {"sigma": 2}}, {"voxel": {"leaf_mm": 1}}]. spacing_mm: of the grid, for `thin`.
Returns (the cloud that is left, one dict a filter: name, removed, found); this cloud stays as it is.
Raises UsageError for unknown names, with line and column of the list as JSON; InputError when nothing is left.)");
  module.def("read", &read, py::arg("files"), py::kw_only(), py::arg("units") = py::none(),
             py::arg("fields") = std::vector<std::string>(), py::arg("progress") = py::none(),
             R"(Reads scans into one cloud.

files: a path, a list of paths, or of dicts as a configuration's `scans` has them ({"file", "units", "pose"}), or
the path of a configuration, whose scans are read. units: "m", "cm", "mm", "ft" or "us_ft" for scans that do not
say so themselves; None: the format's own, else metres. fields: names of what the points shall keep besides, e.g.
["confidence"]; one that no file has is an InputError, which names those that there are. progress: called with (stage, fraction). Returns a Cloud in metres, in the order of the files.

Raises InputError with file and line; KeyboardInterrupt on Ctrl-C; warns of implausible units (sparsha.Warning).)");
}

}  // namespace sparsha::python
