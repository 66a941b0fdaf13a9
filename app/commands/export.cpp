// sparsha export SCENE --to FILE: mesh, points or heights, back in the scan frame; or a replica to be printed.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands/commands.h"
#include "app/commands/sentences.h"
#include "app/inputs.h"
#include "app/terminal/terminal.h"
#include "pipeline/export/export.h"
#include "pipeline/replica/replica.h"
#include "scene/scene.h"

namespace sparsha::app {

namespace {

int make_replica(const std::string& folder, const std::string& file, const pipeline::ReplicaOptions& options,
                 const CommonOptions& common) {
  Terminal terminal(common);
  check_outputs({{"--to", file}, {"the legibility map of --to", pipeline::legibility_file_of(file)}}, folder);
  const scene::ScenePointer scene = scene_from({folder}, common.trusted(), terminal.progress());
  warn_of_front_view(*scene, "a replica", terminal.progress());
  const pipeline::ReplicaReport report = pipeline::export_replica(*scene, file, options, terminal.progress());
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

}  // namespace

void add_export(Command app, const CommonOptions& common, Run& run) {
  struct Arguments {
    std::string scene;
    std::string file;
    bool nodes = false;
    bool haptics = false;
    pipeline::ReplicaOptions replica;
    bool no_braille = false;
  };
  auto arguments = std::make_shared<Arguments>();
  Command command = app.add_subcommand("export", "Write a scene as mesh, points or heights in the scan's own frame");
  command.add_option("scene", arguments->scene, "scene folder").required();
  command.add_option("--to", arguments->file, "FILE.ply, .obj, .xyz, .glb, .tif or .png; .stl or .3mf: a replica")
      .required();
  command.add_flag("--nodes", arguments->nodes, "points of measured nodes only (ply, obj, xyz)");
  command.add_flag("--haptics", arguments->haptics, "stiffness, friction and texture as maps in the file (glb)");
  const char* const group = "Replica (.stl, .3mf)";
  std::vector<Option> of_replica = {
      command.add_option("--size-mm", arguments->replica.longest_mm, "longer side of the relief").shows_default(),
      command.add_option("--depth-mm", arguments->replica.depth_mm, "from lowest to highest; default: true, 3 to 15"),
      command.add_option("--curve", arguments->replica.curve, "below 1 raises low relief, above 1 flattens it")
          .shows_default(),
      command.add_option("--base-mm", arguments->replica.base_mm, "plate under the lowest place").shows_default(),
      command.add_flag("--no-braille", arguments->no_braille, "leave out the parts' names")};
  for (Option option : of_replica) option.group(group);
  command.callback([arguments, of_replica, &common, &run] {
    run = [arguments, of_replica, &common] {
      if (pipeline::is_replica(arguments->file)) {
        if (arguments->nodes) throw usage_error("a replica has no separate nodes", ".ply, .obj or .xyz with --nodes");
        if (arguments->haptics) throw usage_error("a replica has no maps of what is felt", ".glb with --haptics");
        arguments->replica.braille = !arguments->no_braille;
        return make_replica(arguments->scene, arguments->file, arguments->replica, common);
      }
      for (const Option& option : of_replica)
        if (option.given())
          throw usage_error(option.name() + " means nothing here", "--to FILE.stl or FILE.3mf with it");
      Terminal terminal(common);
      pipeline::check_export(arguments->file, arguments->nodes, arguments->haptics);
      check_outputs({{"--to", arguments->file}, {"the world file of --to", pipeline::world_file_of(arguments->file)}},
                    arguments->scene);
      const scene::ScenePointer scene = scene_from({arguments->scene}, common.trusted(), terminal.progress());
      if (!arguments->nodes) warn_of_front_view(*scene, "export without --nodes", terminal.progress());
      pipeline::export_scene(*scene, arguments->file, arguments->nodes, terminal.progress(), arguments->haptics);
      if (common.plain)
        print(written_sentences({arguments->file}));
      else
        terminal.message("wrote " + arguments->file);
      return 0;
    };
  });
}

}  // namespace sparsha::app
