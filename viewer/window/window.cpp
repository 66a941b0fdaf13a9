// The window's loop: the controller's frames to the screen, and the change between raw cloud and touched scene.
#include <chrono>
#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "base/error.h"
#include "scene/scene.h"
#include "viewer/cloud/mode.h"
#include "viewer/controller/controller.h"
#include "viewer/gui/gui.h"
#include "viewer/kiosk/attract.h"
#include "viewer/picture/picture.h"
#include "viewer/picture/screenshot.h"
#include "viewer/window/display_loss.h"
#include "viewer/window/events.h"
#include "viewer/window/glfw_window.h"

namespace sparsha::viewer {
namespace {

/// An exhibit that nobody touches goes back to its beginning; a slow light shows it.
void attract_visitors(Attract& attract, Controller& controller, const ViewSettings& first, double time_s,
                      const haptics::State& state) {
  const Attract::Change change = attract.update(time_s, state);
  if (change == Attract::Change::begins) controller.welcome_next(first);
  controller.hide_faults(attract.alone(time_s));
  if (attract.shows()) controller.frame().settings.light = attract.light(time_s);
  if (change == Attract::Change::ends) controller.frame().settings.light = KeyLight{};
}

void save_picture(Controller& controller, int width, int height) {
  const std::string file = dated_name("sparsha", ".png");
  try {
    write_framebuffer(width, height, file);
    controller.tell("Saved " + file);
  } catch (const Error& error) {
    controller.tell("Not saved: " + error.wrong(), haptics::Announcement::Priority::warning);
  }
}

/// Pictures of the last second and what they cost.
class PictureCount {
 public:
  void add(double time_s, double cost_s) { pictures_.push_back({time_s, cost_s}); }
  void show(double time_s, Frame& frame) {
    while (!pictures_.empty() && pictures_.front().first < time_s - 1.0) pictures_.pop_front();
    double sum_s = 0.0;
    for (const auto& picture : pictures_) sum_s += picture.second;
    frame.pictures_per_s = static_cast<double>(pictures_.size());
    frame.picture_ms = pictures_.empty() ? 0.0 : 1e3 * sum_s / frame.pictures_per_s;
  }

 private:
  std::deque<std::pair<double, double>> pictures_;
};

/// What is in an open window: pictures, events, and the modes that they belong to.
class Screen {
 public:
  Screen(const Connections& connections, const ViewerOptions& options, WindowHandle& window)
      : connections_(connections), options_(options), window_(window), attract_(options.idle_s) {
    inputs_.picture = &picture_;
    inputs_.gui = &gui_;
    inputs_.attract = &attract_;
    inputs_.connections = &connections_;
    inputs_.change_mode = [this] { change_mode(); };
    settings_.kiosk = options_.kiosk;
    listen(window_.handle, inputs_, options_.kiosk);
    gui_input_.emplace(window_.handle);  // calls on what listens already
  }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  /// Until the window closes or its display is lost.
  WindowEnd run() {
    if (!ask_sizes(window_.handle, inputs_)) return WindowEnd::display_lost;
    if (!connections_.scene()) show_scans(true);
    while (glfwWindowShouldClose(window_.handle) == GLFW_FALSE && !leaves_ && !wants_to_leave()) {
      if (connections_.poll) connections_.poll();
      if (connections_.finished && connections_.finished()) break;
      if (!take_scene()) continue;
      if (connections_.to_scans && connections_.to_scans()) show_scans(true);
      if (!frame(seconds())) return WindowEnd::display_lost;
    }
    if (!wants_to_leave() && connections_.requests != nullptr)
      connections_.requests->post({haptics::Request::Kind::quit});
    if (connections_.poll) connections_.poll();
    return WindowEnd::closed;
  }

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] double seconds() const { return std::chrono::duration<double>(Clock::now() - began_).count(); }
  [[nodiscard]] bool wants_to_leave() const { return controller_ && controller_->wants_to_leave(); }

