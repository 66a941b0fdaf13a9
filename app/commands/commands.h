// The subcommands: each adds itself to the command line and returns what to run.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "scene/scene.h"

namespace CLI {
class App;
}

namespace sparsha::app {

/// Options every subcommand has.
struct CommonOptions {
  bool json = false;                 ///< results as JSON on standard output
  bool quiet = false;                ///< no messages but errors
  bool plain = false;                ///< complete sentences instead of columns and a progress bar
  bool trust = false;                ///< scenes may name files outside their folders
  std::vector<std::string> command;  ///< `device emulate`: what stands behind --

  [[nodiscard]] pipeline::Trust trusted() const {
    return trust ? pipeline::Trust::any_file : pipeline::Trust::own_folder;
  }
};

/// Runs a subcommand after parsing; throws Error. Returns the exit code.
using Run = std::function<int()>;

void add_new(CLI::App& app, const CommonOptions& common, Run& run);
void add_build(CLI::App& app, const CommonOptions& common, Run& run);
void add_check(CLI::App& app, const CommonOptions& common, Run& run);
void add_explore(CLI::App& app, const CommonOptions& common, Run& run);
void add_trace(CLI::App& app, const CommonOptions& common, Run& run);
void add_export(CLI::App& app, const CommonOptions& common, Run& run);
void add_simulate(CLI::App& app, const CommonOptions& common, Run& run);
void add_register(CLI::App& app, const CommonOptions& common, Run& run);
void add_info(CLI::App& app, const CommonOptions& common, Run& run);
void add_device(CLI::App& app, const CommonOptions& common, Run& run);
void add_sound(CLI::App& app, const CommonOptions& common, Run& run);
void add_bench(CLI::App& app, const CommonOptions& common, Run& run);

}  // namespace sparsha::app
