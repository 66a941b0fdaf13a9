#include "haptics/session/session.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ctime>
#include <exception>
#include <optional>
#include <utility>

#include "base/error.h"
#include "haptics/governor/governor.h"
#include "haptics/replay/path_device.h"
#include "haptics/replay/recorder.h"
#include "haptics/replay/recording.h"
#include "haptics/replay/replay.h"
#include "haptics/replay/scene_keeper.h"
#include "haptics/servo/servo.h"
#include "haptics/session/announcer.h"
#include "haptics/session/button_tour.h"
#include "haptics/session/buttons.h"
#include "haptics/session/fault_watch.h"
#include "haptics/session/gestures.h"
#include "haptics/session/guide_control.h"
#include "haptics/session/navigator.h"
#include "haptics/session/object_before.h"
#include "haptics/session/relief_words.h"
#include "haptics/session/summary.h"
#include "haptics/session/window_loader.h"
#include "scene/area/regions.h"
#include "scene/scene.h"

namespace sparsha::haptics {
namespace {

constexpr double kSlowest_hz = 100.0;
constexpr double kFastest_hz = 10000.0;
constexpr double kHelpAgain_s = 30.0;
// Of what is asked for step by step.
constexpr double kSoftest_n_per_m = 50.0;
constexpr double kHardest_n_per_m = 5000.0;

double checked_rate(double rate_hz, double own_rate_hz) {
  if (own_rate_hz > 0.0) rate_hz = own_rate_hz;
  if (rate_hz >= kSlowest_hz && rate_hz <= kFastest_hz) return rate_hz;
  if (own_rate_hz > 0.0)
    throw Error(ErrorKind::input, {}, fmt::format("the rows of the recording come at {:.6g} Hz", rate_hz),
                "100 to 10000 rows a second");
  throw usage_error(fmt::format("a servo rate of {} Hz", rate_hz), "rate_hz from 100 to 10000");
}

scene::ScenePointer first_recorded(const RecordedScenes& scenes, const Recording& recording) {
  scenes.require(recording);
  return scenes.of(recording.windows().front());
}

}  // namespace

struct Session::Implementation {
  Implementation(scene::ScenePointer first_scene, std::unique_ptr<Device> hand, std::shared_ptr<const Recording> played,
                 std::optional<RecordedScenes> played_scenes, SessionOptions session_options)
      : scene(std::move(first_scene)),
        device(std::move(hand)),
        recording(std::move(played)),
        recorded(std::move(played_scenes)),
        options(std::move(session_options)),
        info(device ? device->info() : played_device(*recording)),
        rate_hz(checked_rate(options.haptics.rate_hz, info.rate_hz)),
        announcer(announcements, scene, Phrases::of(options.language)),
        navigator(scene, info.workspace_width_m, options.effects, announcer),
        recorder(options.record, info, rate_hz),
        keeper(options.record, recorded ? recorded->first() : scene) {
    if (!info.warning.empty()) announcer.say_as_is(info.warning, Announcement::Priority::warning);
    stiffness_n_per_m = governed(options.haptics.stiffness_n_per_m);
    if (recording) {
      scene_number = recording->windows().front().scene;
      navigator.settle(recording->windows().front().plan);
      for (const auto& [number, kept] : recorded->by_number())
        if (number > 1) keeper.keep(number, kept);
    } else {
      first_window = load_window(*scene, navigator.plan(), next_id++);
      newest.know(first_window);
    }
  }

  [[nodiscard]] double governed(double wish_n_per_m) const {
    return governed_stiffness(wish_n_per_m, info.limits, 1.0 / rate_hz);
  }

  /// A loop that is slower than planned, or later than declared, bears less than was asked of it.
  [[nodiscard]] double rendered(const State& now) const {
    const double limit_n_per_m = now.stiffness_limit_n_per_m;
    return limit_n_per_m > 0.0 ? std::min(stiffness_n_per_m, limit_n_per_m) : stiffness_n_per_m;
  }

