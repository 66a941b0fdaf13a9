// bench_realtime: `sparsha explore` at 1 kHz with a window (software GL) and sound and without either, in turns, and a
// bare loop that only sleeps in the same minutes. Writes realtime.csv, realtime_histogram.csv and realtime.svg.
#include <algorithm>
#include <array>
#include <cctype>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "audio/speech/child_process.h"
#include "base/error.h"
#include "base/system.h"
#include "bench/haptics/lines.h"
#include "bench/realtime/bare_loop.h"

namespace sparsha::bench {
namespace {

namespace fs = std::filesystem;
using audio::ChildProcess;

/// What a state of the machine did to one loop, over all of its turns.
struct Total {
  std::string state;  ///< loop alone | window and sound
  std::string loop;   ///< sparsha | bare
  Lateness lateness;
  double seconds = 0.0;
  double tick_p50_ns = 0.0, tick_p99_ns = 0.0, tick_max_ns = 0.0;  ///< largest of the turns; 0: it has none
};

void add(Lateness& sum, const Lateness& more) {
  for (std::size_t bin = 0; bin < kLateBins; ++bin) sum.bins[bin] += more.bins[bin];
  sum.ticks += more.ticks;
  sum.missed += more.missed;
  sum.longest_ns = std::max(sum.longest_ns, more.longest_ns);
  sum.real_time = more.real_time;
}

/// The relief's configuration with paths that do not depend on where it lies; without sound where asked.
void write_config(const fs::path& file, bool sound) {
  std::ifstream source(fs::path(SPARSHA_SOURCE_DIR) / "configs" / "relief.yaml");
  std::ofstream yaml(file);
  bool in_audio = false;
  for (std::string line; std::getline(source, line);) {
    if (!line.empty() && std::isalpha(static_cast<unsigned char>(line[0])) != 0)
      in_audio = line.rfind("audio:", 0) == 0;
    if (in_audio && !sound) continue;
    for (std::size_t at = line.find("../data/"); at != std::string::npos; at = line.find("../data/"))
      line.replace(at, 3, std::string(SPARSHA_SOURCE_DIR) + "/");
    yaml << line << '\n';
  }
}

/// Runs to its end; nothing when it did not start.
std::optional<std::string> output_of(const fs::path& program, const std::vector<std::string>& arguments) {
  const auto child = ChildProcess::start(program, arguments, "", ChildProcess::Output::keep);
  if (!child) return std::nullopt;
  while (child->running()) std::this_thread::sleep_for(std::chrono::milliseconds(100));
  return child->output();
}

/// A JACK server on its dummy driver under a name of its own, so that sound plays without a sound card.
class SoundServer {
 public:
  SoundServer() {
    const auto program = audio::find_program({"jackd"});
    if (!program) return;
    const std::string name = "sparsha-bench-" + std::to_string(system::process_id());
    setenv("JACK_DEFAULT_SERVER", name.c_str(), 1);
    setenv("JACK_NO_AUDIO_RESERVATION", "1", 1);
    process_ =
        ChildProcess::start(*program, {"--no-realtime", "--name", name, "-d", "dummy", "-r", "48000", "-p", "128"}, "");
    std::this_thread::sleep_for(std::chrono::seconds(1));
  }
  ~SoundServer() {
    if (process_) process_->end(3000);
  }
  SoundServer(const SoundServer&) = delete;
  SoundServer& operator=(const SoundServer&) = delete;
  [[nodiscard]] bool running() { return process_ && process_->running(); }

