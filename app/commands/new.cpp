// sparsha new SCAN...: a commented configuration on standard output or in a file.
#include <memory>

#include "app/commands/commands.h"
#include "app/inputs.h"
#include "app/terminal/terminal.h"
#include "base/error.h"
#include "base/files/files.h"
#include "base/system/terminal.h"
#include "pipeline/suggest/suggest.h"

namespace sparsha::app {
namespace {

namespace fs = std::filesystem;

struct Arguments {
  std::vector<std::string> scans;
  std::string out;
  std::string up;
  bool force = false;
};

// Somebody may have worked on the configuration that is there.
void require_free(const fs::path& target) {
  std::error_code code;
  if (fs::is_regular_file(fs::status(target, code))) {
    throw Error(ErrorKind::usage, {target.string(), 0, 0}, "the file is there already", "another name, or --force");
  }
}

int write_first_configuration(const Arguments& arguments, const CommonOptions& common) {
  if (common.json) throw usage_error("`new` writes a configuration, which is YAML", "the command without --json");
  Terminal terminal(common);
  const std::vector<fs::path> files(arguments.scans.begin(), arguments.scans.end());
  const fs::path target = arguments.out;
  pipeline::SuggestOptions options;
  if (const std::string& up = arguments.up; !up.empty())
    options.up = (up.size() > 1 ? -1.0 : 1.0) * Eigen::Vector3d::Unit(up.back() - 'x');
  if (target.empty()) {
    // Paths are relative to the file that the configuration will be in: where the shell has opened one, to that.
    const fs::path folder = system::standard_output_file().parent_path();
    print(pipeline::suggest_config(files, folder, terminal.progress(), options).yaml);
    return 0;
  }
  if (!arguments.force) require_free(target);
  check_outputs({{"--out", target}}, arguments.scans);
  write_file(target, pipeline::suggest_config(files, target.parent_path(), terminal.progress(), options).yaml);
  return 0;
}

}  // namespace

void add_new(Command app, const CommonOptions& common, Run& run) {
  auto arguments = std::make_shared<Arguments>();
  Command command = app.add_subcommand("new", "Write a commented first configuration for scans");
  command.add_option("scan", arguments->scans, "scan files").required();
  command.add_option("--out,-o", arguments->out, "file for it, instead of standard output");
  command.add_flag("--force", arguments->force, "replace the file");
  command
      .add_option("--up", arguments->up,
                  "the scans' axis that points up: x, y, z, -x, -y or -z; default: told by the object")
      .check(one_of({"x", "y", "z", "-x", "-y", "-z"}));
  command.callback([arguments, &common, &run] {
    run = [arguments, &common] { return write_first_configuration(*arguments, common); };
  });
}

}  // namespace sparsha::app