  void say_stiffness(double wish_n_per_m, const State& now) {
    const double rendered_n_per_m = rendered(now);
    announcer.say(rendered_n_per_m < wish_n_per_m ? Phrase("stiffness_most") : Phrase("stiffness"),
                  {{"number", fmt::format("{:.0f}", rendered_n_per_m)}});
  }

  void post(Command command) {
    command.sequence = sequence + 1;
    if (servo->post(std::move(command)))
      ++sequence;
    else
      announcer.say("servo_silent", {}, Announcement::Priority::warning);
  }

  void request_window(std::optional<WindowLoader::Job> job) {
    if (!job) return;
    job->id = next_id++;
    job->scene_number = scene_number;
    navigator.settle(job->plan);
    loader.request(std::move(*job));
  }

  void take_windows() {
    while (std::optional<WindowLoader::Result> result = loader.take()) {
      ++windows_loaded;
      window_load_s_max = std::max(window_load_s_max, result->seconds);
      if (result->error.empty()) {
        newest.know(result->job.command.window);
        post(std::move(result->job.command));
      } else {
        announcer.say("window_unreadable", {{"reason", result->error}}, Announcement::Priority::fault);
      }
    }
  }

  void serve(const Request& request, const State& now) {
    switch (request.kind) {
      case Request::Kind::quit:
        quit = true;
        return;
      case Request::Kind::describe:
        describe(now);
        return;
      case Request::Kind::repeat:
        announcer.repeat();
        return;
      case Request::Kind::fresh_visitor:
        welcome_next();
        return;
      case Request::Kind::help:
      case Request::Kind::help_keys:
      case Request::Kind::tour:
        help(request, now);
        return;
      case Request::Kind::speak_slower:
      case Request::Kind::speak_faster:
      case Request::Kind::next_voice:
      case Request::Kind::set_speech:
      case Request::Kind::toggle_speech:
        change_speech(request);
        return;
      default:
        if (!recording) change_touch(request, now);
    }
  }

  void help(const Request& request, const State& now) {
    if (request.kind == Request::Kind::help_keys)
      return announcer.say(options.by_keys ? Phrase("help_hand") : Phrase("help_keys"));
    // Asked for once more, help becomes a tour.
    if (request.kind == Request::Kind::tour || now.time_s - helped_s < kHelpAgain_s) {
      helped_s = -kHelpAgain_s;
      return tour.start(now.time_s, !scene->description().config.parts.empty(), options.grip);
    }
    helped_s = now.time_s;
    announcer.say("help");
  }

  void change_speech(const Request& request) {
    switch (request.kind) {
      case Request::Kind::speak_slower:
        return announcer.control(Announcement::Control::slower, "speech_slower");
      case Request::Kind::speak_faster:
        return announcer.control(Announcement::Control::faster, "speech_faster");
      case Request::Kind::next_voice:
        return announcer.control(Announcement::Control::next_voice, "speech_voice");
      default:
        break;
    }
    if (request.kind == Request::Kind::set_speech && speaks == request.on) return;
    helped_s = -kHelpAgain_s;  // a hold for speech helps on its way; the next one is to help, not to begin the tour
    speaks = !speaks;
    announcer.control(Announcement::Control::toggle, speaks ? Phrase("speech_on") : Phrase("speech_off"));
  }

  // What changes what the hand feels or where it is.
  void change_touch(const Request& request, const State& now) {
    switch (request.kind) {
      case Request::Kind::set_stiffness:
      case Request::Kind::scale_stiffness:
        return change_stiffness(request, now);
      case Request::Kind::drag:
        return drag(request.on);
      case Request::Kind::turn:
      case Request::Kind::turn_back:
        if (std::optional<Command> turn = navigator.turn(request)) post(std::move(*turn));
        return;
      case Request::Kind::guide:
        return change_guide(request, now);
      case Request::Kind::next_part:
      case Request::Kind::previous_part:
        return go_to_part(request, now);
      default:
        request_window(navigator.wish(request, now));
    }
  }

