// Scans, clouds and configurations to scenes; scenes checked against points, and kept.
#include <fmt/format.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include "app/inputs.h"
#include "base/error.h"
#include "base/threads/thread_pool.h"
#include "base/yaml/yaml_text.h"
#include "pipeline/build/build.h"
#include "pipeline/build/recheck.h"
#include "pipeline/report/report.h"
#include "python/bindings/running.hpp"
#include "python/bindings/scene.hpp"
#include "python/bindings/settings.hpp"
#include "scene/folder/folder.h"

namespace sparsha::python {
namespace py = pybind11;
namespace fs = std::filesystem;

namespace {

/// What is built, in the caller's words.
struct Source {
  CloudPointer cloud;              ///< or null
  std::vector<std::string> paths;  ///< or empty
  std::string config;              ///< as text, or empty: from paths
  std::vector<std::string> settings;
  scene::Trust trust = scene::Trust::own_folder;
};

/// Errors of the file that stands for a cloud are told of the cloud.
template <typename Work>
auto naming_cloud(const CloudFile& file, const Work& work) {
  try {
    return work();
  } catch (const Cancelled&) {
    throw;
  } catch (const Error& error) {
    if (error.place().file != file.path().string()) throw;
    throw Error(error.kind(), {"the cloud", 0, 0}, error.wrong(), error.expected());
  }
}

void name_cloud(scene::Config& config) {
  for (scene::ScanConfig& scan : config.scans) scan.file = CloudFile::kName;
}

/// Writes a scene into its folder, and a report by write_report(folder). Where `cloud` is one, the folder itself is
/// where scene.yaml looks for it, wherever the process works: no file of somebody else is taken for it.
template <typename WriteReport>
void keep(const std::shared_ptr<const pipeline::Cloud>& cloud, const scene::ScenePointer& scene, const fs::path& folder,
          Progress& progress, const WriteReport& write_report) {
  progress.begin("write");
  // A scan of an opened scene that is named in its own folder and not there was a cloud too.
  const auto was_cloud = [&](const scene::ScanConfig& scan) {
    std::error_code code;
    return cloud || (scan.file == scene->folder() / CloudFile::kName && !fs::exists(scan.file, code));
  };
  scene::Config scans = scene->description().config;
  std::erase_if(scans.scans, was_cloud);
  scene::require_replaceable(folder, scans);
  AtomicPath target(folder, AtomicPath::Kind::folder);
  target.naming_target([&] {
    scene::SceneDescription description = scene->description();
    for (scene::ScanConfig& scan : description.config.scans) {
      if (was_cloud(scan)) scan.file = target.temporary() / CloudFile::kName;
    }
    scene::write_scene(*scene::with_description(scene, std::move(description)), target.temporary(), progress);
    write_report(target.temporary());
  });
  progress.finish();
  progress.throw_if_cancelled();
  scene::require_replaceable(folder, scans);
  target.commit();
}

/// The cloud's own configuration, or the caller's with the cloud as its scan.
scene::Config config_of_cloud(const Source& source, const CloudFile& file, const pipeline::BuildOptions& options,
                              Progress& progress) {
  if (!source.config.empty()) return config_of_text(source.config, source.settings);
  scene::Config config =
      app::config_from({file.path().string()}, source.settings, source.trust, progress, options.memory_bytes);
  for (const scene::ScanConfig& scan : config.scans) {
    if (scan.units.unit != scene::LengthUnit::m && scan.units.unit != scene::LengthUnit::automatic) {
      throw usage_error("the points of the cloud look like " + to_string(scan.units.unit) + ", not metres",
                        "points in metres, or config={'grid': ...} where they are");
    }
  }
  return config;
}

pipeline::BuildResult build_cloud(Source source, const pipeline::BuildOptions& options, const std::string& out,
                                  Progress& progress) {
  const CloudFile file(*source.cloud);
  file.write(progress);
  if (!source.config.empty())
    source.settings.push_back("scans=[{\"file\": " + yaml::quoted(file.path().string()) + ", \"units\": \"m\"}]");
  return naming_cloud(file, [&] {
    const scene::Config config = config_of_cloud(source, file, options, progress);
    if (!out.empty()) scene::require_replaceable(out, config);
    pipeline::BuildResult result = pipeline::build_scene(config, options, progress);
    scene::SceneDescription description = result.scene->description();
    name_cloud(description.config);
    for (scene::ScanSource& scan : description.sources) scan.file = CloudFile::kName;
    result.scene = scene::with_description(result.scene, std::move(description));
    if (!out.empty()) {
      keep(source.cloud, result.scene, out, progress, [&](const fs::path& folder) {
        ThreadPool pool(options.threads);
        pipeline::write_report(*result.scene, result.report, folder, pool);
      });
    }
    return result;
  });
}

pipeline::BuildResult build_files(const Source& source, const pipeline::BuildOptions& options, const std::string& out,
                                  Progress& progress) {
  const scene::Config config = source.config.empty() ? app::config_from(source.paths, source.settings, source.trust,
                                                                        progress, options.memory_bytes, options.force)
                                                     : config_of_text(source.config, source.settings);
  const auto build = [&] {
    if (out.empty()) return pipeline::build_scene(config, options, progress);
    scene::require_replaceable(out, config);
    return pipeline::build_scene_folder(config, options, out, progress);
  };
  return source.config.empty() ? app::blaming_scans(source.paths, source.settings, build) : build();
}

Source source_of(const py::object& given, const py::object& config, const py::dict& settings, bool trust) {
  Source source;
  source.settings = settings_of(settings);
  source.trust = trust ? scene::Trust::any_file : scene::Trust::own_folder;
  if (!config.is_none() && !py::isinstance<py::dict>(config)) {
    throw py::type_error("config is no dict; a configuration file is the first argument");
  }
  if (py::isinstance<pipeline::Cloud>(given)) {
    source.cloud = cloud_of(given);
    if (settings.contains("scans") || (!config.is_none() && config.contains("scans")))
      throw usage_error("scans are named besides the cloud", "a cloud, or scans");
    if (!config.is_none()) source.config = text_of(config);
  } else if (py::isinstance<py::dict>(given)) {
    if (!config.is_none()) throw usage_error("two configurations are given", "one");
    source.config = text_of(given);
  } else {
    source.paths = paths_of(given, "source");
    if (source.paths.empty()) throw usage_error("no scans are named", "at least one file");
    if (config.is_none()) return source;
    const py::dict whole(config.attr("copy")());
    py::list scans;
    for (const std::string& path : source.paths) {
      py::dict scan;
      scan["file"] = str_of(path);
      scans.append(scan);
    }
    whole["scans"] = scans;
    source.config = text_of(whole);
  }
  return source;
}

std::shared_ptr<BuiltScene> build(const py::object& given, const py::object& config, const py::object& out,
                                  const py::object& threads, const py::object& memory, bool force, bool grid_only,
                                  bool trust, const py::object& progress, const py::kwargs& settings) {
  const Source source = source_of(given, config, settings, trust);
  pipeline::BuildOptions options;
  options.threads = threads_of(threads);
  options.force = force;
  options.grid_only = grid_only;
  if (!memory.is_none()) options.memory_bytes = app::parse_bytes(py::str(memory).cast<std::string>());
  const std::string folder = out.is_none() ? std::string() : path_of(out, "out");
  return run(progress, [&](Progress& told) {
    pipeline::BuildResult result =
        source.cloud ? build_cloud(source, options, folder, told) : build_files(source, options, folder, told);
    auto built = std::make_shared<BuiltScene>();
    built->report_json = pipeline::report_json(*result.scene, result.report);
    built->scene = std::move(result.scene);
    built->cloud = source.cloud;
    return built;
  });
}

std::shared_ptr<BuiltScene> open(const py::object& folder, bool trust) {
  // Absolute, since layers are read later, when the process may work elsewhere.
  const fs::path path = fs::absolute(path_of(folder, "folder"));
  const Unlocked unlocked;
  auto built = std::make_shared<BuiltScene>();
  built->scene = scene::open_scene(path, trust ? scene::Trust::any_file : scene::Trust::own_folder);
  return built;
}

py::object check(const BuiltScene& built, const py::object& scans, std::int64_t samples, const py::object& threads,
                 bool trust, const py::object& progress) {
  if (samples < 0) throw usage_error(fmt::format("samples is {}", samples), "a positive number, or 0 for every point");
  const unsigned count = threads_of(threads);
  std::shared_ptr<const pipeline::Cloud> cloud = scans.is_none() ? built.cloud : nullptr;
  std::vector<std::string> paths;
  if (py::isinstance<pipeline::Cloud>(scans)) {
    cloud = cloud_of(scans);
  } else if (!scans.is_none()) {
    paths = paths_of(scans, "scans");
  }
  const scene::Trust whose = trust ? scene::Trust::any_file : scene::Trust::own_folder;
  const std::string text = run(progress, [&](Progress& told) {
    std::optional<CloudFile> file;
    if (cloud) {
      paths = {file.emplace(*cloud).path().string()};
      file->write(told);
    }
    const std::vector<fs::path> files(paths.begin(), paths.end());
    const auto measure = [&] {
      return pipeline::report_json(
          *built.scene, pipeline::recheck_scene(*built.scene, files, scene::CheckConfig{samples}, count, told, whose));
    };
    return file ? naming_cloud(*file, measure) : measure();
  });
  return py::module_::import("json").attr("loads")(text);
}

void save(const BuiltScene& built, const py::object& folder, const py::object& progress) {
  const std::string path = path_of(folder, "folder");
  run_without_lock(progress, [&](Progress& told) {
    keep(built.cloud, built.scene, path, told, [&](const fs::path& written) {
      if (!built.report_json.empty()) write_file(written / "report.json", built.report_json);
    });
  });
}

}  // namespace

void bind_build(py::module_& module, py::class_<BuiltScene, std::shared_ptr<BuiltScene>>& scene) {
  module.def("build", &build, py::arg("source"), py::kw_only(), py::arg("config") = py::none(),
             py::arg("out") = py::none(), py::arg("threads") = 0, py::arg("memory") = py::none(),
             py::arg("force") = false, py::arg("grid_only") = false, py::arg("trust") = false,
             py::arg("progress") = py::none(),
             R"(Builds a scene, as the command `sparsha build` does; the same input gives the same scene.

source: a Cloud; the path of a scan or a list of them; the path of a configuration; or a configuration as a dict.
config: of a Cloud or scans, the rest of their configuration as a dict; None: unit, view and spacing are guessed.
out: a folder that the scene is written to besides. threads: 0 to 1024, 0 is one a core. memory: a limit, e.g. "1GB".
force, grid_only, trust: as the options of `sparsha build`. progress: called with (stage: str, fraction: float).
Other keywords set keys of the configuration: grid={"size": 400}, filters=[{"voxel": {"leaf_mm": 1}}].

Raises UsageError and InputError with file, line and column as far as there are any; Failure when the disk is full or
a limit cannot be kept; KeyboardInterrupt on Ctrl-C, and what `progress` raises; then nothing is left behind.
What the core warns of comes as sparsha.Warning.)");
  module.def("open", &open, py::arg("folder"), py::kw_only(), py::arg("trust") = false,
             R"(Opens a scene folder; layers are read when they are asked for.

trust: follow the scene to clips and layers outside its folder. Raises InputError.)");
  scene
      .def("check", &check, py::arg("scans") = py::none(), py::kw_only(), py::arg("samples") = std::int64_t{50000},
           py::arg("threads") = 0, py::arg("trust") = false, py::arg("progress") = py::none(),
           R"(Measures how far the surface is from points, as `sparsha check` does.

scans: a Cloud, a path or a list of paths; None: those that the scene was built from. samples: points to sample, 0 for
all. Returns a dict as `report`, with distances in metres under "check". Raises InputError when scans are missing.)")
      .def("save", &save, py::arg("folder"), py::kw_only(), py::arg("progress") = py::none(),
           R"(Writes the scene and its report into a folder, which appears whole or not at all.

The folder is new, empty or a scene that is replaced. progress: called with ("write", fraction). Raises UsageError for
another folder; Failure; KeyboardInterrupt on Ctrl-C, which leaves the folder as it was.)");
}

}  // namespace sparsha::python
