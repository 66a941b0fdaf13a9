// Owns scene, servo, window loader and recorder; the one place where buttons, keys and requests become level, window
// and scene changes, and words.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "base/phrases/phrases.h"
#include "haptics/device/device.h"
#include "haptics/replay/recorded_scenes.h"
#include "haptics/servo/command.h"
#include "haptics/state/requests.h"
#include "haptics/state/seqlock.h"
#include "haptics/state/spsc_queue.h"
#include "haptics/state/state.h"
#include "scene/scene_fwd.h"

namespace sparsha::haptics {

struct SessionOptions {
  scene::HapticsConfig haptics;  ///< wishes; the device limits them
  Effects effects;
  std::filesystem::path record;  ///< run.csv; empty = none. Beside it the scenes are kept when there are several
  bool real_time = true;         ///< ask for SCHED_FIFO and locked memory
  double longest_gap_s = 0.010;  ///< lateness that ends the force; longer only where no hand holds the device
  std::string language = "en";   ///< of what is announced; see set_speech()
  bool by_keys = false;          ///< keys move the hand: help says how, and heights are announced
  bool grip = true;              ///< the hand holds a grip with buttons, which the tour teaches; else the keys
  bool speaks = false;           ///< announcements are spoken from the start: the first one says how to get help
};

/// What a run amounted to; printed at its end and used by user studies.
struct SessionSummary {
  std::uint64_t ticks = 0;
  std::uint64_t missed_ticks = 0;
  double share_in_time = 1.0;  ///< ticks begun within 1 ms of plan
  bool real_time = false;      ///< SCHED_FIFO was granted
  double duration_s = 0.0;
  double processor_s = 0.0;  ///< of all threads of the program, from start() to stop()
  double contact_s = 0.0;
  std::uint64_t contacts = 0;
  double path_m = 0.0;        ///< of the hand, device frame
  double mean_force_n = 0.0;  ///< while in contact
  double peak_force_n = 0.0;
  double area_m2 = 0.0;     ///< scene cells touched, grid frame
  std::vector<int> levels;  ///< used
  double tick_ns_p50 = 0, tick_ns_p99 = 0, tick_ns_p999 = 0, tick_ns_max = 0;
  std::vector<std::uint64_t> lateness_histogram;  ///< 20 bins of 100 us, the last one open
  double late_ns_max = 0.0;                       ///< of a tick's begin
  std::uint64_t unfinished = 0;
  std::uint64_t faults = 0;
  std::uint64_t dropped_records = 0;
  std::uint64_t watchdog_trips = 0;
  std::uint64_t late_faults = 0;  ///< pauses of over 10 ms that the servo itself noticed
  std::uint64_t runaways = 0;     ///< ticks without force that the device asked for far too soon
  std::uint64_t jumps = 0;        ///< positions that no hand can have come to
  bool locked_memory = false;
  double stiffness_n_per_m = 0.0;  ///< rendered at the end: min(requested, what the device can bear)
  std::uint64_t windows_loaded = 0;
  double window_load_s_max = 0.0;  ///< off the servo thread
  double swap_ns_max = 0.0;        ///< what a change of window cost the servo
};

/// Construct, start(), poll() about every 10 ms from one thread until finished(), stop().
class Session {
 public:
  /// Loads the first window. Throws Error.
  Session(scene::ScenePointer scene, std::unique_ptr<Device> device, SessionOptions options);
  /// Shows a recording that has windows instead of serving a hand, on the scenes that it was made on; requests but
  /// `describe` and `quit` are not served. Throws Error{input} when it was made on others.
  Session(RecordedScenes scenes, std::shared_ptr<const Recording> recording, SessionOptions options);
  ~Session();
  Session(const Session&) = delete;
  Session& operator=(const Session&) = delete;

  void start();
  /// Serves requests, buttons, window changes and announcements.
  void poll();
  [[nodiscard]] bool finished() const;
  /// Ends in zero force and writes what was promised. Throws Error when the recording or its scenes could not be
  /// written, or a window of the recording that is played could not be read; called once more it gives the summary all
  /// the same.
  SessionSummary stop();

  [[nodiscard]] const Seqlock<State>& state() const;
  [[nodiscard]] RequestQueue& requests();
  [[nodiscard]] AnnouncementBoard& announcements();
  /// In the session's language, for what others have to announce.
  [[nodiscard]] const Phrases& phrases() const;
  /// A queue of contact events for one more consumer; call before start().
  [[nodiscard]] std::shared_ptr<ContactQueue> add_contact_consumer();
  /// The scene that is touched, or shall be as soon as its window is loaded; of a recording that of the last poll()'s
  /// tick.
  [[nodiscard]] scene::ScenePointer scene() const;
  /// The box of the whole object that the hand goes around, grid frame; nothing for one view.
  [[nodiscard]] std::optional<Eigen::AlignedBox3d> whole_object_m() const;
  /// z of the first surface of the whole object before a place of the workspace, device frame; far behind where there
  /// is none, NaN for one view.
  [[nodiscard]] double object_before_m(const Eigen::Vector2d& device_m) const;
  [[nodiscard]] bool plays_recording() const;
  /// A new scene, e.g. after a new depth scan; the hand keeps its place. A run that is recorded keeps it and the ones
  /// before. Throws Error{usage} when a recording is played.
  void set_scene(scene::ScenePointer scene);
  /// What is announced from now on is in this language; `speaks`: announcements are spoken, which is said where it is
  /// new. `first_speaks`: whether it is so for the next visitor, where that is not `speaks`. Throws Error{usage} for a
  /// language without texts.
  void set_speech(const std::string& language, bool speaks, std::optional<bool> first_speaks = {});

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace sparsha::haptics
