// sparsha info FILE...: what is in a scan or a scene.
#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "app/commands/commands.h"
#include "app/commands/point_fields.h"
#include "app/commands/sentences.h"
#include "app/inputs.h"
#include "app/terminal/terminal.h"
#include "base/files/files.h"
#include "base/text/text.h"
#include "base/threads/thread_pool.h"
#include "pipeline/projection/count_scattered.h"
#include "pipeline/scan/inspect.h"
#include "pipeline/scan/units.h"
#include "pipeline/scan/up_axes.h"
#include "pipeline/scan/worth.h"
#include "scene/scene.h"

namespace sparsha::app {
namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

namespace {

Json vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Json field_json(const pipeline::FieldTally& tally) {
  Json json;
  json["name"] = tally.name();
  json["points"] = tally.values();
  json["without"] = tally.missing();
  const bool any = tally.values() > 0;
  json["min"] = any ? Json(tally.least()) : Json(nullptr);
  json["median"] = any ? Json(tally.quantile(0.5)) : Json(nullptr);
  json["max"] = any ? Json(tally.most()) : Json(nullptr);
  Json counts = Json::object();
  for (const pipeline::ValueCount& value : pipeline::few_values(tally))
    counts[std::to_string(value.value)] = value.count;
  if (!counts.empty()) json["counts"] = counts;
  return json;
}

Json worth_json(const pipeline::Worth& worth) {
  Json json;
  json["field"] = worth.field;
  json["reason"] = worth.reason;
  json["filter"] = worth.filter ? Json(worth.text()) : Json(nullptr);
  json["share_kept"] = worth.filter ? Json(worth.share()) : Json(nullptr);
  return json;
}

Json scan_json(const fs::path& file, const pipeline::ScanInfo& info) {
  Json json;
  json["file"] = file.generic_string();
  json["format"] = info.format;
  json["points"] = info.points;
  json["invalid"] = info.invalid;
  json["triangles"] = info.triangles;
  const bool any = info.points > info.invalid;
  json["extent_m"] = any ? Json{{"min", vector_json(info.min_m)}, {"max", vector_json(info.max_m)}} : Json(nullptr);
  json["spacing_m"] = info.spacing_m > 0.0 ? Json(info.spacing_m) : Json(nullptr);
  json["fields"] = info.fields;
  Json values = Json::array();
  for (const pipeline::FieldTally& tally : info.tallies) {
    if (is_worth_showing(tally)) values.push_back(field_json(tally));
  }
  if (!values.empty()) json["values"] = values;
  Json worth = Json::array();
  for (const pipeline::Worth& w : pipeline::worth_of(info.tallies)) worth.push_back(worth_json(w));
  if (!worth.empty()) json["worth"] = worth;
  json["units"] = info.units;
  json["duplicates"] = info.duplicates;
  json["scans"] = info.scans;
  if (!info.notes.empty()) json["notes"] = info.notes;
  json["viewpoint"] = info.viewpoint ? Json(*info.viewpoint) : Json(nullptr);
  if (!info.warnings.empty()) json["warnings"] = info.warnings;
  return json;
}

std::string scattered_line(std::uint64_t points) {
  return fmt::format("  scattered   {} points lie in space and make no surface\n", count_text(points));
}

std::string scattered_sentence(std::uint64_t points) {
  return fmt::format("{} points lie in space and make no surface.\n", count_text(points));
}

std::string scan_text(const fs::path& file, const pipeline::ScanInfo& info) {
  std::string text =
      fmt::format("{}\n  format      {}\n  points      {}", file.string(), info.format, count_text(info.points));
  if (info.invalid > 0) text += fmt::format(" ({} invalid)", count_text(info.invalid));
  if (info.duplicates > 0) text += fmt::format(" ({} duplicates)", count_text(info.duplicates));
  text += "\n";
  if (info.triangles > 0) text += fmt::format("  triangles   {}\n", count_text(info.triangles));
  if (info.scans != 1) text += fmt::format("  scans       {}\n", info.scans);
  for (const std::string& note : info.notes) text += fmt::format("  note        {}\n", note);
  text += fmt::format("  units       {}\n", info.units);
  if (info.points > info.invalid) {
    const Eigen::Vector3d size = info.max_m - info.min_m;
    text += fmt::format("  extent      {:.6g} x {:.6g} x {:.6g}, from ({:.10g}, {:.10g}, {:.10g})\n", size.x(),
                        size.y(), size.z(), info.min_m.x(), info.min_m.y(), info.min_m.z());
    if (info.spacing_m > 0.0) text += fmt::format("  spacing     {:.4g}, median\n", info.spacing_m);
  }
  text += fmt::format("  fields      {}\n", fmt::join(info.fields, " "));
  for (const pipeline::FieldTally& tally : info.tallies) {
    if (is_worth_showing(tally)) text += fmt::format("  {:<11} {}\n", tally.name(), field_words(tally));
  }
  for (const pipeline::Worth& worth : pipeline::worth_of(info.tallies)) {
    text += "  worth       " + worth.reason;
    text += worth.filter ? fmt::format("; the filter '{}' keeps {:.3g} %\n", worth.text(), 100.0 * worth.share())
                         : "; which values are good is not known\n";
  }
  if (info.viewpoint) text += fmt::format("  viewpoint   {} (shown, not applied)\n", fmt::join(*info.viewpoint, " "));
  for (const std::string& warning : info.warnings) text += "  warning     " + warning + "\n";
  return text;
}

/// Of a scene's report: points that lay in space, no nearer to others than by chance. Absent where the report is not
/// there or is none.
std::optional<std::uint64_t> scattered_of(const fs::path& folder) {
  constexpr std::uint64_t kMostText = 1U << 26U;
  const fs::path file = folder / "report.json";
  std::error_code code;
  if (!fs::is_regular_file(file, code)) return std::nullopt;
  const Json report = Json::parse(read_file(file, kMostText), nullptr, false);
  if (!report.is_object() || !report.contains("scattered") || !report["scattered"].is_number_unsigned())
    return std::nullopt;
  return report["scattered"].get<std::uint64_t>();
}

Json scene_json(const fs::path& folder, const scene::SceneDescription& scene) {
  Json json;
  json["file"] = folder.generic_string();
  json["format"] = "Sparsha scene";
  Json levels = Json::array();
  for (const scene::Lattice& level : scene.levels) {
    levels.push_back({{"nx", level.nx}, {"ny", level.ny}, {"spacing_m", level.spacing_m}});
  }
  json["levels"] = levels;
  json["origin_m"] = vector_json(scene.levels.front().origin_m);
  json["height_range_m"] = {scene.height_min_m, scene.height_max_m};
  json["noise_m"] = scene.noise_m;
  json["units"] = "m";
  json["scans"] = scene.sources.size();
  if (const auto scattered = scattered_of(folder)) json["scattered"] = *scattered;
  Json layers = {"height", "mask"};
  if (scene.has_envelope) layers.push_back("envelope");
  if (scene.has_curvature) layers.push_back("curvature");
  if (scene.has_paper_curvatures) layers.push_back("mean-curvature");
  if (scene.has_paper_curvatures) layers.push_back("gaussian-curvature");
  if (scene.has_colour) layers.push_back("colour");
  if (scene.has_intensity) layers.push_back("intensity");
  json["layers"] = layers;
  if (scene.charts) {
    json["charts"] = {{"sheets", scene.charts->sheets.size()},
                      {"nodes", scene.charts->measured_nodes()},
                      {"spacing_m", scene.charts->spacing_m}};
  }
  return json;
}

std::string scene_text(const fs::path& folder, const scene::SceneDescription& scene) {
  const scene::Lattice& base = scene.levels.front();
  std::string text =
      fmt::format("{}\n  format      Sparsha scene\n  size        {} x {} x {}\n", folder.string(),
                  length_text((base.nx - 1) * base.spacing_m), length_text((base.ny - 1) * base.spacing_m),
                  length_text(scene.height_max_m - scene.height_min_m));
  for (std::size_t level = 0; level < scene.levels.size(); ++level) {
    const scene::Lattice& lattice = scene.levels[level];
    text += fmt::format("  level {}     {} x {} nodes, {} apart\n", level, lattice.nx, lattice.ny,
                        length_text(lattice.spacing_m));
  }
  if (scene.charts) {
    text += fmt::format("  all around  {} sheets with {} nodes, {} apart\n", scene.charts->sheets.size(),
                        count_text(scene.charts->measured_nodes()), length_text(scene.charts->spacing_m));
  }
  text += fmt::format("  made from   {} scan{}\n", scene.sources.size(), scene.sources.size() == 1 ? "" : "s");
  if (const auto scattered = scattered_of(folder); scattered.value_or(0) > 0) text += scattered_line(*scattered);
  return text;
}

/// Of several scans together: each sentence with the index of the scan that it is about.
std::vector<std::pair<std::size_t, std::string>> doubts_between(const std::vector<pipeline::ScanSize>& sizes,
                                                                const std::vector<pipeline::ScanUp>& ups) {
  std::vector<std::pair<std::size_t, std::string>> doubts;
  for (pipeline::UnitDifference& difference : pipeline::differing_units(sizes)) {
    doubts.emplace_back(difference.large, std::move(difference.reason));
  }
  if (std::optional<pipeline::UpDifference> difference = pipeline::differing_up(ups)) {
    doubts.emplace_back(difference->scan, std::move(difference->reason));
  }
  return doubts;
}

/// Says what is in some files, one after the other.
class Inspection {
 public:
  explicit Inspection(const CommonOptions& common) : common_(common), terminal_(common) {}

