// sparsha explore SCENE|CONFIG|SCAN: touch, see and hear.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <chrono>
#include <cmath>
#include <exception>
#include <filesystem>
#include <future>
#include <memory>
#include <optional>
#include <thread>

#include "app/commands.h"
#include "app/device_choice.h"
#include "app/inputs.h"
#include "app/run_summary.h"
#include "app/study.h"
#include "app/terminal.h"
#include "audio/engine.h"
#include "audio/speech/speech.h"
#include "base/error.h"
#include "haptics/session/session.h"
#include "pipeline/build/build.h"
#include "scene/scene_folder.h"
#include "viewer/viewer.h"

namespace sparsha::app {
namespace fs = std::filesystem;

namespace {

struct Arguments {
  std::string scene;
  std::string device = "auto";
  bool headless = false;
  double duration_s = 0.0;
  std::string record;
  std::string screenshot;
  std::string audio_out;
  bool no_texture = false;
  bool no_friction = false;
  bool speech = false;
  bool kiosk = false;
  std::string study;
  std::string firmware;
};

// A new depth scan from another side, on a worker; the finished scene goes to the session.
class Rescan {
 public:
  Rescan(haptics::Session& session, pipeline::Trust trust) : session_(session), trust_(trust) {}
  ~Rescan() {
    if (!result_.valid()) return;
    progress_.cancel();
    result_.wait();
  }
  Rescan(const Rescan&) = delete;
  Rescan& operator=(const Rescan&) = delete;

  void start(const Eigen::Matrix4d& scan_to_grid) {
    if (result_.valid()) {
      session_.announcements().say("A depth scan is already running");
      return;
    }
    if (session_.plays_recording()) {
      session_.announcements().say("No new depth scan while a recording is played");
      return;
    }
    const pipeline::ScenePointer scene = session_.scene();
    pipeline::Config config = scene->description().config;
    std::error_code code;
    for (const pipeline::ScanConfig& scan : config.scans) {
      if (fs::is_regular_file(scan.file, code)) continue;
      session_.announcements().say("No new depth scan: " + scan.file.filename().string() + " is not there any more",
                                   haptics::Announcement::Priority::warning);
      return;
    }
    // What is written of places on the object stays there.
    std::optional<Eigen::Matrix4d>& regions = config.orientation.regions_scan_to_grid;
    if (!regions) regions = config.orientation.scan_to_grid;
    config.orientation.scan_to_grid = scan_to_grid;
    config.grid.bounds_m.reset();
    session_.announcements().say("New depth scan");
    const bool stranger = trust_ == pipeline::Trust::own_folder && !scene->folder().empty();
    result_ = std::async(std::launch::async, [this, config, scene, stranger] {
      if (stranger) pipeline::require_own_scans(scene->description(), scene->folder());
      return pipeline::build_scene(config, {}, progress_).scene;
    });
  }

