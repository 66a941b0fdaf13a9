// Everything between a hand position and a force, for one tick: no allocation, no locks, no system calls, no
// exceptions. The servo's thread drives it in real time; tests and offline tools may drive it by hand.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>

#include <Eigen/Geometry>

#include "haptics/device/device.h"
#include "haptics/effects/effect_forces.h"
#include "haptics/governor/governor.h"
#include "haptics/governor/look_meter.h"
#include "haptics/guide/guidance.h"
#include "haptics/proxy/proxy.h"
#include "haptics/servo/command.h"
#include "haptics/servo/contact_events.h"
#include "haptics/servo/object_hand.h"
#include "haptics/servo/record.h"
#include "haptics/servo/swap_fade.h"
#include "haptics/state/state.h"
#include "scene/config/haptics.h"

namespace sparsha::haptics {

struct RendererOptions {
  double rate_hz = 1000.0;
  double stiffness_n_per_m = 800.0;  ///< the wish; rendered is what the device can bear
  scene::HapticsConfig::Solver solver = scene::HapticsConfig::Solver::exact;
  SolverOptions solver_options{.shape = CellShape::rounded};
  /// Later than planned by more is a fault, and so is longer without news of the hand and kLongestGapTicks of its
  /// samples: forces need free space again.
  double longest_gap_s = 0.010;
};

/// What a recording adds to a hand position, so that a replay gives the same bits.
struct RecordedTick {
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();  ///< grid point at the device frame's origin
  double stiffness_n_per_m = 0.0;
  double period_s = 0.001;          ///< that the governor saw
  double nominal_period_s = 0.001;  ///< of the recorded servo's plan
  std::uint64_t command = 0;
  std::uint64_t flags = 0;  ///< StateFlag bits of the recorded tick
  Eigen::Quaterniond turn = Eigen::Quaterniond::Identity();
  Eigen::Vector3d guide_n = Eigen::Vector3d::Zero();  ///< what State holds of the guide
  double guide_stored_j = 0.0;
  double guide_supplied_j = 0.0;
};

class HapticRenderer {
 public:
  /// The device frame's origin begins at `window`'s centre, z of the surface there.
  HapticRenderer(const DeviceInfo& device, const RendererOptions& options, HapticWindow window);

  /// Takes a sample to a force: state().commanded_force_n. `nominal_period_s` stands for the first tick's length.
  void update(const DeviceSample& sample, double nominal_period_s) noexcept;

  /// The same for a tick of a recording, with its centre, stiffness, times and faults instead of this run's.
  void replay(const DeviceSample& sample, const RecordedTick& recorded) noexcept;

  /// Solves and governs the last hand position once more on copies and discards the result: the core that wakes from
  /// sleep then has the next tick's code and data in its caches. Changes nothing.
  void rehearse() const noexcept;

  /// Carries out a command; a surface that is no longer needed is moved into the return value.
  [[nodiscard]] SurfacePointer apply(Command& command) noexcept;

  /// Zero force from now on until the hand has been in free space (watchdog, unplugging); this tick is flagged.
  void fault() noexcept { fault_ = true; }
  /// The same for the tick that was just updated: its force is zero after all.
  void fail() noexcept;

  [[nodiscard]] const State& state() const noexcept { return record_.state; }
  [[nodiscard]] State& state() noexcept { return record_.state; }
  [[nodiscard]] const Record& record() const noexcept { return record_; }
  /// What the last update had to say.
  [[nodiscard]] const std::optional<ContactEvent>& event() const noexcept { return event_; }
  [[nodiscard]] const HapticWindow& window() const noexcept { return window_; }
  /// What the last rendered tick found, local frame of the window; of a whole object the place in its frame, and the
  /// normal along the axes of the device.
  [[nodiscard]] const ProxyUpdate& found() const noexcept { return found_; }
  /// What lies between the nodes for the solver at work.
  [[nodiscard]] CellShape shape() const noexcept;
  [[nodiscard]] std::uint64_t faults() const noexcept { return faults_; }
  /// Between two looks of a device that repeats positions without saying so; 0 for one that does not.
  [[nodiscard]] double look_s() const noexcept { return looks_.pace_s(); }
  /// Ticks whose position was not a number.
  [[nodiscard]] std::uint64_t bad_positions() const noexcept { return bad_positions_; }

