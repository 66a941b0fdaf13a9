// sparsha explore SCENE|CONFIG|SCAN: touch, see and hear.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <filesystem>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "app/commands.h"
#include "app/depth_scans.h"
#include "app/device_choice.h"
#include "app/inputs.h"
#include "app/printable.h"
#include "app/run_summary.h"
#include "app/sentences.h"
#include "app/speaker.h"
#include "app/study.h"
#include "app/terminal.h"
#include "app/terminal_keys.h"
#include "audio/engine.h"
#include "audio/live_stream.h"
#include "base/error.h"
#include "base/phrases.h"
#include "base/system_terminal.h"
#include "haptics/session/session.h"
#include "pipeline/build/build.h"
#include "scene/scene_folder.h"
#include "viewer/viewer.h"

namespace sparsha::app {
namespace fs = std::filesystem;

namespace {

struct Arguments {
  std::vector<std::string> scene;  ///< a scene, a configuration, or scans
  std::string device = "auto";
  bool headless = false;
  double duration_s = 0.0;
  std::string record;
  std::string screenshot;
  std::string audio_out;
  std::string audio_device;
  bool list_audio = false;
  bool no_texture = false;
  bool no_friction = false;
  bool speech = false;
  std::string language;
  bool kiosk = false;
  std::string scenes;
  bool direct = false;
  std::string study;
  std::string firmware;
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
  if (arguments.scene.empty() == arguments.scenes.empty())
    throw usage_error(arguments.scene.empty() ? "nothing to explore" : "--scenes and a scene",
                      "a scene, a configuration or scans; or --kiosk --scenes DIR");
  if (!arguments.scenes.empty() && (!arguments.kiosk || arguments.device.starts_with("playback:")))
    throw usage_error("--scenes without an exhibition", "--kiosk --scenes DIR, and a device for a hand");
  check_output_folder(arguments.record, "--record");
  check_output_folder(arguments.screenshot, "--screenshot");
  check_output_folder(arguments.audio_out, "--audio-out");
  check_study(arguments.study);
  const std::string playback = "playback:";
  const bool plays = arguments.device.starts_with(playback);
  std::vector<NamedPath> inputs{{"--device", plays ? arguments.device.substr(playback.size()) : ""}};
  for (const std::string& scan : arguments.scene) inputs.push_back({"the input", scan});
  check_outputs({{"--record", arguments.record},
                 {"--screenshot", arguments.screenshot},
                 {"--audio-out", arguments.audio_out},
                 {"--study", study_file(arguments.study)}},
                arguments.scene.empty() ? arguments.scenes : arguments.scene.front(), inputs);
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

// The scene's, or what the command line says instead; `scene` may be null.
pipeline::SpeechConfig speech_of(const Arguments& arguments, const pipeline::Scene* scene) {
  pipeline::SpeechConfig speech;
  if (scene != nullptr && scene->description().config.speech) speech = *scene->description().config.speech;
  if (!arguments.language.empty() && arguments.language != speech.language) {
    speech.language = arguments.language;
    speech.voice.clear();  // of the other language
  }
  return speech;
}

bool speaks(const Arguments& arguments, const pipeline::Scene* scene) {
  return arguments.speech || (scene != nullptr && scene->description().config.speech.has_value());
}

std::unique_ptr<haptics::Session> make_session(const pipeline::ScenePointer& scene, ChosenDevice& chosen,
                                               const Arguments& arguments) {
  haptics::SessionOptions options;
  const pipeline::SpeechConfig speech = speech_of(arguments, scene.get());
  options.language = speech.language;
  options.speaks = speaks(arguments, scene.get());
  options.haptics = scene->description().config.haptics;
  options.effects = {!arguments.no_texture, !arguments.no_friction};
  options.record = arguments.record;
  if (chosen.recording) return std::make_unique<haptics::Session>(scene, chosen.recording, options);
  if (chosen.simulated) chosen.device = simulated_hand(scene->description(), arguments.duration_s);
  return std::make_unique<haptics::Session>(scene, std::move(chosen.device), options);
}

// True where a person at a window turns the object before anything is built.
bool starts_with_scans(const Arguments& arguments, bool window) {
  const bool person = arguments.device == "auto" || arguments.device == "falcon" || arguments.device == "pointer";
  if (!window || !person || arguments.direct || arguments.kiosk || arguments.duration_s > 0.0) return false;
  std::error_code code;
  return std::ranges::all_of(arguments.scene, [&](const std::string& argument) {
    return !is_config(argument) && !fs::is_directory(argument, code);
  });
}

// The folders in DIR that hold scenes, by name. Throws Error{input} when there is none.
std::vector<fs::path> scenes_in(const std::string& folder, pipeline::Trust trust, const Terminal& terminal) {
  std::vector<fs::path> found;
  std::error_code code;
  for (fs::directory_iterator entry(folder, code); !code && entry != fs::directory_iterator(); entry.increment(code)) {
    if (!fs::is_regular_file(entry->path() / "scene.yaml", code)) continue;
    try {
      static_cast<void>(pipeline::open_scene(entry->path(), trust));
      found.push_back(entry->path());
    } catch (const Error& error) {
      terminal.message(std::string("warning: left out of the exhibition: ") + error.what());
    }
  }
  if (found.empty()) throw input_error(folder, "there is no scene in this folder", "a folder of scene folders");
  std::ranges::sort(found);
  return found;
}

// One run: the session, and all that looks on and listens.
class Exploration {
 public:
  Exploration(const Arguments& arguments, const CommonOptions& common, Terminal& terminal, bool window)
      : arguments_(arguments),
        terminal_(terminal),
        trust_(common.trusted()),
        exhibits_(arguments.scenes.empty() ? std::vector<fs::path>()
                                           : scenes_in(arguments.scenes, common.trusted(), terminal)),
        chosen_(choose_device(arguments.device, window, falcon_options(arguments))) {
    if (starts_with_scans(arguments, window)) {
      scans_ = std::make_unique<DepthScans>(std::vector<fs::path>(arguments.scene.begin(), arguments.scene.end()));
      if (const std::string why = scans_->unavailable(); !why.empty())
        throw input_error(arguments.scene.front(), "no such file", "a scene folder, a configuration or scans");
    } else if (!exhibits_.empty()) {
      pipeline::ScenePointer scene = pipeline::open_scene(exhibits_.front(), trust_);
      scans_ = std::make_unique<DepthScans>(scene, fs::path(), trust_);
      make_session_of(std::move(scene));
    } else {
      pipeline::ScenePointer scene = scene_from(arguments.scene, common.trusted(), terminal.progress());
      const std::string& first = arguments.scene.front();
      const bool config = is_config(first) && scene->folder().empty();
      scans_ = std::make_unique<DepthScans>(scene, config ? fs::path(first) : fs::path(), common.trusted());
      make_session_of(std::move(scene));
    }
    speaker_.emplace(speech_of(arguments, scene_.get()), speaks(arguments, scene_.get()),
                     [this](const std::vector<float>& words, double rate_hz) {
                       const std::lock_guard lock(sound_mutex_);
                       return audio_ && audio_->speak(words, rate_hz);
                     });
    tell_of_speech();
  }