  // Takes a finished scene to the session.
  void poll() {
    if (!result_.valid() || result_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
    try {
      session_.set_scene(result_.get());
    } catch (const Error& error) {
      session_.announcements().say("No new depth scan: " + error.wrong(), haptics::Announcement::Priority::warning);
    }
  }

 private:
  haptics::Session& session_;
  pipeline::Trust trust_;
  Progress progress_;
  std::future<pipeline::ScenePointer> result_;
};

haptics::falcon::FalconOptions falcon_options(const Arguments& arguments) {
  haptics::falcon::FalconOptions options;
  options.firmware = arguments.firmware;
  options.wait_for_device = arguments.kiosk;  // which starts with the machine, before the exhibit is switched on
  return options;
}

// Remembers the last moment in which the hand felt the stone, so that a picture taken after the run shows the touch.
struct LastTouch {
  haptics::State state;
  bool felt = false;
  void see(const haptics::State& now) {
    const bool feels =
        now.contact == 1 && (now.flags & haptics::kFlagArmed) != 0 && (now.flags & haptics::kFlagFault) == 0;
    if (feels || !felt) state = now;
    felt = felt || feels;
  }
};

void check_output_folder(const std::string& file, const char* option) {
  if (file.empty()) return;
  const fs::path folder = fs::path(file).parent_path();
  std::error_code code;
  if (!folder.empty() && !fs::is_directory(folder, code)) {
    throw usage_error(fmt::format("{} {}: the folder does not exist", option, file), "an existing folder");
  }
  if (fs::is_directory(file, code)) {
    throw usage_error(fmt::format("{} {}: this is a folder", option, file), "the name of a file");
  }
}

void check_arguments(const Arguments& arguments) {
  check_output_folder(arguments.record, "--record");
  check_output_folder(arguments.screenshot, "--screenshot");
  check_output_folder(arguments.audio_out, "--audio-out");
  check_study(arguments.study);
  const std::string playback = "playback:";
  const bool plays = arguments.device.starts_with(playback);
  check_outputs({{"--record", arguments.record},
                 {"--screenshot", arguments.screenshot},
                 {"--audio-out", arguments.audio_out},
                 {"--study", study_file(arguments.study)}},
                arguments.scene, {{"--device", plays ? arguments.device.substr(playback.size()) : ""}});
  if (std::isnan(arguments.duration_s)) throw usage_error("--duration nan", "seconds");
}

// What a run has promised is delivered as far as possible: one output that fails takes no other with it.
class Deliveries {
 public:
  template <class Delivery>
  void attempt(const Delivery& delivery) {
    try {
      delivery();
    } catch (...) {
      if (!failure_) failure_ = std::current_exception();
    }
  }
  /// Throws what failed first.
  void settle() const {
    if (failure_) std::rethrow_exception(failure_);
  }

 private:
  std::exception_ptr failure_;
};

std::unique_ptr<haptics::Session> make_session(const pipeline::ScenePointer& scene, ChosenDevice& chosen,
                                               const Arguments& arguments) {
  haptics::SessionOptions options;
  options.haptics = scene->description().config.haptics;
  options.effects = {!arguments.no_texture, !arguments.no_friction};
  options.record = arguments.record;
  if (chosen.recording) return std::make_unique<haptics::Session>(scene, chosen.recording, options);
  if (chosen.simulated) chosen.device = simulated_hand(scene->description(), arguments.duration_s);
  return std::make_unique<haptics::Session>(scene, std::move(chosen.device), options);
}

// One run: the session, and all that looks on and listens.
class Exploration {
 public:
  Exploration(const Arguments& arguments, const CommonOptions& common, Terminal& terminal, bool window)
      : arguments_(arguments),
        terminal_(terminal),
        chosen_(choose_device(arguments.device, window, falcon_options(arguments))),
        scene_(scene_from(arguments.scene, common.trusted(), terminal.progress())),
        session_(make_session(scene_, chosen_, arguments)),
        rescan_(*session_, common.trusted()) {
    const pipeline::Config& config = scene_->description().config;
    if (config.audio || !arguments.audio_out.empty()) {
      audio::EngineOptions options;
      options.wav = arguments.audio_out;
      options.live = config.audio && !arguments.headless;
      audio_ = std::make_unique<audio::Engine>(scene_, session_->add_contact_consumer(), session_->state(), options);
    }
    if (arguments.speech) {
      speech_.emplace();
      if (!speech_->available()) terminal.message("warning: no speech program is installed (espeak-ng)");
    }
  }

  // Until the device, the user or the clock ends it.
  void run(bool window) {
    began_ = Clock::now();
    session_->start();
    if (audio_) audio_->start();
    if (window) return run_window();
    while (!over()) {
      poll();
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }

  void deliver(const CommonOptions& common) {
    Deliveries deliveries;
    deliveries.attempt([&] { session_->stop(); });
    const haptics::SessionSummary summary = session_->stop();
    if (audio_) deliveries.attempt([&] { audio_->stop(); });
    if (!arguments_.screenshot.empty()) {
      deliveries.attempt([&] {
        viewer::write_screenshot(session_->scene(), touch_.state, scene_->description().config.viewer,
                                 arguments_.screenshot);
      });
    }
    if (!arguments_.study.empty()) {
      deliveries.attempt([&] { append_study(arguments_.study, summary, ask_realism()); });
    }
    const std::uint64_t strikes = audio_ ? audio_->strikes() : 0;
    print(common.json ? summary_json(summary, strikes) : summary_text(summary, strikes));
    deliveries.settle();
  }

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] bool over() const {
    const std::chrono::duration<double> elapsed = Clock::now() - began_;
    return interrupted() || session_->finished() ||
           (arguments_.duration_s > 0.0 && elapsed.count() >= arguments_.duration_s);
  }