 private:
  std::unique_ptr<ChildProcess> process_;
};

void add_run(Total& total, const nlohmann::json& run) {
  Lateness late;
  const auto& bins = run.at("lateness_histogram_100us");
  for (std::size_t bin = 0; bin < std::min(kLateBins, bins.size()); ++bin)
    late.bins[bin] = bins[bin].get<std::uint64_t>();
  late.ticks = run.at("ticks").get<std::uint64_t>();
  late.longest_ns = static_cast<std::int64_t>(run.at("late_ns_max").get<double>());
  late.missed = run.at("missed_ticks").get<std::uint64_t>();
  late.real_time = run.at("real_time").get<bool>();
  add(total.lateness, late);
  total.seconds += run.at("duration_s").get<double>();
  const auto& ns = run.at("tick_ns");
  total.tick_p50_ns = std::max(total.tick_p50_ns, ns.at("p50").get<double>());
  total.tick_p99_ns = std::max(total.tick_p99_ns, ns.at("p99").get<double>());
  total.tick_max_ns = std::max(total.tick_max_ns, ns.at("max").get<double>());
}

/// One turn: the explorer and the bare loop beside it. Throws Error{failure} with what the program said.
void take_turn(const fs::path& program, const fs::path& scene, bool window, double seconds, Total& ours, Total& bare) {
  std::vector<std::string> words{"explore",    scene.string(),          "--device", "simulated",
                                 "--duration", std::to_string(seconds), "--json",   "--quiet"};
  fs::path first = program;
  if (window) {
    words.insert(words.begin(), {"-a", "-s", "-screen 0 1280x720x24", program.string()});
    first = *audio::find_program({"xvfb-run"});
  } else {
    words.emplace_back("--headless");
  }
  BareLoop loop;
  const std::optional<std::string> said = output_of(first, words);
  const Lateness late = loop.stop();
  const std::size_t brace = said ? said->find('{') : std::string::npos;
  const auto run =
      brace == std::string::npos ? nlohmann::json() : nlohmann::json::parse(said->substr(brace), nullptr, false);
  if (!run.is_object() || !run.contains("lateness_histogram_100us"))
    throw Error(ErrorKind::failure, {}, "sparsha explore gave no summary: " + said.value_or("it did not start"));
  add_run(ours, run);
  add(bare.lateness, late);
  bare.seconds += static_cast<double>(late.ticks + late.missed) * 1e-3;
}

bool write(const fs::path& out, const std::vector<Total>& totals) {
  std::ofstream csv(out / "realtime.csv"), histogram(out / "realtime_histogram.csv");
  csv << "method,state,seconds,ticks,missed,share_in_time,later_1ms,longest_late_us,real_time,tick_p50_ns,tick_p99_ns,"
         "tick_max_ns\n";
  histogram << "method,state,late_from_us,ticks,share\n";
  constexpr std::array<const char*, 4> kColours = {"#0072B2", "#56B4E9", "#D55E00", "#E69F00"};
  Panel panel;
  panel.y_label = "log10 of the share of ticks later than that";
  panel.x_to = 1.9;
  for (std::size_t k = 0; k < totals.size(); ++k) {
    const Total& t = totals[k];
    std::uint64_t later = 0;
    for (std::size_t bin = 10; bin < kLateBins; ++bin) later += t.lateness.bins[bin];
    const double all = static_cast<double>(std::max<std::uint64_t>(1, t.lateness.ticks));
    csv << t.loop << ',' << t.state << ',' << t.seconds << ',' << t.lateness.ticks << ',' << t.lateness.missed << ','
        << t.lateness.in_time() << ',' << later << ',';
    if (t.lateness.longest_ns > 0) csv << 1e-3 * static_cast<double>(t.lateness.longest_ns);
    csv << ',' << (t.lateness.real_time ? "yes" : "no") << ',';
    if (t.tick_p50_ns > 0.0)
      csv << t.tick_p50_ns << ',' << t.tick_p99_ns << ',' << t.tick_max_ns << '\n';
    else
      csv << ",,\n";
    Curve curve{t.loop + ", " + t.state, kColours[k % kColours.size()], t.loop == "bare" ? "6 4" : "", {}, {}};
    std::uint64_t beyond = t.lateness.ticks;
    for (std::size_t bin = 0; bin < kLateBins; ++bin) {
      histogram << t.loop << ',' << t.state << ',' << 100 * bin << ',' << t.lateness.bins[bin] << ','
                << static_cast<double>(t.lateness.bins[bin]) / all << '\n';
      curve.x.push_back(0.1 * static_cast<double>(bin));
      curve.y.push_back(std::log10(std::max(static_cast<double>(beyond), 0.5) / all));
      beyond -= std::min(beyond, t.lateness.bins[bin]);
    }
    panel.curves.push_back(curve);
    std::printf("%-8s %-16s %8.1f s %9llu ticks, %.4f %% in time, %llu later than 1 ms, real-time priority %s\n",
                t.loop.c_str(), t.state.c_str(), t.seconds, static_cast<unsigned long long>(t.lateness.ticks),
                100.0 * t.lateness.in_time(), static_cast<unsigned long long>(later),
                t.lateness.real_time ? "granted" : "refused");
  }
  return csv.flush() && histogram.flush() &&
         write_lines(out / "realtime.svg", "How late ticks of 1 kHz begin", "late by more than, ms", {panel});
}

/// `seconds` of touch altogether, in an even number of turns.
bool run(const fs::path& program, const fs::path& out, double seconds, int turns) {
  const fs::path work = out / "bench_realtime-scenes";
  fs::create_directories(work);
  for (const bool sound : {false, true}) {
    const fs::path yaml = work / (sound ? "sound.yaml" : "mute.yaml");
    write_config(yaml, sound);
    const auto said =
        output_of(program, {"build", yaml.string(), "--out", (work / (sound ? "sound" : "mute")).string(), "--quiet"});
    if (!fs::exists(work / (sound ? "sound" : "mute") / "scene.yaml"))
      throw Error(ErrorKind::failure, {}, "the scene was not built: " + said.value_or(""));
  }
  setenv("LIBGL_ALWAYS_SOFTWARE", "1", 1);
  const bool has_window = audio::find_program({"xvfb-run"}).has_value() && audio::find_program({"Xvfb"}).has_value();
  const std::string full = has_window ? "window and sound" : "sound, no window: Xvfb is missing";
  std::vector<Total> totals{{"loop alone", "sparsha", {}, 0, 0, 0, 0},
                            {"loop alone", "bare", {}, 0, 0, 0, 0},
                            {full, "sparsha", {}, 0, 0, 0, 0},
                            {full, "bare", {}, 0, 0, 0, 0}};
  for (int turn = 0; turn < turns; ++turn) {
    const bool on = turn % 2 == 1;
    std::unique_ptr<SoundServer> sound;
    if (on) sound = std::make_unique<SoundServer>();
    if (on && !sound->running()) std::puts("no sound server (jackd): the engine runs without a stream");
    take_turn(program, work / (on ? "sound" : "mute"), on && has_window, seconds / turns, totals[on ? 2 : 0],
              totals[on ? 3 : 1]);
  }
  fs::remove_all(work);
  return write(out, totals);
}

}  // namespace
}  // namespace sparsha::bench

int main(int argc, char** argv) {
  namespace fs = std::filesystem;
  fs::path out = ".", program = fs::path(argv[0]).parent_path() / "sparsha";
  double seconds = 16.0;
  int turns = 4;
  for (int k = 1; k < argc; k += 2) {
    const bool value = k + 1 < argc;
    if (value && std::strcmp(argv[k], "--mode") == 0) {
      const bool full = std::strcmp(argv[k + 1], "full") == 0;
      seconds = full ? 600.0 : 16.0;
      turns = full ? 20 : 4;
    } else if (value && std::strcmp(argv[k], "--seconds") == 0) {
      seconds = std::atof(argv[k + 1]);
    } else if (value && std::strcmp(argv[k], "--out") == 0) {
      out = argv[k + 1];
    } else if (value && std::strcmp(argv[k], "--program") == 0) {
      program = argv[k + 1];
    } else {
      std::fputs("usage: bench_realtime [--mode quick|full] [--seconds S] [--out DIR] [--program PATH]\n", stderr);
      return 2;
    }
  }
  try {
    fs::create_directories(out);
    return sparsha::bench::run(fs::absolute(program), fs::absolute(out), seconds, turns) ? 0 : 1;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