  /// A file that is no scan is told of beside the others.
  void look(const std::string& file, bool alone) {
    terminal_.progress().throw_if_cancelled();
    try {
      std::error_code code;
      fs::is_directory(file, code) ? look_at_scene(file) : look_at_scan(file);
    } catch (const Error& error) {
      if (alone || error.kind() != ErrorKind::input) throw;
      end_progress_line();
      print_error(error.what());
      code_ = static_cast<int>(error.kind());
      if (common_.json) all_.push_back({{"file", fs::path(file).generic_string()}, {"error", error.what()}});
    }
  }

  [[nodiscard]] int tell(bool alone) {
    for (const auto& [scan, doubt] : doubts_between(sizes_, ups_)) {
      if (common_.json) all_[place_[scan]]["warnings"].push_back(doubt);
      text_ +=
          common_.plain ? fmt::format("There is a warning: {}.\n", doubt) : fmt::format("warning       {}\n", doubt);
    }
    if (common_.json) {
      print((alone ? all_.front() : all_).dump(2, ' ', false, nlohmann::json::error_handler_t::replace));
    } else if (!text_.empty()) {
      print(text_);
    }
    return code_;
  }

 private:
  void look_at_scene(const std::string& folder) {
    std::error_code code;
    if (!fs::exists(fs::path(folder) / "scene.yaml", code)) refuse_folder(folder);
    const scene::ScenePointer scene = scene::open_scene(folder, common_.trusted());
    if (common_.json) {
      all_.push_back(scene_json(folder, scene->description()));
      return;
    }
    text_ += common_.plain ? scene_sentences(folder, scene->description()) : scene_text(folder, scene->description());
    if (const auto scattered = common_.plain ? scattered_of(folder) : std::nullopt; scattered.value_or(0) > 0)
      text_ += scattered_sentence(*scattered);
  }

