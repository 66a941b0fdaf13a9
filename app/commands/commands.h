// The subcommands: each adds itself to the command line and returns what to run.
#pragma once

#include <string>
#include <vector>

#include "app/command_line.h"
#include "scene/scene_fwd.h"

namespace sparsha::app {

/// Options every subcommand has.
struct CommonOptions {
  bool json = false;                 ///< results as JSON on standard output
  bool quiet = false;                ///< no messages but errors
  bool plain = false;                ///< complete sentences instead of columns and a progress bar
  bool trust = false;                ///< scenes may name files outside their folders
  std::vector<std::string> command;  ///< `device emulate`: what stands behind --

  [[nodiscard]] scene::Trust trusted() const { return trust ? scene::Trust::any_file : scene::Trust::own_folder; }
};

void add_new(Command app, const CommonOptions& common, Run& run);
void add_build(Command app, const CommonOptions& common, Run& run);
void add_check(Command app, const CommonOptions& common, Run& run);
void add_explore(Command app, const CommonOptions& common, Run& run);
void add_trace(Command app, const CommonOptions& common, Run& run);
void add_export(Command app, const CommonOptions& common, Run& run);
void add_simulate(Command app, const CommonOptions& common, Run& run);
void add_register(Command app, const CommonOptions& common, Run& run);
void add_config(Command app, const CommonOptions& common, Run& run);
void add_info(Command app, const CommonOptions& common, Run& run);
void add_device(Command app, const CommonOptions& common, Run& run);
void add_sound(Command app, const CommonOptions& common, Run& run);
void add_bench(Command app, const CommonOptions& common, Run& run);

}  // namespace sparsha::app