  void poll() {
    session_->poll();
    if (audio_ && audio_->warning() != audio_warning_) {  // the sound device is looked for in the background
      audio_warning_ = audio_->warning();
      terminal_.message("warning: " + audio_warning_);
    }
    rescan_.poll();
    touch_.see(session_->state().read());
    for (const haptics::Announcement& announcement : session_->announcements().since(heard_)) {
      heard_ = announcement.sequence;
      if (speech_) speech_->say(announcement);
      if (announcement.priority != haptics::Announcement::Priority::information) {
        terminal_.message("warning: " + announcement.text);
      }
    }
  }

  void run_window() {
    viewer::Connections connections;
    connections.state = &session_->state();
    connections.requests = &session_->requests();
    connections.announcements = &session_->announcements();
    connections.pointer = chosen_.pointer;
    connections.poll = [this] { poll(); };
    connections.finished = [this] { return over(); };
    connections.scene = [this] { return session_->scene(); };
    connections.speak = [this](const std::string& text) { session_->announcements().say(text); };
    connections.rescan = [this](const Eigen::Matrix4d& scan_to_grid) { rescan_.start(scan_to_grid); };
    viewer::ViewerOptions options;
    options.kiosk = arguments_.kiosk;
    viewer::run_window(connections, options);
  }

  const Arguments& arguments_;
  Terminal& terminal_;
  ChosenDevice chosen_;
  pipeline::ScenePointer scene_;
  std::unique_ptr<haptics::Session> session_;
  std::unique_ptr<audio::Engine> audio_;
  std::optional<audio::Speech> speech_;
  Rescan rescan_;
  LastTouch touch_;
  std::uint64_t heard_ = 0;
  std::string audio_warning_;
  Clock::time_point began_;
};

int run_explore(const Arguments& arguments, const CommonOptions& common) {
  check_arguments(arguments);
  Terminal terminal(common);
  const bool window = !arguments.headless && viewer::display_available();
  if (!arguments.headless && !window && arguments.device != "auto") {
    terminal.message("no display: running without a window");
  }
  Exploration exploration(arguments, common, terminal, window);
  exploration.run(window);
  exploration.deliver(common);
  return 0;
}

}  // namespace

void add_explore(CLI::App& app, const CommonOptions& common, Run& run) {
  auto arguments = std::make_shared<Arguments>();
  CLI::App* command = app.add_subcommand("explore", "Touch, see and hear a scene");
  command->add_option("scene", arguments->scene, "scene folder, configuration or scan")->required();
  command->add_option("--device", arguments->device, "auto | falcon | pointer | simulated | playback:FILE")
      ->capture_default_str();
  command->add_flag("--headless", arguments->headless, "no window");
  command->add_option("--duration", arguments->duration_s, "seconds; default: until stopped")
      ->check(CLI::Range(0.001, 1e7));
  command->add_option("--firmware", arguments->firmware,
                      "firmware image for a Falcon that runs none; default: SPARSHA_FALCON_FIRMWARE, "
                      "~/.config/sparsha/falcon.bin");
  command->add_option("--record", arguments->record, "run.csv, one row per tick");
  command->add_option("--screenshot", arguments->screenshot, "view.png, 1280x720, the last touch of the run");
  command->add_option("--audio-out", arguments->audio_out, "run.wav, its start is t_s = 0");
  command->add_flag("--no-texture", arguments->no_texture, "render the envelope, without surface effects");
  command->add_flag("--no-friction", arguments->no_friction, "render without friction");
  command->add_flag("--speech", arguments->speech, "speak announcements");
  command->add_flag("--kiosk", arguments->kiosk, "full screen, for exhibitions");
  command->add_option("--study", arguments->study, "append the session and the visitor's rating to NAME.csv");
  command->callback(
      [arguments, &common, &run] { run = [arguments, &common] { return run_explore(*arguments, common); }; });
}

}  // namespace sparsha::app
