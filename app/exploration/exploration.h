// One run of `sparsha explore`: a session, and all that looks on, listens and speaks.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "app/commands/commands.h"
#include "app/exploration/device_choice.h"
#include "app/exploration/exhibits.h"
#include "app/exploration/explore_arguments.h"
#include "app/exploration/live_sound.h"
#include "app/exploration/speaker.h"
#include "app/raw_scans/open_scans.h"
#include "app/terminal/hand_keys.h"
#include "app/terminal/terminal.h"
#include "app/terminal/terminal_keys.h"
#include "base/phrases/phrases.h"
#include "base/system/terminal.h"
#include "haptics/replay/recorded_scenes.h"
#include "haptics/session/session.h"
#include "scene/scene_fwd.h"
#include "viewer/viewer.h"

namespace sparsha::app {

/// Remembers the last moment in which the hand felt the scene that is touched, and the seconds before it, so that a
/// picture taken after the run shows the touch.
class LastTouch {
 public:
  void see(const haptics::State& now);
  [[nodiscard]] const haptics::State& state() const { return state_; }
  /// Ends at state().
  [[nodiscard]] const viewer::Strip& strip() const { return shown_ ? strip_ : strip_then_; }

 private:
  haptics::State state_;
  viewer::Strip strip_, strip_then_;  ///< until now; until the last touch, when that is over
  bool felt_ = false, shown_ = false;
};

/// One thread, the one that shows the window.
class Exploration {
 public:
  /// Opens or builds what `arguments` name and chooses the device. `window`: there will be one. `arguments` and
  /// `terminal` must outlive the run. Throws Error of what cannot be opened.
  Exploration(const ExploreArguments& arguments, const CommonOptions& common, Terminal& terminal, bool window);
  /// Until the device, the user or the clock ends it.
  void run(bool window);
  /// Writes and prints what the command line asked for; one output that fails keeps no other from it. Throws the first
  /// Error.
  void deliver(const CommonOptions& common);

 private:
  using Clock = std::chrono::steady_clock;

  [[nodiscard]] scene::SpeechConfig speech() const;
  [[nodiscard]] bool speaks(const scene::ScenePointer& scene) const;
  [[nodiscard]] bool over() const;
  void start();
  void deliver_nothing() const;

  // Without a window.
  void wait_headless();
  void use_keys();
  void move_hand(std::vector<TypedKey>& keys, double now_s);
  [[nodiscard]] HandKeys::Wish wish_of_keys(const haptics::State& state);

  // With one.
  void run_windows();
  viewer::WindowEnd run_window(bool again = false);
  void connect_session();

  // What has happened since the last call: depth scans, warnings, announcements.
  void poll();
  void take_scan();
  void tell_of_scans();
  void tell_of_speech();
  void warn(Phrase phrase, const PhraseValues& values = {});
  void announce(Phrase phrase, const PhraseValues& values = {},
                haptics::Announcement::Priority priority = haptics::Announcement::Priority::information);

  // Another scene or other scans (exploration_scenes.cpp).
  [[nodiscard]] std::unique_ptr<haptics::Session> session_of(const scene::ScenePointer& scene);
  void make_session_of(scene::ScenePointer scene, bool needs_sound = true);
  void begin_with(const scene::ScenePointer& scene);
  [[nodiscard]] std::unique_ptr<audio::Engine> sound_of(const scene::ScenePointer& scene);
  void change_scene(const scene::ScenePointer& scene);
  void change_sound(std::unique_ptr<audio::Engine> sound);
  void change_speech(const scene::ScenePointer& before);
  void follow_recording();
  void refuse(const std::string& why);
  void next_scene(int step);
  void drop(const std::vector<std::filesystem::path>& files);
  void drop_scene(const std::filesystem::path& folder);
  void save_scene();
  void rescan(const Eigen::Matrix4d& scan_to_grid);
  bool edit_parts(const std::vector<scene::PartConfig>& parts);

  const ExploreArguments& arguments_;
  Terminal& terminal_;
  scene::Trust trust_;
  Exhibits exhibits_;  ///< of a kiosk with several scenes
  ChosenDevice chosen_;
  std::optional<haptics::RecordedScenes> kept_;  ///< with a recording of several scenes
  scene::ScenePointer scene_;
  scene::ScenePointer before_;  ///< the scene that was touched before
  std::unique_ptr<haptics::Session> session_;
  std::shared_ptr<haptics::ContactQueue> contacts_;
  LiveSound sound_;
  std::optional<Speaker> speaker_;
  bool told_of_speech_ = false;
  std::optional<system::TerminalInput> keys_;  ///< without a window
  TypedKeys typed_;
  TerminalKeys meanings_;
  HandKeys hand_keys_;                                ///< where keys move the hand
  Eigen::Vector2d scroll_ = Eigen::Vector2d::Zero();  ///< asked for last
  OpenScans scans_;
  viewer::Connections connections_;
  std::uint64_t notes_ = 0, work_ = 0;
  bool to_scans_ = false;
  LastTouch touch_;
  std::uint64_t heard_ = 0;
  Clock::time_point began_;
};

}  // namespace sparsha::app