  // Until the device, the user or the clock ends it.
  void run(bool window) {
    began_ = Clock::now();
    start();
    if (window) return run_windows();
    keys_.emplace();
    while (!over()) wait_headless();
    keys_.reset();  // the rating of a study is typed as a line
  }

  void deliver(const CommonOptions& common) {
    if (!session_) return deliver_nothing();
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
    print(common.json    ? summary_json(summary, strikes)
          : common.plain ? summary_sentences(summary, strikes)
                         : summary_text(summary, strikes));
    deliveries.settle();
  }

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] bool over() const {
    const std::chrono::duration<double> elapsed = Clock::now() - began_;
    return interrupted() || (session_ && session_->finished()) ||
           (arguments_.duration_s > 0.0 && elapsed.count() >= arguments_.duration_s);
  }

  // `needs_sound`: a scene whose sounds cannot be read is an error; else it is touched without them.
  void make_session_of(pipeline::ScenePointer scene, bool needs_sound = true) {
    scene_ = std::move(scene);
    scene_work_ = scans_->status().work;
    session_ = make_session(scene_, chosen_, arguments_);
    contacts_ = session_->add_contact_consumer();  // also where only a later scene sounds
    if (!scene_->description().config.audio && arguments_.audio_out.empty()) return;
    try {
      set_sound(sound_of(scene_));
    } catch (const Error& error) {
      if (needs_sound || !arguments_.audio_out.empty()) throw;
      warn("no_sound", {{"reason", error.wrong()}});
    }
  }

