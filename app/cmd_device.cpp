// sparsha device list|check|monitor|home|emulate.
#include <CLI/CLI.hpp>

#include "app/commands.h"
#include "app/falcon.h"
#include "app/terminal.h"
#include "pipeline/base/error.h"
#include "viewer/viewer.h"

namespace sparsha::app {

void add_device(CLI::App& app, const CommonOptions& common, Run& run) {
  CLI::App* command = app.add_subcommand("device", "The haptic device: what is there and what state it is in");
  command->require_subcommand(1);
  command->add_subcommand("list", "devices that explore can use now")->callback([&common, &run] {
    run = [&common] {
      const bool display = viewer::display_available();
      if (common.json) {
        print(std::string(R"([{"name": "falcon", "available": false}, {"name": "pointer", "available": )") +
              (display ? "true" : "false") +
              R"(}, {"name": "simulated", "available": true}, {"name": "playback", "available": true}])");
        return 0;
      }
      print(std::string("falcon      not supported by this version\n") + "pointer     " +
            (display ? "available: the mouse is the hand" : "needs a display") + "\n" +
            "simulated   available: a seeded hand explores by itself\n"
            "playback    available: playback:FILE repeats a recorded run.csv\n");
      return 0;
    };
  });
  for (const char* name : {"check", "monitor", "home", "emulate"}) {
    command->add_subcommand(name, "for the Novint Falcon")->callback([&run] {
      run = [] {
        static_cast<void>(open_falcon());
        return 0;
      };
    });
  }
}

}  // namespace sparsha::app
