// The `sparsha` program: parses the command line, runs one subcommand, turns errors into messages and exit codes.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <string>
#include <system_error>
#include <vector>

#include "app/command_line.h"
#include "app/commands/commands.h"
#include "app/terminal/terminal.h"
#include "app/version_text.h"
#include "base/error.h"
#include "base/system.h"
#include "base/system/signals.h"
#include "pipeline/cluster/ranks.h"

namespace {

#if defined(SPARSHA_SIGNALS_BEFORE_MAIN)
// Run once libraries are loaded and before they set themselves up: a signal that comes sooner than main() is not lost.
[[gnu::used, gnu::section(".preinit_array")]] void (*const catch_interrupts_first)() = sparsha::app::catch_interrupts;
#endif

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
  } catch (const ReaderGone&) {  // nobody is left who could read more, and a promised output is missing
    return 1;
  } catch (const sparsha::Error& error) {
    print_error(error.what());
    return static_cast<int>(error.kind());
  } catch (const std::bad_alloc&) {
    print_error("error: out of memory; a smaller input, a coarser grid or --memory");
    return 1;
  } catch (const std::system_error& error) {
    const bool threads = error.code() == std::errc::resource_unavailable_try_again;
    print_error(std::string(threads ? "error: the system cannot start another thread (too many are running; see "
                                      "'ulimit -u'): "
                                    : "error: ") +
                error.what());
    return 1;
  } catch (const std::exception& error) {
    print_error(std::string("error: ") + error.what());
    return 1;
  }
}

// Several processes share a build; of any other command each would do the same, and write the same files.
int refuse_ranks(const std::string& command, const sparsha::pipeline::Launched& launched) {
  constexpr auto kUsage = sparsha::ErrorKind::usage;
  if (launched.rank == 0) {
    const std::string wrong = "`sparsha " + command + "` is run by one process, and a launcher of MPI started " +
                              std::to_string(launched.size);
    sparsha::app::print_error(sparsha::Error(kUsage, {}, wrong, "`sparsha " + command + "` without mpirun").what());
  }
  return static_cast<int>(kUsage);
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
  CommandLine line("sparsha", "Sparsha: touch, see and hear scanned heritage", version_text());
  Command app = line.program();
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
  add_config(app, common, run);
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

  if (const Run instead = line.parse(argc, argv)) return deliver(instead);
  const sparsha::pipeline::Launched launched = sparsha::pipeline::launched();
  if (launched.size > 1 && line.subcommand() != "build") return refuse_ranks(line.subcommand(), launched);
  return deliver(run);
}