  std::unique_ptr<audio::Engine> sound_of(const pipeline::ScenePointer& scene) {
    audio::EngineOptions options;
    options.wav = arguments_.audio_out;
    options.live = scene->description().config.audio.has_value();
    options.device = arguments_.audio_device;
    return std::make_unique<audio::Engine>(scene, contacts_, session_->state(), options);
  }
  // The thread that speaks may look at the engine at any time.
  void set_sound(std::unique_ptr<audio::Engine> engine) {
    const std::lock_guard lock(sound_mutex_);
    audio_ = std::move(engine);
  }

  void wait_headless() {
    use_keys();
    poll();
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  }

  void use_keys() {
    if (!session_ || !keys_ || !keys_->active()) return;
    const std::chrono::duration<double> now = Clock::now() - began_;
    for (const haptics::Request& request : meanings_.take(keys_->read(), now.count()))
      session_->requests().post(request);
  }

  // Another scene under the same hand. Its sounds take the place of the present ones; a sound file goes on with those
  // that it began with.
  void change_scene(const pipeline::ScenePointer& scene) {
    const bool changes_sound = arguments_.audio_out.empty();
    std::unique_ptr<audio::Engine> sound;
    if (changes_sound && scene->description().config.audio) sound = sound_of(scene);  // or nothing changes
    session_->set_scene(scene);
    before_ = std::exchange(scene_, scene);
    const double stiffness = scene->description().config.haptics.stiffness_n_per_m;
    if (stiffness != before_->description().config.haptics.stiffness_n_per_m)
      session_->requests().post({haptics::Request::Kind::set_stiffness, stiffness});
    if (!changes_sound) return;
    set_sound(nullptr);
    haptics::ContactEvent earlier;
    while (contacts_->pop(earlier)) {
      // What was touched before is not heard now.
    }
    set_sound(std::move(sound));
    if (audio_) audio_->start();
  }

  // The window cannot show the new scene: the one before comes back.
  void refuse(const std::string& why) {
    try {
      if (const pipeline::ScenePointer before = std::exchange(before_, nullptr)) change_scene(before);
    } catch (const Error&) {
      // Its sounds cannot be read any more: the new scene is touched and the old picture shown.
    }
    before_ = nullptr;  // it is not refused in its turn
    warn("cannot_open", {{"reason", why}});
  }

  void next_scene(int step) {
    const auto count = static_cast<int>(exhibits_.size());
    exhibit_ = (exhibit_ + step + count) % count;
    const fs::path& folder = exhibits_[static_cast<std::size_t>(exhibit_)];
    try {
      change_scene(pipeline::open_scene(folder, trust_));
      session_->announcements().say(folder.filename().string());
    } catch (const Error& error) {
      announce("cannot_open", {{"reason", error.wrong()}}, haptics::Announcement::Priority::warning);
    }
  }

  // To whoever looks at the terminal, in its language, and to the visitor.
  void warn(Phrase phrase, const PhraseValues& values = {}) {
    terminal_.message(Phrases::of("en").text(phrase, values));
    if (session_) announce(phrase, values, haptics::Announcement::Priority::warning);
  }

  // A scene is opened, a configuration or scans are shown to be turned.
  void drop(const std::vector<fs::path>& files) {
    std::error_code code;
    if (files.empty()) return;
    if (session_ && session_->plays_recording()) return warn("not_while_played");
    fs::path first = files.front();
    if (first.filename() == "scene.yaml") first = first.parent_path();
    try {
      const auto is_one = [&](const fs::path& file) { return fs::is_directory(file, code) || is_config(file); };
      if (files.size() > 1 && std::ranges::any_of(files, is_one)) return warn("one_at_once");
      if (fs::is_directory(first, code)) {
        pipeline::ScenePointer scene = pipeline::open_scene(first, trust_);
        auto scans = std::make_unique<DepthScans>(scene, fs::path(), trust_);
        if (session_) {
          change_scene(scene);
        } else {
          scans_ = std::move(scans);
          make_session_of(std::move(scene), false);
          start();
          connect_session();
          return;
        }
        scans_ = std::move(scans);
        scene_work_ = scans_->status().work;
        return;
      }
      scans_ = is_config(first) ? std::make_unique<DepthScans>(first) : std::make_unique<DepthScans>(files);
      to_scans_ = true;
    } catch (const Error& error) {
      warn("cannot_open", {{"reason", error.what()}});
    }
  }

  void start() {
    if (!session_) return;
    session_->start();
    if (audio_) audio_->start();
  }