  /// Between the raw cloud and the touched scene.
  void show_scans(bool on) {
    // A button that is let go afterwards would be let go in the other mode.
    for (int button = 0; button < static_cast<int>(inputs_.down.size()); ++button) {
      if (!inputs_.down[static_cast<std::size_t>(button)]) continue;
      if (inputs_.cloud != nullptr) inputs_.cloud->mouse_button(button, false, 0);
      if (inputs_.cloud == nullptr && controller_) controller_->mouse_button(button, false, 0);
    }
    if (on && !cloud_)
      cloud_.emplace(connections_.orienting, [this](const std::string& words) {
        if (connections_.speak) connections_.speak(words);  // there is no session before the first depth scan
      });
    if (on) connections_.orienting.open();
    if (controller_ && (inputs_.cloud != nullptr) != on) {
      ViewSettings& touching = controller_->frame().settings;
      (on ? settings_ : touching).high_contrast = (on ? touching : settings_).high_contrast;
      (on ? settings_ : touching).large_type = (on ? touching : settings_).large_type;
    }
    inputs_.cloud = on ? &*cloud_ : nullptr;
    inputs_.damaged = true;
    gui_.use_keyboard(on);
  }

  void change_mode() {
    if (inputs_.cloud != nullptr) {
      const CloudController::Wish wish = cloud_->take_wish(settings_);
      if (wish == CloudController::Wish::back) show_scans(false);
      leaves_ = leaves_ || wish == CloudController::Wish::quit;
    } else if (controller_ && controller_->takes_to_scans()) {
      show_scans(true);
    }
  }

  /// The session's new scene, if there is one; false when it cannot be shown.
  bool take_scene() {
    scene::ScenePointer scene = connections_.scene();
    if (!scene || scene == picture_.scene() || scene == refused_) return true;
    try {
      picture_.set_scene(scene);
    } catch (const Error& error) {
      if (!picture_.scene() || !connections_.refuse) throw;
      refused_ = scene;
      connections_.refuse(error.wrong());
      return false;
    }
    if (!controller_) {
      const ViewSettings before = settings_;
      settings_ = settings_of(scene->description().config.viewer);
      settings_.kiosk = before.kiosk;
      settings_.high_contrast = before.high_contrast;
      settings_.large_type = before.large_type;
      controller_.emplace(connections_, settings_);
      inputs_.controller = &*controller_;
    }
    controller_->set_scene(std::move(scene));
    inputs_.damaged = true;
    show_scans(false);
    return true;
  }

  /// One sixtieth of a second; false when the display is lost.
  bool frame(double now_s) {
    if (controller_) update(now_s);
    const bool seen = inputs_.width > 0 && inputs_.height > 0 && !inputs_.iconified;
    if (seen && inputs_.cloud != nullptr) {
      draw_cloud(now_s);
    } else if (seen && controller_) {
      draw_scene(now_s);
    }
    if (display_lost()) return false;
    if (options_.kiosk && !stay_on_screen(now_s)) return false;
    if (controller_ && controller_->take_full_screen_wish() && !options_.kiosk) {
      switch_full_screen(window_);
      if (!ask_sizes(window_.handle, inputs_)) return false;
    }
    inputs_.change_mode();
    return wait(now_s);
  }

  /// GLFW makes the window a small one when its monitor goes: an exhibit fills the screen again that comes. False when
  /// the display is lost.
  bool stay_on_screen(double now_s) {
    if (now_s < look_at_screen_s_) return true;
    look_at_screen_s_ = now_s + 1.0;
    if (inputs_.iconified) glfwRestoreWindow(window_.handle);
    if (glfwGetWindowMonitor(window_.handle) != nullptr || !fill_screen(window_.handle)) return !display_lost();
    return ask_sizes(window_.handle, inputs_);
  }

  void update(double now_s) {
    const haptics::State state = connections_.state != nullptr ? connections_.state->read() : haptics::State{};
    if (options_.kiosk) attract_visitors(attract_, *controller_, settings_, now_s, state);
    picture_.follow_touch(state, false);
    controller_->update(
        now_s, state, inputs_.width, inputs_.height,
        [this](double x_m, double y_m) { return picture_.touch_height_at(x_m, y_m); },
        [this](double x_m, double y_m) { return picture_.height_at(x_m, y_m); });
    controller_->frame().finished = false;
    count_.show(now_s, controller_->frame());
  }

