// sparsha export SCENE --to FILE: mesh, points or heights, back in the scan frame.
#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands.h"
#include "app/inputs.h"
#include "app/terminal.h"
#include "pipeline/export/export.h"

namespace sparsha::app {

void add_export(CLI::App& app, const CommonOptions& common, Run& run) {
  struct Arguments {
    std::string scene;
    std::string file;
    bool nodes = false;
  };
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("export", "Write a scene as mesh, points or heights in the scan's own frame");
  command->add_option("scene", arguments->scene, "scene folder")->required();
  command->add_option("--to", arguments->file, "FILE.ply, .obj, .xyz, .tif or .png")->required();
  command->add_flag("--nodes", arguments->nodes, "points of measured nodes only (ply, obj, xyz)");
  command->callback([arguments, &common, &run] {
    run = [arguments, &common] {
      Terminal terminal(common);
      pipeline::check_export(arguments->file, arguments->nodes);
      check_outputs({{"--to", arguments->file}, {"the world file of --to", pipeline::world_file_of(arguments->file)}},
                    arguments->scene);
      const pipeline::ScenePointer scene = scene_from(arguments->scene, common.trusted(), terminal.progress());
      pipeline::export_scene(*scene, arguments->file, arguments->nodes, terminal.progress());
      terminal.message("wrote " + arguments->file);
      return 0;
    };
  });
}

}  // namespace sparsha::app
