// sparsha trace SCENE --hip path.csv --out trace.csv: a path of the hand in, proxy and force out, offline.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "app/commands/commands.h"
#include "app/commands/sentences.h"
#include "app/exploration/kept_scenes.h"
#include "app/inputs.h"
#include "app/terminal/terminal.h"
#include "base/error.h"
#include "base/text/text.h"
#include "haptics/replay/around_trace.h"
#include "haptics/replay/replay_trace.h"
#include "haptics/replay/trace.h"
#include "haptics/replay/traced_surface.h"
#include "haptics/replay/unrolled_trace.h"
#include "haptics/window/objects.h"
#include "scene/folder/heights.h"
#include "scene/scene.h"

namespace sparsha::app {

namespace {

struct Arguments {
  std::string scene;
  std::string hip;
  std::string out;
  std::string solver;
  std::string frame = "grid";
  int level = -1;
  std::vector<double> centre;
  bool no_texture = false;
  bool no_friction = false;
  double rho = 0.5;
  int iterations = 100;
  bool live = false;
  double tip_radius_mm = 0.0;
  std::string creases = "sharp";
};

/// Options that one solver alone uses.
struct OfSolver {
  std::vector<Option> exact, paper;
};

haptics::TracedPart part_of(const Arguments& arguments) {
  haptics::TracedPart part;
  part.level = arguments.level;
  if (!arguments.centre.empty()) part.centre_m = {arguments.centre[0], arguments.centre[1]};
  part.texture = !arguments.no_texture;
  part.friction = !arguments.no_friction;
  part.tip_radius_m = 1e-3 * arguments.tip_radius_mm;
  return part;
}

haptics::SurfaceOptions surface_options(const Arguments& arguments) {
  haptics::SurfaceOptions options;
  options.effects.texture = !arguments.no_texture;
  options.effects.friction = !arguments.no_friction;
  options.tip_radius_m = 1e-3 * arguments.tip_radius_mm;
  return options;
}

haptics::HipFrame frame_of(const std::string& name) {
  if (name == "scan") return haptics::HipFrame::scan;
  return name == "device" ? haptics::HipFrame::device : haptics::HipFrame::grid;
}

bool traces_whole_object(const scene::Scene& scene, const Arguments& arguments) {
  return arguments.frame == "scan" && !arguments.live && scene.description().charts != nullptr;
}

haptics::TraceResult trace_whole_object(const scene::Scene& scene, const Arguments& arguments,
                                        const scene::HapticsConfig& haptics, const haptics::SolverOptions& options,
                                        Progress& progress) {
  const auto refuse = [](const char* what) {
    throw usage_error(std::string(what) + " is not there for whole objects yet",
                      "without it, or --frame grid for the front view");
  };
  if (haptics.solver == scene::HapticsConfig::Solver::paper) refuse("--solver paper");
  if (arguments.level >= 0 || !arguments.centre.empty()) refuse("a window (--level, --centre)");
  if (arguments.tip_radius_mm > 0.0) refuse("--tip-radius-mm");
  if (arguments.no_texture && !haptics::has_envelope(*scene.description().charts))
    throw usage_error("the sheets of this scene have no envelope for --no-texture",
                      "a scene built with a block 'texture', or without the option");
  const auto object = haptics::whole_object(scene.description(), {!arguments.no_texture, !arguments.no_friction});
  return haptics::trace_around(*object, haptics::read_hip_path(arguments.hip, &progress),
                               scene.description().scan_from_grid, haptics, options);
}

nlohmann::ordered_json summary_json(const haptics::TraceSummary& s) {
  nlohmann::ordered_json json{{"updates", s.updates},
                              {"contacts", s.contacts},
                              {"ns",
                               {{"p50", s.ns_p50},
                                {"p99", s.ns_p99},
                                {"p999", s.ns_p999},
                                {"max", s.ns_max},
                                {"mean", s.ns_mean},
                                {"timer_overhead", s.timer_overhead_ns}}},
                              {"residual_cells", {{"p99", s.residual_cells_p99}, {"max", s.residual_cells_max}}},
                              {"below_surface", s.below_surface},
                              {"not_a_number", s.not_a_number},
                              {"unfinished", s.unfinished},
                              {"path",
                               {{"not_a_number", s.path.not_a_number},
                                {"same_time", s.path.same_time},
                                {"backwards", s.path.backwards},
                                {"outside", s.path.outside},
                                {"outside_in_contact", s.path.outside_in_contact},
                                {"outside_m", s.path.outside_m},
                                {"impossible_force", s.path.impossible_force}}},
                              {"largest_force_n", s.path.largest_force_n},
                              {"deepest_m", s.path.deepest_m}};
  if (s.around)
    json["around"] = {{"sheets", s.around->sheets},
                      {"touched", s.around->touched},
                      {"hand_overs", s.around->hand_overs},
                      {"edges", s.around->edges},
                      {"releases", s.around->releases}};
  return json;
}

std::string around_line(const haptics::TraceSummary& s) {
  if (!s.around) return {};
  return fmt::format("sheets    {} of {} touched, {} hand-overs, {} across edges, {} releases\n", s.around->touched,
                     s.around->sheets, s.around->hand_overs, s.around->edges, s.around->releases);
}

std::string doubt_of(const scene::Scene& scene, int level) {
  return scene::doubt_of_heights(scene.read_level(level), level);
}

haptics::TraceResult trace_path(const scene::Scene& scene, const Arguments& arguments,
                                const scene::HapticsConfig& haptics, const haptics::SolverOptions& options,
                                Progress& progress) {
  if (scene.description().config.unroll && arguments.frame == "scan") {
    if (arguments.level >= 0 || !arguments.centre.empty())
      throw usage_error("a window (--level, --centre) has no scan frame on an unrolled object", "--frame grid with it");
    return haptics::trace_unrolled(scene, haptics::read_hip_path(arguments.hip, &progress), surface_options(arguments),
                                   haptics, options);
  }
  const auto surface = haptics::traced_surface(scene, part_of(arguments));
  std::vector<haptics::HipSample> path = haptics::read_hip_path(arguments.hip, &progress);
  haptics::to_grid_frame(path, frame_of(arguments.frame), scene.description(), *surface);
  return haptics::trace(*surface, path, haptics, options);
}

void refuse_idle(const OfSolver& options, scene::HapticsConfig::Solver solver) {
  const bool paper = solver == scene::HapticsConfig::Solver::paper;
  for (const Option& option : paper ? options.exact : options.paper)
    if (option.given())
      throw usage_error(option.name() + " means nothing here",
                        paper ? "--solver exact with it" : "--solver paper with it");
}

int run_trace(const Arguments& arguments, const OfSolver& of_solver, const CommonOptions& common) {
  if (std::isnan(arguments.rho)) throw usage_error("--rho nan", "a number from 0.01 to 1");
  Terminal terminal(common);
  check_outputs({{"--out", arguments.out}}, {arguments.scene}, {{"--hip", arguments.hip}});
  std::optional<haptics::Recording> recording;
  std::optional<haptics::RecordedScenes> kept;
  if (arguments.live) kept = kept_scenes_of(recording.emplace(arguments.hip), common, terminal);
  const scene::ScenePointer scene =
      kept ? kept->first() : scene_from({arguments.scene}, common.trusted(), terminal.progress());
  const bool around = traces_whole_object(*scene, arguments);
  if (!around) warn_of_front_view(*scene, "trace", terminal.progress());
  scene::HapticsConfig haptics = scene->description().config.haptics;
  if (arguments.solver == "exact") haptics.solver = scene::HapticsConfig::Solver::exact;
  if (arguments.solver == "paper") haptics.solver = scene::HapticsConfig::Solver::paper;
  refuse_idle(of_solver, haptics.solver);
  haptics::SolverOptions options;
  options.paper_rho = arguments.rho;
  options.paper_iterations = arguments.iterations;
  if (arguments.creases == "rounded") options.shape = haptics::CellShape::rounded;
  const haptics::TraceResult result =
      recording ? trace_recording(kept.value_or(haptics::RecordedScenes(scene)), *recording, haptics, options)
      : around  ? trace_whole_object(*scene, arguments, haptics, options, terminal.progress())
                : trace_path(*scene, arguments, haptics, options, terminal.progress());
  haptics::write_trace(arguments.out, result);
  if (const std::string doubt = around ? std::string() : doubt_of(*scene, std::max(arguments.level, 0)); !doubt.empty())
    terminal.progress().warn(doubt);
  for (const std::string& doubt : haptics::sentences(result.summary.path)) terminal.progress().warn(doubt);
  const haptics::TraceSummary& s = result.summary;
  print(common.json    ? summary_json(s).dump(2)
        : common.plain ? trace_sentences(s, arguments.out)
                       : fmt::format("updates   {}, {} in contact\n"
                                     "time      {:.0f} ns median, {:.0f} ns 99 %, {:.0f} ns at most\n"
                                     "residual  {:.2g} cells 99 %, {:.2g} at most\n"
                                     "trouble   {} below the surface, {} not a number, {} unfinished\n"
                                     "{}trace     {}\n",
                                     count_text(s.updates), count_text(s.contacts), s.ns_p50, s.ns_p99, s.ns_max,
                                     s.residual_cells_p99, s.residual_cells_max, s.below_surface, s.not_a_number,
                                     s.unfinished, around_line(s), arguments.out));
  return 0;
}

}  // namespace

void add_trace(Command app, const CommonOptions& common, Run& run) {
  auto arguments = std::make_shared<Arguments>();
  Command command = app.add_subcommand("trace", "Render a recorded path of the hand offline: proxy and force");
  command.add_option("scene", arguments->scene, "scene folder, configuration or scan").required();
  command.add_option("--hip", arguments->hip, "path.csv (t_s,x_m,y_m,z_m) or a run.csv").required();
  command.add_option("--out,-o", arguments->out, "trace.csv").required();
  command.add_option("--solver", arguments->solver, "default: the scene's").check(one_of({"exact", "paper"}));
  command.add_option("--frame", arguments->frame, "frame of the path")
      .check(one_of({"grid", "scan", "device"}))
      .shows_default();
  command.add_option("--level", arguments->level, "trace a window of this level").check(whole_between(0, 64));
  command.add_option("--centre", arguments->centre, "X Y: centre of the window, grid frame, metres").expects(2);
  command.add_flag("--no-texture", arguments->no_texture, "render the envelope");
  command.add_flag("--no-friction", arguments->no_friction, "render without friction");
  command.add_option("--tip-radius-mm", arguments->tip_radius_mm, "touch with a ball, device frame; default: a point")
      .check(between(0.0, 2.0));
  OfSolver of_solver;
  of_solver.exact = {command.add_option(
      "--creases", arguments->creases, "of the bilinear surface; sharp: the reference, rounded: as a hand feels them")};
  of_solver.exact.front().check(one_of({"sharp", "rounded"})).shows_default();
  command
      .add_flag("--live", arguments->live,
                "a run.csv on the windows, centres and stiffness it was recorded with: the live run once more")
      .excludes({"--level", "--centre", "--frame", "--no-texture", "--no-friction", "--tip-radius-mm", "--creases"});
  of_solver.paper = {command.add_option("--rho", arguments->rho, "step factor of the paper's solver"),
                     command.add_option("--iterations", arguments->iterations, "iterations of the paper's solver")};
  of_solver.paper[0].check(between(0.01, 1.0));
  of_solver.paper[1].check(whole_between(1, 1000000));
  command.callback([arguments, of_solver, &common, &run] {
    run = [arguments, of_solver, &common] { return run_trace(*arguments, of_solver, common); };
  });
}

}  // namespace sparsha::app
