#include "app/exploration/exploration.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <thread>
#include <utility>

#include "app/exploration/kept_scenes.h"
#include "app/exploration/run_summary.h"
#include "app/exploration/study.h"
#include "app/inputs.h"
#include "app/words/sentences.h"
#include "base/error.h"
#include "haptics/session/navigator.h"
#include "haptics/state/vectors.h"
#include "haptics/window/window.h"
#include "scene/folder/folder.h"
#include "scene/scene.h"

namespace sparsha::app {
namespace fs = std::filesystem;

namespace {

haptics::DeviceRequest device_request(const ExploreArguments& arguments, const Terminal& terminal, bool window) {
  haptics::DeviceRequest request;
  request.window = window;
  request.stop = interrupted;
  request.say = [&terminal](const std::string& words) { terminal.message(words); };
  request.firmware = arguments.firmware;
  // A kiosk starts with the machine, before the exhibit is switched on; a person may plug it in any time. A run of
  // fixed length would be over without it.
  request.wait_for_device = arguments.kiosk || (arguments.device == "falcon" && arguments.duration_s <= 0.0);
  return request;
}

std::uint64_t points_in_memory(const std::string& memory) {
  constexpr std::uint64_t kLeast = 10'000;  // that show what an object is
  const std::uint64_t points = parse_bytes(memory) / kBytesPerPointShown;
  if (points < kLeast) throw usage_error("--memory " + memory + " is too little to show a scan", "1MB or more");
  return points;
}

// Every output that was asked for is written as far as possible: one that fails keeps no other from it.
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

// True where a person at a window turns the object before anything is built.
bool starts_with_scans(const ExploreArguments& arguments, bool window) {
  const bool person = arguments.device == "auto" || arguments.device == "falcon" || arguments.device == "pointer";
  if (!window || !person || arguments.direct || arguments.kiosk || arguments.duration_s > 0.0) return false;
  std::error_code code;
  return std::ranges::all_of(arguments.scene, [&](const std::string& argument) {
    return !is_config(argument) && !fs::is_directory(argument, code);
  });
}

}  // namespace

void LastTouch::see(const haptics::State& now) {
  const bool feels =
      now.contact == 1 && (now.flags & haptics::kFlagArmed) != 0 && (now.flags & haptics::kFlagFault) == 0;
  if (now.scene != state_.scene) felt_ = false;
  const bool shown = feels || !felt_;
  if (shown_ && !shown) strip_then_ = strip_;
  shown_ = shown;
  strip_.add(now);
  if (shown) state_ = now;
  felt_ = felt_ || feels;
}

Exploration::Exploration(const ExploreArguments& arguments, const CommonOptions& common, Terminal& terminal,
                         bool window)
    : arguments_(arguments),
      terminal_(terminal),
      trust_(common.trusted()),
      exhibits_(arguments.scenes.empty() ? Exhibits() : Exhibits(arguments.scenes, common.trusted(), terminal)),
      chosen_(choose_device(arguments.device, device_request(arguments, terminal, window))) {
  if (!arguments.memory.empty()) scans_.set_most_points(points_in_memory(arguments.memory));
  if (starts_with_scans(arguments, window)) {
    scans_.show(std::make_unique<DepthScans>(std::vector<fs::path>(arguments.scene.begin(), arguments.scene.end())));
    if (const std::string why = scans_.shown().unavailable(); !why.empty())
      throw input_error(arguments.scene.front(), "no such file", "a scene folder, a configuration or scans");
  } else if (chosen_.recording && (kept_ = kept_scenes_of(*chosen_.recording, common, terminal))) {
    scans_.show(std::make_unique<DepthScans>(kept_->first(), fs::path(), trust_));
    make_session_of(kept_->first());
  } else if (!exhibits_.empty()) {
    scene::ScenePointer scene = scene::open_scene(exhibits_.current(), trust_);
    scans_.show(std::make_unique<DepthScans>(scene, fs::path(), trust_));
    make_session_of(std::move(scene));
  } else {
    scene::ScenePointer scene = scene_from(arguments.scene, common.trusted(), terminal.progress());
    const std::string& first = arguments.scene.front();
    const bool config = is_config(first) && scene->folder().empty();
    if (!haptics::touches_all_around(scene->description())) warn_of_front_view(*scene, "touch", terminal.progress());
    scans_.show(std::make_unique<DepthScans>(scene, config ? fs::path(first) : fs::path(), common.trusted()));
    make_session_of(std::move(scene));
  }
  speaker_.emplace(speech(), speaks(scene_),
                   [this](const std::vector<float>& words, double rate_hz) { return sound_.speak(words, rate_hz); });
  tell_of_speech();
}

// The scene's, or what the command line says instead.
scene::SpeechConfig Exploration::speech() const {
  scene::SpeechConfig speech;
  if (scene_ && scene_->description().config.speech) speech = *scene_->description().config.speech;
  if (!arguments_.language.empty() && arguments_.language != speech.language) {
    speech.language = arguments_.language;
    speech.voice.clear();  // of the other language
  }
  return speech;
}

bool Exploration::speaks(const scene::ScenePointer& scene) const {
  return arguments_.speech || (scene && scene->description().config.speech);
}

void Exploration::run(bool window) {
  began_ = Clock::now();
  start();
  if (window) return run_windows();
  keys_.emplace();
  while (!over()) wait_headless();
  keys_.reset();  // the rating of a study is typed as a line
}

bool Exploration::over() const {
  const std::chrono::duration<double> elapsed = Clock::now() - began_;
  return interrupted() || (session_ && session_->finished()) ||
         (chosen_.keys && keys_ && (keys_->gone() || !keys_->active())) ||
         (arguments_.duration_s > 0.0 && elapsed.count() >= arguments_.duration_s);
}

void Exploration::start() {
  if (!session_) return;
  session_->start();
  sound_.start();
}

void Exploration::deliver(const CommonOptions& common) {
  if (!session_) return deliver_nothing();
  Deliveries deliveries;
  deliveries.attempt([&] { session_->stop(); });
  const haptics::SessionSummary summary = session_->stop();
  deliveries.attempt([&] { sound_.stop(); });
  if (!arguments_.screenshot.empty()) {
    deliveries.attempt([&] {
      viewer::write_screenshot(session_->scene(), touch_.state(), scene_->description().config.viewer,
                               arguments_.screenshot, touch_.strip());
    });
  }
  if (!arguments_.study.empty()) {
    deliveries.attempt([&] { append_study(arguments_.study, summary, ask_realism()); });
  }
  const std::uint64_t strikes = sound_.strikes();
  print(common.json    ? summary_json(summary, strikes)
        : common.plain ? summary_sentences(summary, strikes)
                       : summary_text(summary, strikes));
  deliveries.settle();
}

// The window was closed before a depth scan was made.
void Exploration::deliver_nothing() const {
  const viewer::OrientingStatus status = scans_.shown().status();
  if (!status.points && status.problem) throw Error(ErrorKind::input, {}, status.note);
  const bool promised = !arguments_.record.empty() || !arguments_.screenshot.empty() || !arguments_.audio_out.empty() ||
                        !arguments_.study.empty();
  if (promised)
    throw Error(ErrorKind::failure, {}, "no depth scan was made, so that there is nothing to write",
                "Enter in the window, or --direct");
}

void Exploration::wait_headless() {
  use_keys();
  poll();
  std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

void Exploration::use_keys() {
  if (!session_ || !keys_ || !keys_->active()) return;
  const std::chrono::duration<double> now = Clock::now() - began_;
  std::vector<TypedKey> keys = typed_.take(keys_->read(), now.count());
  if (chosen_.keys) move_hand(keys, now.count());
  for (const haptics::Request& request : meanings_.take(keys, now.count())) session_->requests().post(request);
}

// What the keys want of the hand, and how far the window can go with it; of a whole object along the device's axes.
HandKeys::Wish Exploration::wish_of_keys(const haptics::State& state) {
  const double width_m = state.workspace_m / state.scale;
  if (const std::optional<Eigen::AlignedBox3d> box_m = session_->whole_object_m()) {
    const haptics::AroundView view = haptics::around_view(*box_m, state, width_m);
    haptics::State turned = state;
    turned.centre_m = haptics::to_array(view.centre_m);
    return hand_keys_.update(turned, view.range, {-view.box_half_m.head<2>(), view.box_half_m.head<2>()});
  }
  const scene::SceneDescription& scene = scene_->description();
  const std::size_t level = std::min<std::size_t>(state.level, scene.levels.size() - 1);
  const scene::Lattice& lattice = scene.levels[level];
  const HandKeys::Stone stone{{lattice.x_m(0), lattice.y_m(0)},
                              {lattice.x_m(lattice.nx - 1), lattice.y_m(lattice.ny - 1)}};
  return hand_keys_.update(state, haptics::centre_range(scene, lattice, width_m), stone);
}

// Takes the hand's keys from `keys`.
void Exploration::move_hand(std::vector<TypedKey>& keys, double now_s) {
  const haptics::State state = session_->state().read();
  std::erase_if(keys, [&](const TypedKey& key) {
    const bool taken = hand_keys_.press(key, now_s, state, session_->phrases());
    if (const auto words = hand_keys_.take_words()) announce(words->phrase, words->values);
    return taken;
  });
  const HandKeys::Wish wish = wish_of_keys(state);
  if (const auto words = hand_keys_.take_words()) announce(words->phrase, words->values);
  chosen_.keys->publish(wish.hand);
  if (wish.scroll == scroll_) return;
  scroll_ = wish.scroll;
  session_->requests().post({haptics::Request::Kind::scroll, scroll_.x(), scroll_.y()});
}

// A window that loses its display leaves the hand, the sound and the recording alone, and comes back with it.
void Exploration::run_windows() {
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
viewer::WindowEnd Exploration::run_window(bool again) {
  if (session_) connect_session();
  connections_.pointer = chosen_.pointer;
  connections_.object_before_m = [this](const Eigen::Vector2d& device_m) {
    return session_ ? session_->object_before_m(device_m) : std::nan("");
  };
  connections_.poll = [this] { poll(); };
  connections_.finished = [this] { return over(); };
  connections_.scene = [this] { return session_ ? session_->scene() : nullptr; };
  connections_.orienting = orienting_of([this]() -> DepthScans& { return scans_.shown(); });
  connections_.to_scans = [this] { return std::exchange(to_scans_, false); };
  if (!arguments_.kiosk) connections_.drop = [this](const std::vector<fs::path>& files) { drop(files); };
  if (session_ && session_->plays_recording())
    connections_.orienting.unavailable = [] { return std::string("a recording is played"); };
  if (!arguments_.kiosk && !(session_ && session_->plays_recording()))
    connections_.save_parts = [this](const std::vector<scene::PartConfig>& parts) { return edit_parts(parts); };
  if (!arguments_.kiosk) connections_.save_scene = [this] { save_scene(); };
  viewer::ViewerOptions options;
  options.kiosk = arguments_.kiosk;
  options.opens_again = again;
  connections_.refuse = [this](const std::string& why) { refuse(why); };
  if (exhibits_.size() > 1) connections_.next_scene = [this](int step) { next_scene(step); };
  return viewer::run_window(connections_, options);
}

void Exploration::connect_session() {
  connections_.state = &session_->state();
  connections_.requests = &session_->requests();
  connections_.announcements = &session_->announcements();
  connections_.speak = [this](const std::string& text) { session_->announcements().say(text); };
  connections_.rescan = [this](const Eigen::Matrix4d& scan_to_grid) { rescan(scan_to_grid); };
}

void Exploration::poll() {
  scans_.settle();
  take_scan();
  tell_of_scans();
  if (!session_) return;
  session_->poll();
  follow_recording();
  if (const std::string warning = sound_.take_warning(); !warning.empty()) terminal_.message("warning: " + warning);
  touch_.see(session_->state().read());
  for (const haptics::Announcement& announcement : session_->announcements().since(heard_)) {
    heard_ = announcement.sequence;
    speaker_->hear(announcement);
    if (announcement.text.empty()) continue;  // for speech alone
    if (announcement.priority != haptics::Announcement::Priority::information) {
      terminal_.message("warning: " + announcement.text);
    } else if (keys_ && keys_->active()) {
      terminal_.message(announcement.text);  // for a braille display
    }
  }
  tell_of_speech();
}

void Exploration::tell_of_scans() {
  const viewer::OrientingStatus status = scans_.shown().status();
  for (const std::string& warning : scans_.shown().take_warnings()) terminal_.message("warning: " + warning);
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

void Exploration::tell_of_speech() {
  if (const std::string problem = speaker_->take_problem(); !problem.empty()) terminal_.message("warning: " + problem);
  if (told_of_speech_ || speaker_->available()) return;
  told_of_speech_ = true;
  terminal_.message("warning: no speech program is installed (espeak-ng)");
}

// To whoever looks at the terminal, in its language, and to the visitor.
void Exploration::warn(Phrase phrase, const PhraseValues& values) {
  terminal_.message(Phrases::of("en").text(phrase, values));
  if (session_) announce(phrase, values, haptics::Announcement::Priority::warning);
}

void Exploration::announce(Phrase phrase, const PhraseValues& values, haptics::Announcement::Priority priority) {
  session_->announcements().say(session_->phrases().text(phrase, values), priority);
}

}  // namespace sparsha::app
