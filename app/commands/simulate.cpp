// sparsha simulate CONFIG --out DIR: a scan of a known surface, with the ground truth.
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands/commands.h"
#include "app/commands/sentences.h"
#include "app/inputs.h"
#include "app/terminal/terminal.h"
#include "base/error.h"
#include "pipeline/simulate/simulate.h"

namespace sparsha::app {

void add_simulate(Command app, const CommonOptions& common, Run& run) {
  struct Arguments {
    std::string config;
    std::string out;
  };
  auto arguments = std::make_shared<Arguments>();
  Command command = app.add_subcommand("simulate", "Scan a known surface; writes scans, truth and a configuration");
  command.add_option("config", arguments->config, "simulation (docs/measure/simulation.md)").required();
  command.add_option("--out,-o", arguments->out, "folder for the scans").required();
  command.callback([arguments, &common, &run] {
    run = [arguments, &common] {
      if (is_config(arguments->out))
        throw usage_error(
            "--out " + arguments->out + ": a configuration has this ending, and scans are put in a folder",
            "the name of a folder");
      Terminal terminal(common);
      pipeline::simulate(arguments->config, arguments->out, terminal.progress());
      nlohmann::json names = nlohmann::json::array();
      std::string text;
      std::vector<std::filesystem::path> files;
      for (const auto& entry : std::filesystem::directory_iterator(arguments->out)) files.push_back(entry.path());
      std::sort(files.begin(), files.end());
      for (const std::filesystem::path& file : files) {
        names.push_back(file.generic_string());
        text += file.string() + "\n";
      }
      print(common.json    ? names.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)
            : common.plain ? written_sentences(files)
                           : text);
      return 0;
    };
  });
}

}  // namespace sparsha::app