  /// Nothing is drawn that would look the same: fields and lists of the panel need some pictures after each event.
  void draw_cloud(double now_s) {
    constexpr double kSettles_s = 1.0;
    if (std::exchange(inputs_.stirred, false) || gui_.wants_keyboard()) stirred_s_ = now_s;
    const bool resized = inputs_.width != drawn_width_ || inputs_.height != drawn_height_;
    if (now_s - stirred_s_ > kSettles_s && !inputs_.damaged && !resized && cloud_->rests()) return;
    cloud_->controller().frame().finished = false;
    GuiInput::begin_frame(inputs_);
    cloud_->draw(gui_, settings_, 0, inputs_.width, inputs_.height, now_s, controller_.has_value());
    glfwSwapBuffers(window_.handle);
    inputs_.damaged = false;
    drawn_width_ = inputs_.width;
    drawn_height_ = inputs_.height;
  }

  /// Nothing is drawn that would look the same.
  void draw_scene(double now_s) {
    const std::uint64_t look = look_of(controller_->frame());
    const bool changed = look != drawn_ || inputs_.damaged || inputs_.width != drawn_width_ ||
                         inputs_.height != drawn_height_ || picture_.waits(now_s) || controller_->wants_screenshot();
    if (!changed) return;
    picture_.draw(controller_->frame(), 0, inputs_.width, inputs_.height);
    controller_->picture_drawn(layout_of(inputs_.width, inputs_.height, controller_->settings()),
                               picture_.detail_view());
    GuiInput::begin_frame(inputs_);
    gui_.draw(controller_->frame(), controller_->buttons(), picture_, inputs_.width, inputs_.height, now_s - before_s_);
    controller_->set_boxes(gui_.boxes(), gui_.help_pages());
    if (controller_->take_screenshot_wish()) save_picture(*controller_, inputs_.width, inputs_.height);
    glfwSwapBuffers(window_.handle);
    inputs_.damaged = false;
    count_.add(now_s, seconds() - now_s);
    drawn_ = look;
    drawn_width_ = inputs_.width;
    drawn_height_ = inputs_.height;
    before_s_ = now_s;
  }

  /// Events until the next picture is due: drivers without a vertical blank do not wait in the swap. False when the
  /// display is lost.
  bool wait(double now_s) const {
    constexpr double kFrame_s = 1.0 / 60.0;
    glfwPollEvents();
    while (!display_lost()) {
      const double left_s = now_s + kFrame_s - seconds();
      if (left_s < 0.001) return true;
      glfwWaitEventsTimeout(left_s);
    }
    return false;
  }

  const Connections& connections_;
  const ViewerOptions& options_;
  WindowHandle& window_;
  Picture picture_;
  Gui gui_;
  WindowInputs inputs_;
  Attract attract_;
  std::optional<GuiInput> gui_input_;
  ViewSettings settings_;
  std::optional<Controller> controller_;  // of the first scene on
  std::optional<CloudMode> cloud_;        // once the raw scans have been asked for
  bool leaves_ = false;
  Clock::time_point began_ = Clock::now();
  double before_s_ = 0.0, stirred_s_ = 0.0, look_at_screen_s_ = 0.0;
  std::uint64_t drawn_ = 0;  // look of the last picture
  int drawn_width_ = 0, drawn_height_ = 0;
  PictureCount count_;
  scene::ScenePointer refused_;  // that cannot be shown
};

WindowEnd run(const Connections& connections, const ViewerOptions& options) {
  std::unique_ptr<GlfwLibrary> library;
  WindowHandle window;
  try {
    library = std::make_unique<GlfwLibrary>();
    open_window(window, options);
  } catch (const Error&) {
    if (options.opens_again) return WindowEnd::display_lost;
    throw;
  }
  return Screen(connections, options, window).run();
}

}  // namespace

WindowEnd run_window(const Connections& connections, const ViewerOptions& options) {
  try {
    return run(connections, options);
  } catch (const Error&) {
    if (display_lost()) return WindowEnd::display_lost;  // and with it what the graphics driver said
    throw;
  }
}

}  // namespace sparsha::viewer