  void look_at_scan(const std::string& file) {
    std::uint64_t scattered = 0;
    const pipeline::ScanInfo info =
        pipeline::inspect_scan(file, &terminal_.progress(), [&](const auto& points, double unit_m) {
          ThreadPool pool;
          scattered = pipeline::count_scattered(points, unit_m, pool);
        });
    sizes_.emplace_back(file, info.sample_m, info.points - info.invalid, info.units != "unknown");
    ups_.push_back({file, info.format});
    place_.push_back(all_.size());
    if (common_.json) {
      all_.push_back(scan_json(file, info));
      if (scattered > 0) all_.back()["scattered"] = scattered;
    } else {
      text_ += common_.plain ? scan_sentences(file, info) : scan_text(file, info);
      if (scattered > 0) text_ += common_.plain ? scattered_sentence(scattered) : scattered_line(scattered);
    }
  }

  const CommonOptions& common_;
  Terminal terminal_;
  Json all_ = Json::array();
  std::string text_;
  std::vector<pipeline::ScanSize> sizes_;
  std::vector<pipeline::ScanUp> ups_;
  std::vector<std::size_t> place_;  // of each of them, in `all_`
  int code_ = 0;
};

int run_info(const std::vector<std::string>& files, const CommonOptions& common) {
  Inspection inspection(common);
  for (const std::string& file : files) inspection.look(file, files.size() == 1);
  return inspection.tell(files.size() == 1);
}

}  // namespace

void add_info(Command app, const CommonOptions& common, Run& run) {
  auto files = std::make_shared<std::vector<std::string>>();
  Command command = app.add_subcommand("info", "Say what is in scans or scenes");
  command.add_option("file", *files, "scan files or scene folders").required();
  command.callback([files, &common, &run] { run = [files, &common] { return run_info(*files, common); }; });
}

}  // namespace sparsha::app