 private:
  /// What a tick has found under the hand.
  struct Touched {
    Eigen::Vector3d hip_m;      // grid frame
    Eigen::Vector3d proxy_m;    // likewise
    Eigen::Vector3d away;       // from the hand to the proxy, grid metres along the axes of the device
    Eigen::Vector3d travelled;  // of the proxy since the last tick, likewise
    Eigen::Vector3d normal;     // grid frame
  };
  /// A whole object that is to be turned or moved under the hand.
  struct Placement {
    std::optional<Eigen::Quaterniond> turn;
    std::optional<Eigen::Vector3d> centre_m;
  };
  [[nodiscard]] Touched touch_view() noexcept;
  [[nodiscard]] Touched touch_object() noexcept;
  [[nodiscard]] Eigen::Vector3d hip_on_object_m(const Eigen::Vector3d& hand_m) const noexcept;
  void swap_object(Command& command) noexcept;
  void leave_object(const Command& command) noexcept;
  void place_object(const Eigen::Vector3d& hand_m) noexcept;
  void release() noexcept;
  void turn_object(const Eigen::Quaterniond& turn) noexcept;
  void drag_object(const Eigen::Vector3d& hand_m) noexcept;
  void lift(const Eigen::Vector3d& hand_m) noexcept;
  [[nodiscard]] Eigen::Vector3d point_on(const Eigen::Vector2d& centre_m) const noexcept;
  void rehearse_object() const noexcept;
  void govern_once_more(const ProxyUpdate& found, const Eigen::Vector3d& away) const noexcept;
  [[nodiscard]] std::uint64_t find_place_on_object() noexcept;
  void swap(Command& command) noexcept;
  void scroll() noexcept;
  /// What this tick counts as in time constants: a gap is one tick.
  [[nodiscard]] double step_s() const noexcept { return std::min(record_.period_s, pace_s_); }
  void set_dragging(bool on) noexcept;
  void drag(const Eigen::Vector3d& hand_m) noexcept;
  void let_go(const Eigen::Vector3d& hand_m) noexcept;
  [[nodiscard]] static bool is_place(const DeviceSample& sample) noexcept;
  void tick(const DeviceSample& sample, bool fault) noexcept;
  void describe_tick(const DeviceSample& sample) noexcept;
  void render(const DeviceSample& sample) noexcept;
  [[nodiscard]] ProxyUpdate solve(const Eigen::Vector3d& hip_local, ProxyState& proxy) const noexcept;
  void begin_fade() noexcept;
  [[nodiscard]] double wished_stiffness() noexcept;
  void add_effects(GovernorInput& input, const Eigen::Vector3d& moved_m) noexcept;
  void add_guide(GovernorInput& input, const Eigen::Vector3d& hip_m, bool fresh) noexcept;
  [[nodiscard]] Guidance::Output guide(const Eigen::Vector3d& hip_m) noexcept;
  [[nodiscard]] double height_above_m(const Eigen::Vector3d& hip_m) const noexcept;
  [[nodiscard]] double away_m(const Eigen::Vector3d& hip_m) const noexcept;
  [[nodiscard]] GovernorInput governor_input(const DeviceSample& sample, const Eigen::Vector3d& away_m,
                                             const Eigen::Vector3d& force_n) noexcept;
  void render_invalid_sample(const DeviceSample& sample) noexcept;
  void make_safe() noexcept;
  [[nodiscard]] std::array<double, 3> place_of(const Eigen::Vector3d& grid_m) const noexcept;
  [[nodiscard]] std::uint64_t find_place(const Eigen::Vector3d& local) noexcept;

  DeviceInfo device_;
  RendererOptions options_;
  HapticWindow window_;
  const MongeSurface* surface_;         // window_.surface.get()
  Eigen::Vector3d centre_m_;            // grid point at the device frame's origin
  ObjectHand object_;                   // of a window that has an object
  std::optional<Placement> placement_;  // until a hand position is known
  AroundUpdate around_;                 // what the last rendered tick found
  bool placed_anew_ = false;            // before this tick
  Eigen::Vector3d scroll_m_per_s_ = Eigen::Vector3d::Zero();
  double wish_n_per_m_;
  double stiffness_n_per_m_;  // of this tick
  Governor governor_;
  ContactEvents events_;
  std::optional<ContactEvent> event_;
  ProxyState proxy_;
  ProxyUpdate found_;
  SwapFade fade_;
  EffectForces effects_;
  LookMeter looks_;         // of the device's encoders
  bool repeated_ = false;   // the position of this tick was found to be that of a look before
  double unheard_s_ = 0.0;  // since a sample that the device called fresh
  Guidance guidance_;
  std::optional<Guidance::Output> recorded_guide_;         // of a replay
  Eigen::Vector3d guided_at_m_ = Eigen::Vector3d::Zero();  // the centre in the last tick
  bool armed_ = false;                                     // in the last tick
  Eigen::Vector3d felt_n_ = Eigen::Vector3d::Zero();       // what the governor was given last
  Eigen::Vector3d hand_m_ = Eigen::Vector3d::Zero();       // last finite hand position, device frame
  std::uint64_t place_flags_ = 0;                          // of where the proxy was in the last tick
  bool placed_ = false;                                    // the proxy has been started
  bool fault_ = false;
  bool dragging_ = false;
  bool letting_go_ = false;  // dragging until a hand position is known
  bool dragged_ = false;     // in the last tick
  bool swapped_ = false;     // since the last update: the recorded centre is then the swap's own
  bool has_time_ = false;
  double pace_s_ = 0.001;  // of the loop
  double stale_s_ = 0.0;   // without a fresh sample
  double last_time_s_ = 0.0;
  double slip_speed_ = 0.0;
  std::uint64_t faults_ = 0;
  std::uint64_t bad_positions_ = 0;
  Record record_;
};

}  // namespace sparsha::haptics
