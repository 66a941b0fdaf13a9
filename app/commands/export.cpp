// sparsha export SCENE --to FILE: mesh, points or heights, back in the scan frame; or a replica to be printed.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands/commands.h"
#include "app/commands/sentences.h"
#include "app/inputs.h"
#include "app/terminal/terminal.h"
#include "base/threads/thread_pool.h"
#include "pipeline/export/export.h"
#include "pipeline/export/whole_mesh.h"
#include "pipeline/replica/replica.h"
#include "pipeline/replica/whole_replica.h"
#include "scene/scene.h"

namespace sparsha::app {

namespace {

int make_whole_replica(const scene::Scene& scene, const std::string& file, double longest_mm,
                       const CommonOptions& common, Terminal& terminal) {
  ThreadPool pool;
  const pipeline::WholeReplicaReport report =
      pipeline::export_whole_replica(scene, file, longest_mm, {pool, terminal.progress()});
  for (const std::string& warning : report.warnings) terminal.progress().warn(warning);
  if (common.json) {
    print(nlohmann::ordered_json{{"size_mm", {report.width_mm, report.depth_mm, report.height_mm}},
                                 {"scale", report.scale},
                                 {"spacing_mm", report.spacing_mm},
                                 {"volume_mm3", report.volume_mm3},
                                 {"triangles", report.triangles},
                                 {"shells", report.shells},
                                 {"unseen", report.unseen},
                                 {"warnings", report.warnings}}
              .dump(2));
  } else if (common.plain) {
    print(whole_replica_sentences(report) + written_sentences({file}));
  } else {
    print(
        fmt::format("replica     {:.0f} x {:.0f} mm, {:.0f} mm high, scale 1:{:.3g}\n"
                    "solid       {} triangles, {:.1f} cm3\n",
                    report.width_mm, report.depth_mm, report.height_mm, 1.0 / report.scale, report.triangles,
                    1e-3 * report.volume_mm3));
    terminal.message("wrote " + file);
  }
  return 0;
}

int make_replica(const scene::Scene& scene, const std::string& file, const pipeline::ReplicaOptions& options,
                 const CommonOptions& common, Terminal& terminal) {
  const pipeline::ReplicaReport report = pipeline::export_replica(scene, file, options, terminal.progress());
  for (const std::string& warning : report.warnings) terminal.progress().warn(warning);
  if (common.json) {
    print(nlohmann::ordered_json{{"size_mm", {report.width_mm, report.length_mm, report.thickness_mm}},
                                 {"scale", report.scale},
                                 {"raised", report.raised},
                                 {"volume_mm3", report.volume_mm3},
                                 {"triangles", report.triangles},
                                 {"felt", report.felt},
                                 {"crowded", report.crowded},
                                 {"unknown", report.unknown},
                                 {"braille", report.lines},
                                 {"warnings", report.warnings}}
              .dump(2));
    return 0;
  }
  if (common.plain) {
    print(replica_sentences(report) + written_sentences({file, pipeline::legibility_file_of(file)}));
    return 0;
  }
  std::string text = fmt::format(
      "replica     {:.0f} x {:.0f} x {:.1f} mm, scale 1:{:.3g}, depths {:.3g} times what that scale gives\n"
      "solid       {} triangles, {:.1f} cm3\n"
      "by touch    {:.0f} % has features that fingers notice, {:.0f} % is too fine to be told apart\n",
      report.width_mm, report.length_mm, report.thickness_mm, 1.0 / report.scale, report.raised, report.triangles,
      1e-3 * report.volume_mm3, 100.0 * report.felt, 100.0 * report.crowded);
  for (const std::string& line : report.lines) text += fmt::format("braille     {}\n", line);
  print(text);
  terminal.message("wrote " + file + " and " + pipeline::legibility_file_of(file).string());
  return 0;
}

/// What a person should know of a closed mesh.
std::string mesh_lines(const pipeline::ClosedMeshFacts& facts, pipeline::Holes holes) {
  std::string text =
      fmt::format("{} {}, {:.4g} m2 of surface around {:.4g} m3\n", facts.shells,
                  facts.shells == 1 ? "closed surface" : "closed surfaces", facts.area_m2, facts.volume_m3);
  if (facts.closing_m2 > 0.0) {
    text += fmt::format("no scan saw {:.2g} % of it: {}\n", 100.0 * facts.unseen(),
                        holes == pipeline::Holes::leave ? "it is left open there" : "holes are closed there");
  }
  if (facts.crumbs > 0)
    text += fmt::format("{} left out: smaller than a ball of 2 spacings radius\n",
                        facts.crumbs == 1 ? "1 crumb was" : fmt::format("{} crumbs were", facts.crumbs));
  return text;
}

int export_whole(const scene::Scene& scene, const std::string& file, pipeline::Holes holes, const CommonOptions& common,
                 Terminal& terminal) {
  ThreadPool pool;
  const pipeline::ClosedMeshFacts facts = pipeline::export_whole_mesh(scene, file, holes, {pool, terminal.progress()});
  if (holes == pipeline::Holes::close && facts.closing_m2 > 0.0) {
    terminal.progress().warn(
        fmt::format("{:.2g} % of the mesh's surface is made up: it closes over places that no scan saw, and the volume "
                    "depends on it; --holes leave leaves them open",
                    100.0 * facts.unseen()));
  }
  if (common.json) {
    print(nlohmann::ordered_json{{"shells", facts.shells},
                                 {"area_m2", facts.area_m2},
                                 {"volume_m3", facts.volume_m3},
                                 {"unseen", facts.unseen()},
                                 {"open", holes == pipeline::Holes::leave && facts.closing_m2 > 0.0},
                                 {"crumbs", facts.crumbs}}
              .dump(2));
    return 0;
  }
  print(mesh_lines(facts, holes));
  if (common.plain)
    print(written_sentences({file}));
  else
    terminal.message("wrote " + file);
  return 0;
}

/// The scene as if its unrolled frame were the scans' own.
scene::ScenePointer laid_flat(scene::ScenePointer scene) {
  scene::SceneDescription flat = scene->description();
  flat.config.unroll.reset();
  flat.scan_from_grid.setIdentity();
  return scene::with_description(std::move(scene), std::move(flat));
}

struct Arguments {
  std::string scene;
  std::string file;
  bool nodes = false;
  bool haptics = false;
  bool front = false;
  bool unrolled = false;
  std::string holes = "close";
  pipeline::ReplicaOptions replica;
  bool no_braille = false;
};

scene::ScenePointer scene_to_export(const Arguments& arguments, const CommonOptions& common, Terminal& terminal) {
  scene::ScenePointer scene = scene_from({arguments.scene}, common.trusted(), terminal.progress());
  if (arguments.front && !scene->description().charts)
    throw usage_error("--front means nothing here", "a scene with `around`");
  if (arguments.unrolled && !scene->description().config.unroll)
    throw usage_error("--unrolled means nothing here", "a scene with `unroll`");
  return scene;
}

}  // namespace

void add_export(Command app, const CommonOptions& common, Run& run) {
  auto arguments = std::make_shared<Arguments>();
  Command command = app.add_subcommand("export", "Write a scene as mesh, points or heights in the scan's own frame");
  command.add_option("scene", arguments->scene, "scene folder").required();
  command.add_option("--to", arguments->file, "FILE.ply, .obj, .xyz, .glb, .tif or .png; .stl or .3mf: a replica")
      .required();
  command.add_flag("--nodes", arguments->nodes, "points of measured nodes only (ply, obj, xyz)");
  command.add_flag("--haptics", arguments->haptics, "stiffness, friction and texture as maps in the file (glb)");
  command.add_flag("--front", arguments->front, "of a whole object, its front view alone");
  command.add_flag("--unrolled", arguments->unrolled, "of an unrolled object, its picture laid flat");
  Option of_holes = command.add_option("--holes", arguments->holes,
                                       "where no scan saw a whole object: close, or leave open (ply, obj, glb)");
  of_holes.check(one_of({"close", "leave"})).shows_default();
  const char* const group = "Replica (.stl, .3mf)";
  std::vector<Option> of_replica = {
      command
          .add_option("--size-mm", arguments->replica.longest_mm,
                      "longer side of the relief, or longest of a whole object")
          .shows_default(),
      command.add_option("--depth-mm", arguments->replica.depth_mm, "from lowest to highest; default: true, 3 to 15"),
      command.add_option("--curve", arguments->replica.curve, "below 1 raises low relief, above 1 flattens it")
          .shows_default(),
      command.add_option("--base-mm", arguments->replica.base_mm, "plate under the lowest place").shows_default(),
      command.add_flag("--no-braille", arguments->no_braille, "leave out the parts' names")};
  for (Option option : of_replica) option.group(group);
  command.callback([arguments, of_replica, of_holes, &common, &run] {
    run = [arguments, of_replica, of_holes, &common] {
      if (pipeline::is_replica(arguments->file)) {
        if (arguments->nodes) throw usage_error("a replica has no separate nodes", ".ply, .obj or .xyz with --nodes");
        if (arguments->haptics) throw usage_error("a replica has no maps of what is felt", ".glb with --haptics");
        if (of_holes.given()) throw usage_error("a replica is closed", ".ply, .obj or .glb with --holes");
        arguments->replica.braille = !arguments->no_braille;
        Terminal terminal(common);
        check_outputs(
            {{"--to", arguments->file}, {"the legibility map of --to", pipeline::legibility_file_of(arguments->file)}},
            {arguments->scene});
        const scene::ScenePointer scene = scene_to_export(*arguments, common, terminal);
        if (!scene->description().charts || arguments->front)
          return make_replica(*scene, arguments->file, arguments->replica, common, terminal);
        for (const Option& option : of_replica)
          if (option.given() && option.name() != "--size-mm")
            throw usage_error(option.name() + " means nothing for a whole object",
                              "--size-mm alone, or --front with it");
        return make_whole_replica(*scene, arguments->file, arguments->replica.longest_mm, common, terminal);
      }
      for (const Option& option : of_replica)
        if (option.given())
          throw usage_error(option.name() + " means nothing here", "--to FILE.stl or FILE.3mf with it");
      Terminal terminal(common);
      pipeline::check_export(arguments->file, arguments->nodes, arguments->haptics);
      check_outputs({{"--to", arguments->file}, {"the world file of --to", pipeline::world_file_of(arguments->file)}},
                    {arguments->scene});
      scene::ScenePointer scene = scene_to_export(*arguments, common, terminal);
      if (arguments->unrolled) scene = laid_flat(std::move(scene));
      const bool whole = scene->description().charts && !arguments->front && !arguments->nodes;
      if (whole && arguments->haptics)
        throw usage_error("the mesh of a whole object has no maps of what is felt", "--front with --haptics");
      const bool meshes = whole && pipeline::is_mesh(arguments->file);
      if (of_holes.given() && !meshes)
        throw usage_error("--holes means nothing here", "a scene with `around`, to a .ply, .obj or .glb");
      if (meshes)
        return export_whole(*scene, arguments->file,
                            arguments->holes == "leave" ? pipeline::Holes::leave : pipeline::Holes::close, common,
                            terminal);
      if (whole) warn_of_front_view(*scene, "this format", terminal.progress());
      pipeline::export_scene(*scene, arguments->file, arguments->nodes, terminal.progress(), arguments->haptics);
      if (common.json)
        print(nlohmann::ordered_json{{"file", arguments->file}}.dump(2, ' ', false,
                                                                     nlohmann::json::error_handler_t::replace));
      else if (common.plain)
        print(written_sentences({arguments->file}));
      else
        terminal.message("wrote " + arguments->file);
      return 0;
    };
  });
}

}  // namespace sparsha::app