  // The window was closed before a depth scan was made.
  void deliver_nothing() const {
    const viewer::OrientingStatus status = scans_->status();
    if (!status.points && status.problem) throw Error(ErrorKind::input, {}, status.note);
    const bool promised = !arguments_.record.empty() || !arguments_.screenshot.empty() ||
                          !arguments_.audio_out.empty() || !arguments_.study.empty();
    if (promised)
      throw Error(ErrorKind::failure, {}, "no depth scan was made, so that there is nothing to write",
                  "Enter in the window, or --direct");
  }

  // A finished depth scan goes to the session, the first one begins it.
  void take_scan() {
    const pipeline::ScenePointer scene = scans_->take_scene();
    if (!scene) return;
    const bool other_object = scans_->status().work != scene_work_;
    try {
      if (!session_) {
        make_session_of(scene, false);
        start();
        connect_session();
      } else if (other_object) {
        change_scene(scene);
        scene_work_ = scans_->status().work;
      } else {
        session_->set_scene(scene);
        before_ = std::exchange(scene_, scene);
        if (audio_) audio_->set_scene(scene);
      }
    } catch (const Error& error) {
      if (!session_) throw;
      warn("cannot_open", {{"reason", error.wrong()}});
    }
  }

  // A new depth scan from the side that is looked at.
  void rescan(const Eigen::Matrix4d& scan_to_grid) {
    using Priority = haptics::Announcement::Priority;
    if (session_->plays_recording()) return announce("no_scan_while_played");
    if (scans_->status().busy) return announce("scan_running");
    if (const std::string why = scans_->unavailable(); !why.empty())
      return announce("no_new_scan", {{"reason", why}}, Priority::warning);
    if (scans_->status().work != scene_work_)
      return announce("no_new_scan", {{"reason", "other scans are open"}}, Priority::warning);
    announce("new_scan");
    scans_->scan(scans_->setup_from(scan_to_grid));
  }

  void tell_of_speech() {
    if (told_of_speech_ || speaker_->available()) return;
    told_of_speech_ = true;
    terminal_.message("warning: no speech program is installed (espeak-ng)");
  }

  void announce(Phrase phrase, const PhraseValues& values = {},
                haptics::Announcement::Priority priority = haptics::Announcement::Priority::information) {
    session_->announcements().say(session_->phrases().text(phrase, values), priority);
  }

  void tell_of_scans() {
    const viewer::OrientingStatus status = scans_->status();
    for (const std::string& warning : scans_->take_warnings()) terminal_.message("warning: " + warning);
    if (status.notes == notes_ && status.work == work_) return;
    const bool news = status.notes > 0;
    notes_ = status.notes;
    work_ = status.work;
    if (!news) return;
    if (status.problem && !session_) terminal_.message(status.note);  // else poll() prints what is announced
    if (session_)
      session_->announcements().say(status.note, status.problem ? haptics::Announcement::Priority::warning
                                                                : haptics::Announcement::Priority::information);
  }

  void poll() {
    take_scan();
    tell_of_scans();
    if (!session_) return;
    session_->poll();
    if (audio_ && audio_->warning() != audio_warning_) {  // the sound device is looked for in the background
      audio_warning_ = audio_->warning();
      if (!audio_warning_.empty()) terminal_.message("warning: " + audio_warning_);
    }
    touch_.see(session_->state().read());
    for (const haptics::Announcement& announcement : session_->announcements().since(heard_)) {
      heard_ = announcement.sequence;
      speaker_->hear(announcement);
      tell_of_speech();
      if (announcement.priority != haptics::Announcement::Priority::information) {
        terminal_.message("warning: " + announcement.text);
      } else if (keys_ && keys_->active()) {
        terminal_.message(announcement.text);  // for a braille display
      }
    }
  }

  void connect_session() {
    connections_.state = &session_->state();
    connections_.requests = &session_->requests();
    connections_.announcements = &session_->announcements();
    connections_.speak = [this](const std::string& text) { session_->announcements().say(text); };
    connections_.rescan = [this](const Eigen::Matrix4d& scan_to_grid) { rescan(scan_to_grid); };
  }

  // A window that loses its display leaves the hand, the sound and the recording alone, and comes back with it.
  void run_windows() {
    for (viewer::WindowEnd end = run_window(); end == viewer::WindowEnd::display_lost; end = run_window(true)) {
      terminal_.message("warning: the display is gone; the hand goes on without a window");
      constexpr auto kLook = std::chrono::seconds(2);
      for (auto next = Clock::now() + kLook; !over(); wait_headless()) {
        if (Clock::now() < next) continue;
        next = Clock::now() + kLook;
        if (viewer::display_available()) break;
      }
      if (over()) return;
      terminal_.message("the display is back");
    }
  }

