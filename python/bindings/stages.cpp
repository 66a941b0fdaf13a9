#include "python/bindings/stages.hpp"

#include <fmt/format.h>
#include <pybind11/stl.h>

#include <filesystem>
#include <list>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "app/inputs.h"
#include "base/error.h"
#include "base/threads/thread_pool.h"
#include "base/yaml/yaml.h"
#include "pipeline/export/export.h"
#include "pipeline/export/whole_mesh.h"
#include "pipeline/register/register.h"
#include "pipeline/replica/replica.h"
#include "pipeline/replica/whole_replica.h"
#include "pipeline/simulate/simulate.h"
#include "protocol/benchmark.h"
#include "protocol/judge.h"
#include "python/bindings/arrays.hpp"
#include "python/bindings/cloud.hpp"
#include "python/bindings/running.hpp"
#include "python/bindings/scene.hpp"
#include "python/bindings/settings.hpp"

namespace sparsha::python {
namespace py = pybind11;

namespace {

py::dict dict_of(const pipeline::PairFit::Fit& fit) {
  py::dict told;
  told["within_m"] = fit.within_m;
  told["overlap"] = fit.overlap;
  told["residual_m"] = fit.matches > 0 ? py::object(py::float_(fit.residual_m)) : py::object(py::none());
  told["matches"] = fit.matches;
  return told;
}

py::dict dict_of(const pipeline::Registration& found) {
  py::list poses;
  for (const Eigen::Matrix4d& pose : found.poses) poses.append(array_of(pose));
  py::list pairs;
  for (const pipeline::PairFit& pair : found.pairs) {
    py::dict told;
    told["first"] = pair.first;
    told["second"] = pair.second;
    told["use"] = to_string(pair.use);
    told["before"] = dict_of(pair.before);
    told["after"] = dict_of(pair.after);
    pairs.append(told);
  }
  py::dict told;
  told["poses"] = poses;
  told["pairs"] = pairs;
  return told;
}

/// A list of clouds and paths as the scans of a configuration; clouds wait in files meanwhile.
scene::Config config_of_list(const py::list& scans, const std::vector<std::string>& settings,
                             std::vector<CloudPointer>& clouds, std::list<CloudFile>& files) {
  py::list entries;
  for (const py::handle& scan : scans) {
    py::dict entry;
    if (py::isinstance<pipeline::Cloud>(scan)) {
      entry["file"] = str_of(files.emplace_back(*clouds.emplace_back(cloud_of(scan))).path().string());
      entry["units"] = "m";
    } else if (py::isinstance<py::dict>(scan)) {
      entry = py::dict(scan.attr("copy")());
    } else {
      entry["file"] = str_of(path_of(scan, "scans"));
    }
    entries.append(entry);
  }
  py::dict config;
  config["scans"] = entries;
  return config_of_text(text_of(config), settings);
}

py::dict register_scans(const py::object& scans, const py::object& threads, const py::object& progress,
                        const py::kwargs& options) {
  const unsigned count = threads_of(threads);
  py::dict block;
  if (!options.empty()) block["register"] = options;
  const std::vector<std::string> settings = settings_of(block);
  std::vector<CloudPointer> clouds;
  std::list<CloudFile> files;
  std::optional<scene::Config> config;
  if (py::isinstance<py::dict>(scans)) {
    config = config_of_text(text_of(scans), settings);
  } else if (const std::optional<py::list> listed = items_of(scans)) {
    config = config_of_list(*listed, settings, clouds, files);
  } else {
    config = scene::load_config(path_of(scans, "scans"), settings);
  }
  return dict_of(run(progress, [&](Progress& told) {
    for (const CloudFile& file : files) file.write(told);
    ThreadPool pool(count);
    return pipeline::register_scans(config->scans, config->registration.value_or(scene::RegisterConfig{}),
                                    {pool, told});
  }));
}

void simulate(const py::object& given, const py::object& out, const py::object& progress) {
  const std::string folder = path_of(out, "out");
  if (!py::isinstance<py::dict>(given)) {
    const std::string file = path_of(given, "config");
    run(progress, [&](Progress& told) {
      pipeline::simulate(file, folder, told);
      return 0;
    });
    return;
  }
  const pipeline::SimulationConfig config =
      pipeline::parse_simulation(yaml::parse_text(text_of(given), "the simulation"));
  run(progress, [&](Progress& told) {
    pipeline::write_simulation(config, folder, told);
    return 0;
  });
}

py::dict facts_of(const pipeline::ClosedMeshFacts& facts) {
  py::dict told;
  told["shells"] = facts.shells;
  told["area_m2"] = facts.area_m2;
  told["volume_m3"] = facts.volume_m3;
  told["unseen"] = facts.unseen();
  told["crumbs"] = facts.crumbs;
  return told;
}

py::dict export_replica(const BuiltScene& built, const std::string& file, double size_mm, bool whole,
                        const py::object& progress) {
  py::dict told;
  if (whole) {
    const auto report = run(progress, [&](Progress& p) {
      ThreadPool pool;
      return pipeline::export_whole_replica(*built.scene, file, size_mm, {pool, p});
    });
    told["scale"] = report.scale;
    told["volume_mm3"] = report.volume_mm3;
    told["triangles"] = report.triangles;
    told["unseen"] = report.unseen;
    return told;
  }
  pipeline::ReplicaOptions options;
  options.longest_mm = size_mm;
  const auto report =
      run(progress, [&](Progress& p) { return pipeline::export_replica(*built.scene, file, options, p); });
  told["scale"] = report.scale;
  told["volume_mm3"] = report.volume_mm3;
  told["triangles"] = report.triangles;
  told["unknown"] = report.unknown;
  return told;
}

py::dict export_scene(const BuiltScene& built, const py::object& to, bool nodes, bool haptics, bool front,
                      const std::string& holes, double size_mm, const py::object& progress) {
  const std::string file = path_of(to, "file");
  if (holes != "close" && holes != "leave") throw usage_error("holes is '" + holes + "'", "'close' or 'leave'");
  const bool whole = built.scene->description().charts != nullptr && !front;
  if (pipeline::is_replica(file)) {
    app::check_outputs({{"the file", file}, {"the legibility map", pipeline::legibility_file_of(file)}}, *built.scene);
    return export_replica(built, file, size_mm, whole, progress);
  }
  pipeline::check_export(file, nodes, haptics);
  app::check_outputs({{"the file", file}, {"the world file", pipeline::world_file_of(file)}}, *built.scene);
  if (!whole || nodes || haptics || !pipeline::is_mesh(file)) {
    run(progress, [&](Progress& told) {
      pipeline::export_scene(*built.scene, file, nodes, told, haptics);
      return 0;
    });
    return {};
  }
  return facts_of(run(progress, [&](Progress& told) {
    ThreadPool pool;
    return pipeline::export_whole_mesh(
        *built.scene, file, holes == "leave" ? pipeline::Holes::leave : pipeline::Holes::close, {pool, told});
  }));
}

py::list judge(const py::object& folder, const py::object& results) {
  const std::string data = path_of(folder, "folder");
  const std::string forces = path_of(results, "results");
  const protocol::Verdict verdict = [&] {
    const Unlocked unlocked;
    return protocol::judge(data, forces);
  }();
  py::list cases;
  for (const protocol::Judgement& judgement : verdict.cases) {
    const protocol::Score& score = judgement.score;
    py::dict told;
    told["case"] = str_of(judgement.case_name);
    told["pass"] = judgement.pass();
    told["error_median"] = score.error_median;
    told["error_p99"] = score.error_p99;
    told["error_max"] = score.error_max;
    told["angle_p99_deg"] = score.angle_p99_deg;
    told["lost"] = score.lost;
    told["felt"] = score.felt;
    told["jumps"] = score.jumps;
    told["ghost"] = judgement.ghost;
    cases.append(told);
  }
  return cases;
}

}  // namespace

void bind_stages(py::module_& module) {
  module.def("register", &register_scans, py::arg("scans"), py::kw_only(), py::arg("threads") = 0,
             py::arg("progress") = py::none(),
             R"(Finds the poses that make scans one cloud, as `sparsha register` does.

scans: a list of Clouds, paths and dicts ({"file", "units", "pose"}); a configuration as a dict, or the path of one.
Other keywords are keys of the block `register`: guess="features" where no rough poses are known, voxel_mm, method.
Returns {"poses": [(4, 4) float64, metres, one a scan; the first as given], "pairs": [dict: first, second, use, before,
after]}. Raises UsageError; InputError naming scans that cannot be linked; KeyboardInterrupt.)");
  module.def("simulate", &simulate, py::arg("config"), py::arg("out"), py::kw_only(), py::arg("progress") = py::none(),
             R"(Scans a known surface, as `sparsha simulate` does: scans, truth.tif, truth.json and sparsha.yaml.

config: a path or a dict (docs/measure/simulation.md). out: a folder. The same input gives the same bytes.
Raises UsageError, Failure.)");
  module.def(
      "export", &export_scene, py::arg("scene"), py::arg("file"), py::kw_only(), py::arg("nodes") = false,
      py::arg("haptics") = false, py::arg("front") = false, py::arg("holes") = "close", py::arg("size_mm") = 200.0,
      py::arg("progress") = py::none(),
      R"(Writes a scene in the frame of its scans, as `sparsha export` does; the file appears whole or not at all.

file: .ply, .obj, .xyz, .glb, .tif or .png; .stl and .3mf are replicas, the longer side size_mm. nodes: points of
measured nodes alone. haptics: maps of what is felt (.glb). front: of a whole object, its front view alone. holes: of a
whole object, "close" or "leave". Returns a dict of what is known of a closed mesh or a replica.
Raises UsageError, Failure.)");
  module.def(
      "bench_export",
      [](const py::object& folder, const py::object& progress) {
        const std::string path = path_of(folder, "folder");
        run_without_lock(progress, [&](Progress& told) { protocol::export_benchmark(path, &told); });
      },
      py::arg("folder"), py::kw_only(), py::arg("progress") = py::none(),
      R"(Writes the open benchmark of forces (protocol.md), as `sparsha bench export` does.

progress: called with ("export", fraction). Raises UsageError, Failure; KeyboardInterrupt on Ctrl-C, which leaves no
folder.)");
  module.def("bench_judge", &judge, py::arg("folder"), py::arg("results"),
             R"(Judges forces, as `sparsha bench judge` does: one dict a case, shares and errors as fractions.

folder: of bench_export(). results: a CSV file case,t_s,force_x_n,force_y_n,force_z_n. Raises InputError with file, line
and column at the first fault.)");
}

}  // namespace sparsha::python
