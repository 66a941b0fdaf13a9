// sparsha bench export DIR | judge DIR RESULTS.csv: a benchmark for other renderers of force, and their score.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "app/commands/commands.h"
#include "app/terminal/terminal.h"
#include "protocol/benchmark.h"
#include "protocol/judge.h"

namespace sparsha::app {
namespace {

struct Arguments {
  std::string folder;
  std::string results;
};

std::string joined(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
  return text;
}

nlohmann::ordered_json json_of(const protocol::Verdict& verdict) {
  nlohmann::ordered_json cases = nlohmann::ordered_json::array();
  for (const protocol::Judgement& j : verdict.cases) {
    const protocol::Score& s = j.score;
    nlohmann::ordered_json one = {{"case", j.case_name},
                                  {"pass", j.pass()},
                                  {"error", {{"median", s.error_median}, {"p99", s.error_p99}, {"max", s.error_max}}},
                                  {"size", {{"median", s.size_median}, {"p99", s.size_p99}}},
                                  {"angle_deg", {{"median", s.angle_median_deg}, {"p99", s.angle_p99_deg}}},
                                  {"lost", s.lost},
                                  {"felt", s.felt},
                                  {"jumps", s.jumps},
                                  {"ghost", j.ghost},
                                  {"worst", {{"t_s", j.worst_t_s}, {"line", j.worst_line}}},
                                  {"tick_ns", nullptr}};
    if (j.p50_ns) one["tick_ns"] = {{"p50", *j.p50_ns}, {"p99", *j.p99_ns}};
    cases.push_back(std::move(one));
  }
  return {{"cases", std::move(cases)}, {"absent", verdict.absent}};
}

std::string table_of(const protocol::Verdict& verdict, const std::string& results) {
  std::string text = fmt::format("{:<14} {:<7} {:>9} {:>9} {:>9} {:>9} {:>8} {:>8} {:>8} {:>8}\n", "case", "verdict",
                                 "median", "99 %", "largest", "angle 99%", "lost", "felt", "jumps", "ghost");
  for (const protocol::Judgement& j : verdict.cases) {
    const protocol::Score& s = j.score;
    text += fmt::format(
        "{:<14} {:<7} {:>7.3g} % {:>7.3g} % {:>7.3g} % {:>7.3g} d {:>6.3g} % {:>6.3g} % {:>6.3g} % {:>6.3g} %\n",
        j.case_name, j.pass() ? "pass" : "fail", 100.0 * s.error_median, 100.0 * s.error_p99, 100.0 * s.error_max,
        s.angle_p99_deg, 100.0 * s.lost, 100.0 * s.felt, 100.0 * s.jumps, 100.0 * j.ghost);
  }
  for (const protocol::Judgement& j : verdict.cases)
    if (!j.pass())
      text += fmt::format("{}: largest error at {:g} s, {}:{}\n", j.case_name, j.worst_t_s, results, j.worst_line);
  if (!verdict.absent.empty()) text += "not in the results: " + joined(verdict.absent) + "\n";
  return text;
}

std::string sentences_of(const protocol::Verdict& verdict) {
  std::string text;
  for (const protocol::Judgement& j : verdict.cases) {
    const protocol::Score& s = j.score;
    text += fmt::format(
        "Case {} {}. The force error is {:.3g} % in the median, {:.3g} % at the 99th percentile and {:.3g} % at most, "
        "at "
        "{:g} s. Ticks lost {:.3g} %, felt {:.3g} %, jumps {:.3g} %, force in free space {:.3g} %.\n",
        j.case_name, j.pass() ? "passes" : "fails", 100.0 * s.error_median, 100.0 * s.error_p99, 100.0 * s.error_max,
        j.worst_t_s, 100.0 * s.lost, 100.0 * s.felt, 100.0 * s.jumps, 100.0 * j.ghost);
  }
  if (!verdict.absent.empty()) text += "Not in the results: " + joined(verdict.absent) + ".\n";
  return text;
}

int run_export(const Arguments& arguments, const CommonOptions& common) {
  const Terminal terminal(common);
  protocol::export_benchmark(arguments.folder);
  terminal.message("benchmark written to " + arguments.folder + "; protocol.md there says how it is run and judged");
  if (common.json) print(nlohmann::ordered_json{{"folder", arguments.folder}}.dump(2));
  return 0;
}

int run_judge(const Arguments& arguments, const CommonOptions& common) {
  const protocol::Verdict verdict = protocol::judge(arguments.folder, arguments.results);
  print(common.json    ? json_of(verdict).dump(2)
        : common.plain ? sentences_of(verdict)
                       : table_of(verdict, arguments.results));
  return 0;
}

}  // namespace

void add_bench(Command app, const CommonOptions& common, Run& run) {
  Command command = app.add_subcommand("bench", "A benchmark for renderers of force: its files, and their score");
  command.requires_subcommand();
  auto arguments = std::make_shared<Arguments>();
  Command out = command.add_subcommand("export", "Write surfaces, paths, true forces, metrics and the protocol");
  out.add_option("folder", arguments->folder, "new or empty folder, or an older export").required();
  out.callback([arguments, &common, &run] { run = [arguments, &common] { return run_export(*arguments, common); }; });
  Command score = command.add_subcommand("judge", "Judge the forces of any renderer (protocol.md)");
  score.add_option("folder", arguments->folder, "as `bench export` wrote it").required();
  score.add_option("results", arguments->results, "results.csv: case,t_s,force_x_n,force_y_n,force_z_n").required();
  score.callback([arguments, &common, &run] { run = [arguments, &common] { return run_judge(*arguments, common); }; });
}

}  // namespace sparsha::app
