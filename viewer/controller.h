// Turns keys, buttons and the mouse into requests, settings, camera and the pointer device's hand; makes the frames.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "viewer/actions.h"
#include "viewer/frame.h"
#include "viewer/viewer.h"

namespace sparsha::viewer {

/// Knows neither windows nor graphics; the window feeds it.
class Controller {
 public:
  Controller(const Connections& connections, const ViewSettings& settings);

  /// Height of the drawn surface at x, y (grid frame, metres).
  using HeightAt = std::function<double(double x_m, double y_m)>;

  void set_scene(pipeline::ScenePointer scene);
  void press(const KeyPress& press);
  void act(Action action);

  /// Mouse, pixels in the window; `view` is the picture's detail view and `layout` where it lies.
  void mouse_move(double x, double y, const Layout& layout, const View& view, const Stage& stage,
                  const HeightAt& height);
  void mouse_button(int button, bool down, int modifiers);  ///< 0 left, 1 right, 2 middle
  void mouse_wheel(double steps, int modifiers);

  /// One step of time: state in, announcements in, camera eased, pointer sample out.
  void update(double time_s, const haptics::State& state, int width, int height, const HeightAt& height_at);
  [[nodiscard]] const Frame& frame() const { return frame_; }
  [[nodiscard]] Frame& frame() { return frame_; }
  [[nodiscard]] bool wants_to_leave() const { return leave_; }
  /// True once when the raw scans are asked for.
  [[nodiscard]] bool takes_to_scans() { return std::exchange(to_scans_, false); }
  [[nodiscard]] const ViewSettings& settings() const { return frame_.settings; }
  /// Buttons that the bar shows now.
  [[nodiscard]] std::vector<Action> buttons() const;

 private:
  void post(haptics::Request::Kind kind, double x = 0.0, double y = 0.0, bool on = false);
  void tell(const std::string& text,
            haptics::Announcement::Priority priority = haptics::Announcement::Priority::information);
  // Each carries out the actions that are its own, and gives false for all others.
  bool ask_session(Action action);
  bool step_hand(Action action);
  bool set_light(Action action);
  bool move_camera(Action action);
  bool set_view(Action action);
  void next_stereo();
  void close_or_leave();
  void leave();
  void move_focus(int step);
  void ease_camera(double seconds, int width, int height);
  void move_hand(double seconds, const HeightAt& height_at);
  void take_announcements(double time_s);
  [[nodiscard]] double step_m() const;
  [[nodiscard]] double reach_m() const;  ///< of the hand to each side, device frame

  Connections connections_;
  pipeline::ScenePointer scene_;
  Stage stage_;
  Frame frame_;
  bool leave_ = false;
  bool to_scans_ = false;
  bool first_ = true;

  // The camera relative to the window.
  double turn_rad_ = 0.0, tilt_rad_ = 0.0, zoom_ = 1.0;
  Eigen::Vector2d shift_ = Eigen::Vector2d::Zero();  // in window widths

  // The hand of the pointer device.
  Eigen::Vector2d hand_m_ = Eigen::Vector2d::Zero();  // device frame
  double offset_m_ = 0.0;                             // above the surface, device frame
  double press_m_ = 0.0;                              // depth of a press
  double hand_z_m_ = 0.0;
  bool hand_known_ = false, pressed_ = false, left_down_ = false, right_down_ = false, middle_down_ = false;
  std::uint64_t sequence_ = 0;
  Eigen::Vector2d mouse_ = Eigen::Vector2d::Zero();

  struct Shown {
    haptics::Announcement announcement;
    double until_s = 0.0, length_s = 1.0;
  };
  std::vector<Shown> shown_;
  std::vector<haptics::Announcement> own_;
  std::uint64_t seen_ = 0;
};

/// The camera that frames a window: `zoom` 1 fits it into the rectangle.
[[nodiscard]] Camera camera_for(const Window& window, const Stage& stage, double turn_rad, double tilt_rad, double zoom,
                                const Eigen::Vector2d& shift, const Rect& rect);

inline constexpr double kStandardTiltRad = 0.50;

}  // namespace sparsha::viewer
