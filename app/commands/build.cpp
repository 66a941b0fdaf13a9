// sparsha build CONFIG|SCAN...: scans in, scene folder out.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <thread>

#include "app/commands/commands.h"
#include "app/inputs.h"
#include "app/terminal/terminal.h"
#include "app/words/results.h"
#include "app/words/sentences.h"
#include "audio/sound_bank.h"
#include "base/error.h"
#include "base/files/files.h"
#include "base/files/paths.h"
#include "base/system.h"
#include "base/system/process.h"
#include "pipeline/build/build.h"
#include "pipeline/build/on_ranks.h"
#include "pipeline/cluster/ranks.h"
#include "pipeline/outofcore/finished_tiles.h"
#include "pipeline/outofcore/memory.h"
#include "scene/config/config.h"
#include "scene/folder/folder.h"

namespace sparsha::app {
namespace fs = std::filesystem;

namespace {

struct Arguments {
  std::vector<std::string> inputs;
  std::string out;
  std::vector<std::string> settings;
  unsigned threads = 0;
  std::string memory;
  bool validate = false;
  bool force = false;
  bool resume = false;
  std::string only;
};

// "statue.yaml" -> "statue.scene" beside it; a scene's own scene.yaml -> that scene, built again; scans -> beside the
// first scan's name in the current folder.
fs::path default_folder(const Arguments& arguments) {
  const fs::path input = arguments.inputs.front();
  if (fs::path scene = scene_described_by(input); !scene.empty()) return scene;
  const fs::path name = input.stem().string() + ".scene";
  return is_config(input) ? input.parent_path() / name : name;
}

fs::path scene_folder(const Arguments& arguments) {
  if (is_config(arguments.out))
    throw usage_error("--out " + arguments.out + ": a configuration has this ending, and a scene is a folder",
                      "the name of a folder, e.g. " + fs::path(arguments.out).stem().string() + ".scene");
  fs::path folder = arguments.out.empty() ? default_folder(arguments) : fs::path(arguments.out);
  std::error_code code;
  const bool nameless = folder.filename() == "." || folder.filename() == "..";
  if (nameless && fs::exists(folder, code)) folder = fs::canonical(folder, code);
  return folder;
}

// "statue.scene" -> ".statue.scene.tiles" beside it.
fs::path tiles_of(const fs::path& folder) { return hidden_beside(folder, ".tiles"); }

// Before scans are read: a scene that cannot be written need not be built.
void require_place(const fs::path& folder) {
  std::error_code code;
  fs::path parent = without_dots(fs::absolute(folder, code)).parent_path();
  if (fs::is_directory(parent, code)) return require_writable(folder, AtomicPath::Kind::folder);
  while (!fs::exists(parent, code) && parent.has_relative_path()) parent = parent.parent_path();
  for (const fs::path& name : without_dots(fs::absolute(folder, code)).lexically_relative(parent))
    require_possible_name(parent / name);
  if (fs::is_directory(parent, code) && system::is_writable(parent)) return;
  throw Error(ErrorKind::failure, {folder.string(), 0, 0}, "cannot write: no folder can be made in " + parent.string(),
              "a folder that can be written to");
}

// `transport`: to the other processes that build the scene as well; null alone.
int run_build(const Arguments& arguments, const CommonOptions& common, pipeline::Transport* transport) {
  Terminal terminal(common);
  pipeline::BuildOptions options;
  options.threads = arguments.threads;
  options.force = arguments.force;
  options.grid_only = arguments.only == "grid";
  if (!arguments.memory.empty()) options.memory_bytes = parse_bytes(arguments.memory);

  const fs::path folder = scene_folder(arguments);
  if (arguments.resume) options.finished_tiles = tiles_of(folder);
  if (arguments.resume || transport != nullptr) {
    options.program = program_digest();
  }
  if (arguments.resume && transport != nullptr)
    throw usage_error("--resume is for one process, and this one was started by a launcher of MPI",
                      "`sparsha build` without mpirun, or without --resume");
  std::optional<pipeline::Ranks> ranks;
  if (transport != nullptr) options.ranks = &ranks.emplace(*transport, terminal.progress());
  const bool is_root = !ranks || ranks->is_root();
  if (!arguments.validate && is_root) require_place(folder);
  const bool looks = std::none_of(arguments.inputs.begin(), arguments.inputs.end(),
                                  [](const std::string& input) { return is_config(input); });
  pipeline::require_room_for_program(options.memory_bytes, looks);
  const scene::Config config = config_from(arguments.inputs, arguments.settings, common.trusted(), terminal.progress(),
                                           options.memory_bytes, options.force);
  audio::require_clips(config);  // before a long build, not when somebody wants to hear them
  if (ranks) pipeline::require_fit_for_ranks(config);
  if (arguments.validate) {
    for (const scene::ScanConfig& scan : config.scans) {
      std::error_code code;
      if (!fs::is_regular_file(scan.file, code)) {
        throw input_error(scan.file.string(), "the scan does not exist", "a readable file");
      }
    }
    std::error_code code;
    if (config.audio && config.audio->labels && !fs::is_regular_file(config.audio->labels->file, code))
      throw input_error(config.audio->labels->file.string(), "the label image does not exist", "a readable file");
    if (is_root) print(common.json ? std::string("{\"valid\": true}") : scene::to_yaml(config));
    return 0;
  }
  scene::require_replaceable(folder, config);
  std::error_code code;
  fs::create_directories(without_dots(fs::absolute(folder, code)).parent_path(), code);
  if (!is_root) {
    blaming_scans(arguments.inputs, arguments.settings,
                  [&] { pipeline::take_part_in_build(config, options, folder, terminal.progress()); });
    (void)ranks->traffic();
    return 0;
  }
  const pipeline::BuildResult result = blaming_scans(arguments.inputs, arguments.settings, [&] {
    return pipeline::build_scene_folder(config, options, folder, terminal.progress());
  });
  if (ranks) {
    const pipeline::Ranks::Traffic traffic = ranks->traffic();
    terminal.message(fmt::format("{} ranks have sent {} MB to each other, in {:.1f} s with waiting", ranks->size(),
                                 traffic.bytes / 1'000'000U, traffic.seconds));
  }
  if (!arguments.resume) pipeline::remove_finished_tiles(tiles_of(folder));  // of a build that was ended
  print(common.json    ? pipeline::report_json(*result.scene, result.report)
        : common.plain ? build_sentences(*result.scene, result.report, folder)
                       : build_summary(*result.scene, result.report, folder));
  return 0;
}

[[noreturn]] void abort_all(pipeline::Transport& transport, int code) {
  transport.abort(code);
  std::_Exit(code);  // for compilers, which do not see that a virtual function never returns
}

// The rank that failed says so and ends the others. What fails on every rank, the root says alone: it ends them while
// they wait.
[[noreturn]] void end_all(pipeline::Transport& transport, const std::string& wrong, int code) {
  constexpr std::chrono::seconds kForRoot(3);
  if (transport.rank() != 0) std::this_thread::sleep_for(kForRoot);
  print_error(fmt::format("rank {} of {} on {}: {}", transport.rank(), transport.size(), transport.host(), wrong));
  abort_all(transport, code);
}

int run_among_ranks(const Arguments& arguments, const CommonOptions& common) {
  pipeline::Transport& transport = pipeline::mpi_transport();
  CommonOptions own = common;
  own.quiet = common.quiet || transport.rank() != 0;
  try {
    const int code = run_build(arguments, own, &transport);
    transport.finish();
    return code;
  } catch (const Cancelled&) {
    if (transport.rank() == 0) print_error("stopped; nothing was changed");
    abort_all(transport, 1);
  } catch (const Error& error) {
    end_all(transport, error.what(), static_cast<int>(error.kind()));
  } catch (const std::bad_alloc&) {
    end_all(transport, "error: out of memory; more ranks on more machines, a coarser grid or --memory", 1);
  } catch (const std::exception& error) {
    end_all(transport, std::string("error: ") + error.what(), 1);
  }
}

}  // namespace

void add_build(Command app, const CommonOptions& common, Run& run) {
  auto arguments = std::make_shared<Arguments>();
  Command command = app.add_subcommand("build", "Turn scans into a scene that can be touched, seen and heard");
  command.add_option("input", arguments->inputs, "one CONFIG.yaml, or SCANs").required();
  command.add_option("--out,-o", arguments->out, "scene folder; default: beside the input, NAME.scene");
  command.add_option("--set", arguments->settings, "override a key, e.g. grid.size=800").collects().takes_one();
  command.add_option("--threads", arguments->threads, "threads; 0 = one a core").check(whole_between(0U, 1024U));
  command.add_option("--memory", arguments->memory, "memory limit, e.g. 1GB");
  command.add_flag("--validate", arguments->validate, "check the configuration and print it resolved; build nothing");
  command.add_flag("--force", arguments->force,
                   "build although the surface lies far from the points, or chunks of a LAZ file are damaged");
  command.add_flag(
      "--resume", arguments->resume,
      "keep finished tiles beside the scene until it is whole, and go on from those of a build that was ended");
  command.add_option("--only", arguments->only, "grid: read, project and write heights, nothing else")
      .check(one_of({"grid"}));
  command.callback([arguments, &common, &run] {
    run = [arguments, &common] {
      return pipeline::started_by_mpi() ? run_among_ranks(*arguments, common) : run_build(*arguments, common, nullptr);
    };
  });
}

}  // namespace sparsha::app