  void change_stiffness(const Request& request, const State& now) {
    if (!(request.x >= 0.0)) return;
    const double wish_n_per_m = request.kind == Request::Kind::set_stiffness
                                    ? request.x
                                    : std::clamp(rendered(now) * request.x, kSoftest_n_per_m, kHardest_n_per_m);
    stiffness_n_per_m = governed(wish_n_per_m);
    Command command;
    command.kind = Command::Kind::stiffness;
    command.stiffness_n_per_m = stiffness_n_per_m;
    post(std::move(command));
    say_stiffness(wish_n_per_m, now);
  }

  void drag(bool on) {
    Command command;
    command.kind = Command::Kind::drag;
    command.on = on;
    post(std::move(command));
  }

  void change_guide(const Request& request, const State& now) {
    if (request.on && std::exchange(hold_ended_guide, false)) return;
    if (guide.on())
      post(guide.stop());
    else
      guide.ask(guide_wish(now, true));
  }

  void go_to_part(const Request& request, const State& now) {
    if (request.on) hold_ended_guide = guide.on();
    if (request.on && hold_ended_guide) return post(guide.stop());
    request_window(navigator.wish(request, now));
    // A guide along a part goes with the visitor to the next one.
    if (guide.on()) guide.ask(guide_wish(now, false));
  }

  // Nothing of the visitor before is left to the next one.
  void welcome_next() {
    speaks = options.speaks;
    announcements.say({}, Announcement::Priority::information, Announcement::Control::reset);
    helped_s = -kHelpAgain_s;
    tour.stop();
    if (recording) return;
    if (guide.on()) post(guide.stop(true));
    drag(false);
    if (std::optional<Command> front = navigator.face_front()) post(std::move(*front));
    navigator.forget_part();
  }

  [[nodiscard]] GuideWish guide_wish(const State& now, bool touched_first) const {
    GuideWish wish;
    wish.scene = scene;
    wish.level = navigator.plan().level;
    wish.around = navigator.goes_around();
    wish.hand_m = navigator.hand_m(now);
    wish.scale = navigator.plan().scale;
    wish.turn = navigator.turn();
    wish.part = navigator.part();
    const auto& parts = scene->description().config.parts;
    const scene::PartConfig* touched = scene::part_at(scene->description(), now.place_m);
    if (touched_first && now.contact != 0 && touched != nullptr)
      wish.part = static_cast<std::size_t>(touched - parts.data());
    return wish;
  }

  void describe(const State& now) {
    // The window that the servo has, not one that is on its way.
    View view = navigator.view_of(navigator.plan());
    if (view.scale != now.scale) view = {View::Kind::present, info.workspace_width_m / now.scale, now.scale};
    announcer.describe(now, view);
  }

  void use_buttons(const State& now) {
    const std::vector<Gesture> gestures = buttons.read(now);
    for (const Gesture gesture : gestures) serve(request_of(gesture), now);
    tour.watch(gestures, now.time_s);
  }

  // The recording goes on to another of its scenes.
  void follow_recording(const State& now) {
    if (now.scene == scene_number) return;
    scene_number = now.scene;
    scene = recorded->by_number().at(scene_number);
    navigator.settle(navigator.change_scene(scene).plan);
  }

  scene::ScenePointer scene;
  std::unique_ptr<Device> device;
  std::shared_ptr<const Recording> recording;  // played instead of a device
  std::optional<RecordedScenes> recorded;      // with a recording
  SessionOptions options;
  DeviceInfo info;
  double rate_hz;
  Seqlock<State> state;
  RequestQueue requests;
  AnnouncementBoard announcements;
  std::vector<std::shared_ptr<ContactQueue>> consumers;
  Announcer announcer;
  Navigator navigator;
  Recorder recorder;
  SceneKeeper keeper;
  WindowLoader loader;
  HapticWindow first_window;
  ObjectBefore newest;
  std::unique_ptr<Servo> servo;
  std::unique_ptr<Replay> replay;
  std::clock_t processor_at_start = 0;
  std::optional<SessionSummary> summary;

