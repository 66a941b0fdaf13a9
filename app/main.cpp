// The `sparsha` program: parses the command line, runs one subcommand, turns errors into messages and exit codes.
#include <CLI/CLI.hpp>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "app/commands/commands.h"
#include "app/terminal.h"
#include "base/error.h"
#include "base/system.h"
#include "base/system/signals.h"
#include "base/yaml.h"

namespace {

constexpr int kUsage = 2;

#if defined(SPARSHA_SIGNALS_BEFORE_MAIN)
// Run once libraries are loaded and before they set themselves up: a signal that comes sooner than main() is not lost.
[[gnu::used, gnu::section(".preinit_array")]] void (*const catch_interrupts_first)() = sparsha::app::catch_interrupts;
#endif

// "error: ...; did you mean --headless?" for an option or subcommand that does not exist.
std::string usage_message(const CLI::ParseError& error, const CLI::App& app,
                          const std::vector<std::string>& arguments) {
  std::string text = std::string("error: ") + error.what();
  std::vector<std::string> names;
  for (const CLI::App* subcommand : app.get_subcommands({})) {
    if (!app.got_subcommand(subcommand)) continue;
    for (const CLI::Option* option : subcommand->get_options())
      if (!option->get_lnames().empty()) names.push_back("--" + option->get_lnames().front());
  }
  const bool in_subcommand = !names.empty();
  if (!in_subcommand)
    for (const CLI::App* subcommand : app.get_subcommands({})) names.push_back(subcommand->get_name());
  for (const std::string& argument : arguments) {
    if (in_subcommand != argument.starts_with("--")) continue;
    const std::string word = argument.substr(0, argument.find('='));
    if (std::find(names.begin(), names.end(), word) != names.end()) continue;
    const std::string near = sparsha::yaml::nearest(word, names);
    if (!near.empty() && near != word) return text + "; did you mean " + near + "?";
  }
  return text + "; sparsha --help lists what there is";
}

// Runs a command to its exit code; results that cannot be written are a failure, whatever they are.
int deliver(const sparsha::app::Run& run) {
  using namespace sparsha::app;
  try {
    const int code = run();
    flush_output();
    return code;
  } catch (const sparsha::Cancelled&) {
    print_error("stopped; nothing was changed");
    return 1;
  } catch (const sparsha::Error& error) {
    print_error(error.what());
    return static_cast<int>(error.kind());
  } catch (const std::bad_alloc&) {
    print_error("error: out of memory; a smaller input, a coarser grid or --memory");
    return 1;
  } catch (const std::exception& error) {
    print_error(std::string("error: ") + error.what());
    return 1;
  }
}

}  // namespace

int main(int argc, char** argv) {
  using namespace sparsha::app;
#if !defined(SPARSHA_SIGNALS_BEFORE_MAIN)
  catch_interrupts();
#endif
  sparsha::system::survive_cut_files();
  sparsha::system::open_standard_streams();
  sparsha::system::allow_many_open_files();
  CLI::App app("Sparsha: touch, see and hear scanned heritage", "sparsha");
  app.set_version_flag("--version", std::string("sparsha ") + SPARSHA_VERSION);
  app.require_subcommand(1);
  app.fallthrough();
  CommonOptions common;
  app.add_flag("--json", common.json, "results as JSON");
  app.add_flag("--quiet,-q", common.quiet, "no messages but errors");
  app.add_flag("--plain", common.plain, "complete sentences instead of columns and a progress bar, for screen readers");
  app.add_flag("--trust", common.trust, "follow a scene to clips, layers and scans outside its folder");
  Run run;
  add_new(app, common, run);
  add_build(app, common, run);
  add_check(app, common, run);
  add_explore(app, common, run);
  add_trace(app, common, run);
  add_export(app, common, run);
  add_simulate(app, common, run);
  add_register(app, common, run);
  add_info(app, common, run);
  add_device(app, common, run);
  add_sound(app, common, run);
  add_bench(app, common, run);

  // What stands behind -- is another program's, dashes and all.
  const std::vector<std::string> words(argv + 1, argv + argc);
  const auto dashes = std::find(words.begin(), words.end(), "--");
  const bool emulates = std::find(words.begin(), dashes, "emulate") != dashes;
  if (emulates && dashes != words.end()) {
    common.command.assign(dashes + 1, words.end());
    argc = 1 + static_cast<int>(dashes - words.begin());
  }

  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return deliver([&] { return app.exit(error); });  // --help, --version
    const std::vector<std::string> arguments(argv + 1, argv + argc);
    print_error(usage_message(error, app, arguments));
    return kUsage;
  }

  return deliver(run);
}