  // `again`: a display that answered a moment ago may be gone again.
  viewer::WindowEnd run_window(bool again = false) {
    if (session_) connect_session();
    connections_.pointer = chosen_.pointer;
    connections_.poll = [this] { poll(); };
    connections_.finished = [this] { return over(); };
    connections_.scene = [this] { return session_ ? session_->scene() : nullptr; };
    connections_.orienting = orienting_of([this]() -> DepthScans& { return *scans_; });
    connections_.to_scans = [this] { return std::exchange(to_scans_, false); };
    if (!arguments_.kiosk) connections_.drop = [this](const std::vector<fs::path>& files) { drop(files); };
    if (session_ && session_->plays_recording())
      connections_.orienting.unavailable = [] { return std::string("a recording is played"); };
    viewer::ViewerOptions options;
    options.kiosk = arguments_.kiosk;
    options.opens_again = again;
    connections_.refuse = [this](const std::string& why) { refuse(why); };
    if (exhibits_.size() > 1) connections_.next_scene = [this](int step) { next_scene(step); };
    return viewer::run_window(connections_, options);
  }

  const Arguments& arguments_;
  Terminal& terminal_;
  pipeline::Trust trust_;
  std::vector<fs::path> exhibits_;  ///< of a kiosk with several scenes
  int exhibit_ = 0;
  ChosenDevice chosen_;
  pipeline::ScenePointer scene_;
  pipeline::ScenePointer before_;  ///< the scene that was touched before
  std::uint64_t scene_work_ = 0;   ///< the scans that scene_ was made from
  std::unique_ptr<haptics::Session> session_;
  std::shared_ptr<haptics::ContactQueue> contacts_;
  std::unique_ptr<audio::Engine> audio_;
  std::mutex sound_mutex_;  // of audio_, which the thread that speaks uses
  std::optional<Speaker> speaker_;
  bool told_of_speech_ = false;
  std::optional<system::TerminalInput> keys_;  ///< without a window
  TerminalKeys meanings_;
  std::unique_ptr<DepthScans> scans_;
  viewer::Connections connections_;
  std::uint64_t notes_ = 0, work_ = 0;
  bool to_scans_ = false;
  LastTouch touch_;
  std::uint64_t heard_ = 0;
  std::string audio_warning_;
  Clock::time_point began_;
};

// One line per device that can play.
int list_audio() {
  std::string text;
  for (const audio::OutputDevice& device : audio::output_devices()) {
    text +=
        fmt::format("{:>3}{} {} ({}): {} channels, {:.0f} Hz, {:.1f} ms\n", device.number, device.chosen ? '*' : ' ',
                    printable(device.name), device.system, device.channels, device.rate_hz, 1000.0 * device.latency_s);
  }
  print(text.empty() ? "no sound device\n" : text);
  return 0;
}

int run_explore(const Arguments& arguments, const CommonOptions& common) {
  if (arguments.list_audio) return list_audio();
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
  command->add_option("scene", arguments->scene, "scene folder, configuration or scans")->expected(1, -1);
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
  command->add_option("--audio-device", arguments->audio_device,
                      "what plays the sound: a number or a part of a name; default: JACK, else the system's");
  command->add_flag("--list-audio", arguments->list_audio, "list what can play, and end");
  command->add_flag("--no-texture", arguments->no_texture, "render the envelope, without surface effects");
  command->add_flag("--no-friction", arguments->no_friction, "render without friction");
  command->add_flag("--speech", arguments->speech, "speak announcements");
  command->add_option("--language", arguments->language, "of announcements and speech; default: the scene's, else en")
      ->check(CLI::IsMember(Phrases::languages()));
  command->add_flag("--kiosk", arguments->kiosk, "full screen, for exhibitions");
  command->add_option("--scenes", arguments->scenes, "with --kiosk: a folder of scenes that visitors choose from");
  command->add_flag("--direct", arguments->direct, "build scans at once, without turning the object first");
  command->add_option("--study", arguments->study, "append the session and the visitor's rating to NAME.csv");
  command->callback(
      [arguments, &common, &run] { run = [arguments, &common] { return run_explore(*arguments, common); }; });
}

}  // namespace sparsha::app
