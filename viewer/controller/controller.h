// Turns keys, buttons and the mouse into requests, settings, camera and the pointer device's hand; makes the frames.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "viewer/actions/actions.h"
#include "viewer/actions/wishes.h"
#include "viewer/camera/orbit.h"
#include "viewer/frame.h"
#include "viewer/hand.h"
#include "viewer/marks/marking.h"
#include "viewer/overlay/toasts.h"
#include "viewer/viewer.h"

namespace sparsha::viewer {

/// Knows neither windows nor graphics; the window feeds it.
class Controller {
 public:
  Controller(const Connections& connections, const ViewSettings& settings);
  /// A stone that is still dragged is let go.
  ~Controller();
  Controller(const Controller&) = delete;
  Controller& operator=(const Controller&) = delete;

  using HeightAt = viewer::HeightAt;

  void set_scene(scene::ScenePointer scene);
  void press(const KeyPress& press);
  void release(int key);
  /// A character that was typed, where words are written.
  void type(char32_t character) {
    if (frame_.marks.typing) marking_.type(character);  // and not the key that has begun the words
  }
  void act(Action action);
  /// An exhibit's next visitor finds nothing of the one before: pressed hand, focus, guide, speech, settings, view.
  /// `first`: the settings at the start.
  void welcome_next(const ViewSettings& first);

  /// Mouse, pixels in the window; `view` is the picture's detail view and `layout` where it lies.
  void mouse_move(double x, double y, const Layout& layout, const View& view, const Stage& stage,
                  const HeightAt& height);
  /// A picture was drawn. A hand that followed the mouse since the picture before goes where the mouse points in this
  /// one: keys pressed just before may have moved or split the detail view.
  void picture_drawn(const Layout& layout, const View& view);
  void mouse_button(int button, bool down, int modifiers);  ///< 0 left, 1 right, 2 middle
  void mouse_wheel(double steps, int modifiers);
  /// What the interface has drawn and can be clicked; later ones lie on top.
  void set_boxes(std::vector<Clickable> boxes, int help_pages) {
    boxes_ = std::move(boxes);
    help_pages_ = help_pages;
  }

  /// One step of time: state in, announcements in, camera eased, pointer sample out. `height_at`: of the surface that
  /// is touched; `drawn_at`: of the one that is seen, if it is another.
  void update(double time_s, const haptics::State& state, int width, int height, const HeightAt& height_at,
              const HeightAt& drawn_at = {});
  [[nodiscard]] const Frame& frame() const { return frame_; }
  [[nodiscard]] Frame& frame() { return frame_; }
  [[nodiscard]] bool wants_to_leave() const { return leave_; }
  /// True once when the raw scans are asked for.
  [[nodiscard]] bool takes_to_scans() { return std::exchange(to_scans_, false); }
  [[nodiscard]] const ViewSettings& settings() const { return frame_.settings; }
  /// Buttons that the bar shows now.
  [[nodiscard]] std::vector<Action> buttons() const;
  /// True once for each time that a picture on disk, or the other of full screen and window, was asked for.
  [[nodiscard]] bool take_screenshot_wish() { return std::exchange(screenshot_, false); }
  [[nodiscard]] bool wants_screenshot() const { return screenshot_; }
  [[nodiscard]] bool take_full_screen_wish() { return std::exchange(full_screen_, false); }
  /// While nobody is there, faults are not on the picture.
  void hide_faults(bool on) { toasts_.hide_faults(on); }
  /// Shows words and has them spoken.
  void tell(const std::string& text,
            haptics::Announcement::Priority priority = haptics::Announcement::Priority::information);

 private:
  /// What the left button holds while it is down.
  enum class Grip { none, hand, camera, light, overview, box, mark, object };

  // Each carries out the actions that are its own, and gives false for all others.
  bool step_hand(Action action);
  bool set_light(Action action);
  bool move_camera(Action action);
  bool set_view(Action action);
  bool set_stereo(Action action);
  void begin_drag();
  void drag_hand(const Eigen::Vector2d& from, const View& view);
  void turn_light(const Eigen::Vector2d& moved);
  void turn_object();
  void ask_rescan();
  void go_to_scans();
  void save_strip();
  bool set_marks(Action action);
  void set_contours(bool finer);
  [[nodiscard]] Marking::Aim aim();
  void answer(bool yes);
  void go_home();
  void close_or_leave();
  void leave();
  void move_focus(int step);
  void press_left(int modifiers);
  void release_left();
  [[nodiscard]] std::optional<Clickable> box_at(const Eigen::Vector2d& place) const;
  void go_to_overview(const Eigen::Vector2d& place);
  void centre_on(const Eigen::Vector2d& place);
  [[nodiscard]] Window window() const;
  [[nodiscard]] Ground ground(const Window& window, const HeightAt& height_at) const;
  [[nodiscard]] double reach_m() const;  ///< of the hand to each side, device frame

  Connections connections_;
  scene::ScenePointer scene_;
  Stage stage_;
  Frame frame_;
  bool leave_ = false, to_scans_ = false, screenshot_ = false, full_screen_ = false;

  Orbit orbit_;
  PointerHand hand_;
  Toasts toasts_;
  Wishes wishes_;
  Marking marking_;
  HeightAt drawn_at_;  // of the last update

  std::vector<Clickable> boxes_;
  int help_pages_ = 1;
  Layout layout_;  // of the last move of the mouse
  std::optional<View> view_;
  bool aimed_ = false;  // since the last picture
  Eigen::Vector2d mouse_ = Eigen::Vector2d::Zero();
  Grip grip_ = Grip::none;
  std::optional<Clickable> gripped_;
  Eigen::Vector2d turned_px_ = Eigen::Vector2d::Zero();  // of a drag that turns the object, not yet asked for
  bool right_down_ = false, middle_down_ = false;
  int drag_key_ = 0;             // while it is down, the hand drags the stone
  double overview_s_ = -1.0;     // when the window was sent there last
  bool overview_waits_ = false;  // the mouse has gone on since
  double clicked_s_ = -1.0;
  Eigen::Vector2d clicked_ = Eigen::Vector2d::Zero();
  int light_preset_ = 0;
  bool came_ = false;     // a scene, since the last update
  double came_s_ = -1e9;  // when
};

}  // namespace sparsha::viewer
