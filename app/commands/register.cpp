// sparsha register CONFIG: poses that make the scans one cloud, in a copy of the configuration.
#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

#include "app/commands/commands.h"
#include "app/commands/sentences.h"
#include "app/inputs.h"
#include "app/terminal/terminal.h"
#include "base/error.h"
#include "base/files/files.h"
#include "base/text/text.h"
#include "base/threads/thread_pool.h"
#include "pipeline/register/finished_pairs.h"
#include "pipeline/register/register.h"
#include "pipeline/report/registration_page.h"
#include "scene/config/config.h"
#include "scene/config/pose_text.h"

namespace sparsha::app {
namespace fs = std::filesystem;

namespace {

struct Arguments {
  std::string config;
  std::string out;
  std::string report;
  std::vector<std::string> settings;
  unsigned threads = 0;
  bool resume = false;
};

std::string sentence(const scene::Config& config, const pipeline::FirstGuess& guess) {
  return fmt::format("first guess from features: {} on {}, {:.0f} % of it",
                     config.scans[guess.scan].file.filename().string(), config.scans[guess.on].file.filename().string(),
                     100.0 * guess.overlap);
}

std::string table(const scene::Config& config, const pipeline::Registration& found) {
  const auto fit = [](const pipeline::PairFit::Fit& f) {
    return fmt::format("{:>5.1f} %  {:>9}", 100.0 * f.overlap, f.matches > 0 ? length_text(f.residual_m) : "-");
  };
  std::string text;
  for (const pipeline::FirstGuess& guess : found.guesses) text += sentence(config, guess) + "\n";
  text += "overlap and residual (RMS) of each pair\nbefore              after               use\n";
  for (const pipeline::PairFit& pair : found.pairs) {
    text += fmt::format("{}  {}  {:<8}  {} - {}\n", fit(pair.before), fit(pair.after), to_string(pair.use),
                        config.scans[pair.first].file.filename().string(),
                        config.scans[pair.second].file.filename().string());
  }
  if (!found.pairs.empty()) {
    text +=
        fmt::format("before: points within {} of each other; after: within {}",
                    length_text(found.pairs.front().before.within_m), length_text(found.pairs.front().after.within_m));
  }
  return text;
}

std::string json(const scene::Config& config, const pipeline::Registration& found) {
  using Json = nlohmann::ordered_json;
  Json result;
  result["scans"] = Json::array();
  for (std::size_t s = 0; s < config.scans.size(); ++s) {
    Json pose = Json::array();
    for (int k = 0; k < 16; ++k) pose.push_back(found.poses[s](k / 4, k % 4));
    result["scans"].push_back({{"file", config.scans[s].file.generic_string()}, {"pose", pose}});
  }
  result["first_guess"] = found.guesses.empty() ? "poses" : "features";
  for (const pipeline::FirstGuess& guess : found.guesses)
    result["guesses"].push_back({{"scan", guess.scan}, {"on", guess.on}, {"overlap", guess.overlap}});
  const auto fit = [](const pipeline::PairFit::Fit& f) {
    return Json{{"within_m", f.within_m},
                {"overlap", f.overlap},
                {"residual_m", f.matches > 0 ? Json(f.residual_m) : Json(nullptr)},
                {"matches", f.matches}};
  };
  result["pairs"] = Json::array();
  for (const pipeline::PairFit& pair : found.pairs) {
    result["pairs"].push_back({{"first", pair.first},
                               {"second", pair.second},
                               {"use", to_string(pair.use)},
                               {"before", fit(pair.before)},
                               {"after", fit(pair.after)}});
  }
  return result.dump(2, ' ', false, Json::error_handler_t::replace);
}

// The pairs as the report has them; residual and overlap before and after.
std::string page(const Arguments& arguments, const scene::Config& config, const pipeline::Registration& found) {
  const auto name = [&](std::size_t scan) { return config.scans[scan].file.generic_string(); };
  const auto fit = [](const pipeline::PairFit::Fit& f) {
    return pipeline::ScanPair::Fit{f.within_m, f.overlap, f.residual_m};
  };
  std::vector<std::string> notes;
  for (const pipeline::FirstGuess& guess : found.guesses) notes.push_back(sentence(config, guess) + ".");
  std::vector<pipeline::ScanPair> pairs;
  for (const pipeline::PairFit& pair : found.pairs) {
    pairs.push_back({name(pair.first), name(pair.second), fit(pair.after), pair.use == pipeline::PairFit::Use::used,
                     fit(pair.before)});
  }
  return pipeline::registration_page(fs::path(arguments.config).filename().string(), notes, pairs);
}

int run_register(const Arguments& arguments, const CommonOptions& common) {
  Terminal terminal(common);
  if (!is_config(arguments.config)) {
    throw usage_error("'" + arguments.config + "' is not a configuration",
                      "a CONFIG.yaml with two or more scans; `sparsha new SCAN...` writes a first one");
  }
  if (arguments.resume && arguments.out.empty())
    throw usage_error("--resume keeps results beside the file of --out, and there is none", "--out FILE.yaml");
  check_outputs({{"--out", arguments.out}, {"--report", arguments.report}}, {arguments.config}, {}, arguments.settings);
  const scene::Config config =
      config_from({arguments.config}, arguments.settings, common.trusted(), terminal.progress());
  const fs::path kept = arguments.out.empty() ? fs::path() : hidden_beside(arguments.out, ".pairs");
  std::optional<pipeline::FinishedPairs> finished;
  if (arguments.resume) finished.emplace(kept, program_digest());
  ThreadPool pool(arguments.threads);
  const pipeline::Registration found =
      pipeline::register_scans(config.scans, config.registration.value_or(scene::RegisterConfig{}),
                               {pool, terminal.progress()}, finished ? &*finished : nullptr);
  terminal.progress().finish();
  end_progress_line();
  if (finished && finished->taken() > 0)
    terminal.message(fmt::format("results of pairs taken from a registration that was ended: {}", finished->taken()));
  std::istringstream lines(common.plain ? registration_sentences(config, found) : table(config, found));
  for (std::string line; std::getline(lines, line);) terminal.message(line);  // which is for one line
  const fs::path folder = arguments.out.empty() ? fs::path() : fs::path(arguments.out).parent_path();
  std::string yaml;
  if (!arguments.out.empty() || !common.json)
    yaml = scene::text_with_poses(arguments.config, config, found.poses, folder);
  if (!arguments.out.empty()) write_file(arguments.out, yaml);
  if (!arguments.report.empty()) write_file(arguments.report, page(arguments, config, found));
  finished.reset();
  if (!kept.empty()) pipeline::remove_finished_pairs(kept);
  if (common.json) {
    print(json(config, found));
  } else if (arguments.out.empty()) {
    print(yaml);
  }
  return 0;
}

}  // namespace

void add_register(Command app, const CommonOptions& common, Run& run) {
  auto arguments = std::make_shared<Arguments>();
  Command command = app.add_subcommand("register", "Align scans; writes the configuration with the found poses");
  command.add_option("config", arguments->config, "configuration with two or more scans").required();
  command.add_option("--out,-o", arguments->out, "file for the configuration; default: standard output");
  command.add_option("--report", arguments->report, "page of the scans' graph, overlap and residual before and after");
  command.add_option("--set", arguments->settings, "override a key, e.g. register.voxel_mm=1").collects().takes_one();
  command.add_option("--threads", arguments->threads, "threads; 0 = one a core").check(whole_between(0U, 1024U));
  command.add_flag(
      "--resume", arguments->resume,
      "keep results of pairs beside --out until all poses are found, and go on from those of a registration "
      "that was ended");
  command.callback(
      [arguments, &common, &run] { run = [arguments, &common] { return run_register(*arguments, common); }; });
}

}  // namespace sparsha::app
