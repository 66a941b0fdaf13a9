// sparsha check SCENE [SCAN...]: cross-check a scene against scans, its own or others.
#include <fmt/format.h>

#include <Eigen/LU>
#include <memory>

#include "app/commands/commands.h"
#include "app/commands/sentences.h"
#include "app/terminal/terminal.h"
#include "base/error.h"
#include "base/text/text.h"
#include "pipeline/build/recheck.h"
#include "scene/scene.h"

namespace sparsha::app {

namespace {

std::string line(const std::string& name, const pipeline::DistanceStatistics& s) {
  if (s.samples == 0) return fmt::format("{:<16}  nothing to compare\n", name);
  return fmt::format("{:<16}  {} samples: mean {}, RMS {}, median {}, 95 % {}, 99 % {}, at most {}\n", name,
                     count_text(s.samples), length_text(s.mean_m), length_text(s.rms_m), length_text(s.median_m),
                     length_text(s.p95_m), length_text(s.p99_m), length_text(s.max_m));
}

// Of a scene with charts.
std::string around_lines(const pipeline::Report& report) {
  if (!report.around || !report.around->check) return {};
  const pipeline::ChartCheck& check = *report.around->check;
  return line("whole object", check.cloud_to_surface) +
         fmt::format("{:<16}  {} of {} sampled points lie more than {:.0f} nodes from every sheet\n", "far",
                     count_text(check.far), count_text(check.sampled), pipeline::ChartCheck::kFarSpacings) +
         line("sheets agree", check.agreement) +
         fmt::format("{:<16}  {} of {} nodes face what the points enclose; of {} no ray tells\n", "sides",
                     count_text(check.sides.inwards), count_text(check.sides.told + check.sides.untold),
                     count_text(check.sides.untold));
}

std::string thing_of(pipeline::CheckResult::Against against) {
  using Against = pipeline::CheckResult::Against;
  if (against == Against::points) return "cloud";
  return against == Against::mesh ? "mesh" : "mesh and points";
}

}  // namespace

void add_check(Command app, const CommonOptions& common, Run& run) {
  struct Arguments {
    std::string scene;
    std::vector<std::string> scans;
    std::int64_t samples = 50000;
    bool all = false;
    unsigned threads = 0;
  };
  auto arguments = std::make_shared<Arguments>();
  Command command = app.add_subcommand("check", "Measure how far a scene's surface is from scans");
  command.add_option("scene", arguments->scene, "scene folder").required();
  command.add_option("scan", arguments->scans, "scans to compare with; default: the scene's own");
  command.add_option("--samples", arguments->samples, "points to sample").check(positive());
  command.add_flag("--all", arguments->all, "every point");
  command.add_option("--threads", arguments->threads, "threads; 0 = one a core").check(whole_between(0U, 1024U));
  command.callback([arguments, &common, &run] {
    run = [arguments, &common] {
      Terminal terminal(common);
      const scene::ScenePointer scene = scene::open_scene(arguments->scene, common.trusted());
      const std::vector<std::filesystem::path> scans(arguments->scans.begin(), arguments->scans.end());
      const scene::CheckConfig config{arguments->all ? 0 : arguments->samples};
      const pipeline::Report report =
          pipeline::recheck_scene(*scene, scans, config, arguments->threads, terminal.progress(), common.trusted());
      const std::string against = thing_of(report.check->against);
      print(common.json    ? pipeline::report_json(*scene, report)
            : common.plain ? check_sentences(*report.check)
                           : line(against + " to surface", report.check->cloud_to_surface) +
                                 line("surface to " + against, report.check->surface_to_cloud) +
                                 (report.check->completeness
                                      ? fmt::format("completeness      {:.2f} %\n", 100.0 * *report.check->completeness)
                                      : std::string()) +
                                 around_lines(report));
      if (scene->description().charts && !report.around) {
        terminal.progress().warn("the whole object was not checked");
      }
      return 0;
    };
  });
}

}  // namespace sparsha::app
