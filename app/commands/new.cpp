// sparsha new SCAN...: a commented configuration on standard output.
#include <CLI/CLI.hpp>
#include <memory>

#include "app/commands/commands.h"
#include "app/terminal.h"
#include "pipeline/suggest/suggest.h"

namespace sparsha::app {

void add_new(CLI::App& app, const CommonOptions& common, Run& run) {
  auto scans = std::make_shared<std::vector<std::string>>();
  CLI::App* command = app.add_subcommand("new", "Write a commented first configuration for scans");
  command->add_option("scan", *scans, "scan files")->required();
  command->callback([scans, &common, &run] {
    run = [scans, &common] {
      Terminal terminal(common);
      const std::vector<std::filesystem::path> files(scans->begin(), scans->end());
      print(pipeline::suggest_config(files, {}, terminal.progress()).yaml);
      return 0;
    };
  });
}

}  // namespace sparsha::app