  std::uint64_t next_id = 1;
  std::uint64_t scene_number = 1;  // counts the scenes that were given
  std::uint64_t sequence = 0;
  Buttons buttons;
  ButtonTour tour{announcer};
  GuideControl guide{announcer};
  ReliefWords relief{announcer, announcements};
  double helped_s = -kHelpAgain_s;  // when help was given last
  bool hold_ended_guide = false;    // the button that is held, or was held last
  double stiffness_n_per_m = 0.0;
  bool speaks = options.speaks;
  bool quit = false;
  std::uint64_t windows_loaded = 1;
  double window_load_s_max = 0.0;
  FaultWatch faults{announcer, options.real_time};
};

Session::Session(scene::ScenePointer scene, std::unique_ptr<Device> device, SessionOptions options)
    : implementation_(std::make_unique<Implementation>(std::move(scene), std::move(device), nullptr, std::nullopt,
                                                       std::move(options))) {}

Session::Session(RecordedScenes scenes, std::shared_ptr<const Recording> recording, SessionOptions options) {
  scene::ScenePointer first = first_recorded(scenes, *recording);
  implementation_ = std::make_unique<Implementation>(std::move(first), nullptr, std::move(recording), std::move(scenes),
                                                     std::move(options));
}

Session::~Session() {
  if (implementation_->servo) implementation_->servo->stop();
  if (implementation_->replay) implementation_->replay->stop();
}

void Session::start() {
  Implementation& self = *implementation_;
  if (self.servo || self.replay) throw Error(ErrorKind::failure, {}, "the session has been started before");
  RendererOptions renderer;
  renderer.rate_hz = self.rate_hz;
  renderer.stiffness_n_per_m = self.stiffness_n_per_m;
  renderer.solver = self.options.haptics.solver;
  renderer.solver_options.shape = shape_of(self.options.haptics.surface, self.options.haptics.creases);
  renderer.longest_gap_s = self.options.longest_gap_s;
  if (self.recording) {
    self.replay =
        std::make_unique<Replay>(*self.recorded, self.recording, renderer, self.state, self.consumers, &self.recorder);
  } else {
    ServoOptions options;
    options.renderer = renderer;
    options.real_time = self.options.real_time;
    self.servo = std::make_unique<Servo>(*self.device, options, std::move(self.first_window), self.state,
                                         self.consumers, &self.recorder);
  }
  const View view = self.navigator.view_of(self.navigator.plan());
  if (self.speaks)
    self.announcer.say_first(view);
  else
    self.announcer.say_view(view);
  self.recorder.start();
  self.processor_at_start = std::clock();
  if (self.servo) self.servo->start();
  if (self.replay) self.replay->start();
}

void Session::poll() {
  Implementation& self = *implementation_;
  if ((!self.servo && !self.replay) || self.summary) return;
  if (self.replay) self.replay->poll();
  const State now = self.state.read();
  if (self.servo) {
    self.servo->collect();
    self.faults.watch(now, *self.servo, *self.device, self.keeper);
  }
  if (now.tick > 0) {
    if (self.replay) self.follow_recording(now);
    self.announcer.watch(now);
    if (self.options.by_keys) self.relief.watch(now);
    self.guide.watch(now);
    self.use_buttons(now);
  }
  while (const std::optional<Request> request = self.requests.take()) {
    self.serve(*request, now);
    if (const std::optional<Gesture> gesture = gesture_of(*request)) self.tour.watch({*gesture}, now.time_s);
  }
  if (self.replay) return;
  self.take_windows();
  if (std::optional<Command> command = self.guide.poll()) self.post(std::move(*command));
  if (now.tick == 0 || self.loader.busy() || now.command != self.sequence) return;
  self.navigator.arrived();
  // Only once the servo has caught up is its State about the present window.
  self.request_window(self.navigator.follow(now));
  if ((now.flags & kFlagDragged) != 0) return;  // the hand at the rim drags, it does not scroll
  if (std::optional<Command> command = self.navigator.scroll(now)) self.post(std::move(*command));
}

bool Session::finished() const {
  const Implementation& self = *implementation_;
  return self.quit || (self.servo && self.servo->finished()) || (self.replay && self.replay->finished());
}

SessionSummary Session::stop() {
  Implementation& self = *implementation_;
  if (self.summary) return *self.summary;
  SessionSummary summary;
  if (self.servo || self.replay) {
    summary.processor_s = static_cast<double>(std::clock() - self.processor_at_start) / CLOCKS_PER_SEC;
    if (self.servo) self.servo->stop();
    if (self.replay) self.replay->stop();
    add_figures(summary, self.servo ? self.servo->figures() : self.replay->figures());
  }
  std::exception_ptr lost;
  try {
    if (self.replay) self.replay->poll();  // it may have ended since the last look
  } catch (const Error&) {
    lost = std::current_exception();
  }
  try {
    self.recorder.finish();
    self.keeper.finish(self.recorder.sha256(), self.recorder.figures().scenes);
  } catch (...) {
    if (!lost) lost = std::current_exception();
  }
  add_figures(summary, self.recorder.figures());
  summary.dropped_records = self.recorder.dropped();
  summary.stiffness_n_per_m = self.stiffness_n_per_m;
  summary.windows_loaded = self.replay ? self.replay->windows_loaded() : self.windows_loaded;
  summary.window_load_s_max = self.window_load_s_max;
  self.summary = summary;
  if (lost) std::rethrow_exception(lost);
  return summary;
}

const Seqlock<State>& Session::state() const { return implementation_->state; }
RequestQueue& Session::requests() { return implementation_->requests; }
const Phrases& Session::phrases() const { return implementation_->announcer.phrases(); }
AnnouncementBoard& Session::announcements() { return implementation_->announcements; }

std::shared_ptr<ContactQueue> Session::add_contact_consumer() {
  constexpr std::size_t kEvents = 1024;
  auto queue = std::make_shared<ContactQueue>(kEvents);
  implementation_->consumers.push_back(queue);
  return queue;
}

scene::ScenePointer Session::scene() const { return implementation_->scene; }

std::optional<Eigen::AlignedBox3d> Session::whole_object_m() const { return implementation_->navigator.box_m(); }

double Session::object_before_m(const Eigen::Vector2d& device_m) const {
  return implementation_->newest.z_m(device_m, implementation_->state.read());
}

bool Session::plays_recording() const { return implementation_->recording != nullptr; }

void Session::set_speech(const std::string& language, bool speaks, std::optional<bool> first_speaks) {
  Implementation& self = *implementation_;
  self.announcer.set_phrases(Phrases::of(language));
  if (speaks && !self.speaks) self.announcer.say("speech_on");
  self.speaks = speaks;
  self.options.speaks = first_speaks.value_or(speaks);
}

void Session::set_scene(scene::ScenePointer scene) {
  Implementation& self = *implementation_;
  if (self.recording) throw Error(ErrorKind::usage, {}, "a recording is played on the scene it was made with");
  self.scene = std::move(scene);
  WindowLoader::Job job = self.navigator.change_scene(self.scene);
  if (self.servo) {
    self.keeper.keep(++self.scene_number, self.scene);
    if (self.guide.on()) self.post(self.guide.stop(true));
    self.request_window(std::move(job));
  } else {
    self.keeper.keep(self.scene_number, self.scene);  // the first one still
    self.navigator.settle(job.plan);
    self.first_window = load_window(*self.scene, job.plan, self.next_id++);
    self.newest.know(self.first_window);
  }
}

}  // namespace sparsha::haptics
