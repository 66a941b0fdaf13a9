// What the servo tells the world each tick: one trivially copyable struct of 64-bit words.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <type_traits>

namespace sparsha::haptics {

/// Bits of State::flags.
enum StateFlag : std::uint64_t {
  kFlagSticking = 1U << 0,      ///< friction holds the proxy
  kFlagUnknownArea = 1U << 1,   ///< the proxy is over a node that was never measured or filled (frictionless)
  kFlagOutside = 1U << 2,       ///< the proxy is outside the scene's lattice
  kFlagWindowBorder = 1U << 3,  ///< the proxy is within a cell of the window's border
  kFlagSaturated = 1U << 4,     ///< the governor limited the force
  kFlagArmed = 1U << 5,         ///< forces are delivered
  kFlagStale = 1U << 6,         ///< no fresh position: the force of before, or zero (stale_after_s())
  kFlagFault = 1U << 7,         ///< watchdog, NaN or unplugging; force is zero
  kFlagUnfinished = 1U << 8,    ///< the proxy goes on next tick
  kFlagFilledArea = 1U << 9,    ///< the proxy is over filled nodes
  kFlagRealTime = 1U << 10,     ///< SCHED_FIFO was granted
  kFlagHomed = 1U << 11,        ///< the device knows its absolute position
  kFlagTexture = 1U << 12,      ///< the surface with its texture is rendered (else its envelope)
  kFlagFriction = 1U << 13,     ///< friction is rendered
  kFlagRounded = 1U << 14,      ///< the bilinear surface's creases are rounded
  kFlagImpact = 1U << 15,       ///< strikes ring, which is invented
  kFlagGrain = 1U << 16,        ///< grain finer than the scan is rendered, which is invented
  kFlagDragged = 1U << 17,      ///< the hand drags the window; nothing is touched meanwhile
  kFlagGuided = 1U << 18,       ///< a guide acts on the hand
  kFlagCues = 1U << 19,         ///< ticks tell what the hand has come to
  kFlagFalls = 1U << 20,        ///< beyond an outline the surface falls away; else it is continued
  kFlagRim = 1U << 21,          ///< with kFlagFalls: after a felt rim
  kFlagAround = 1U << 22,       ///< a whole object is touched, from all sides
  kFlagPlaced = 1U << 23,       ///< the whole object was turned or moved, and let go of, before this tick
  kFlagRepeated = 1U << 24,     ///< the device calls the position fresh, but it is that of a look before
};

/// What the guide does with the hand.
enum class GuidePhase : std::uint64_t {
  off,      ///< there is no line
  waiting,  ///< the hand is not near the line yet
  leading,
  let_go,  ///< the hand has left; near the line it is led again
};

/// Positions in metres. Grid frame unless said otherwise; forces in newtons, device frame.
struct State {
  std::uint64_t tick = 0;
  double time_s = 0.0;                        ///< since the servo started, of this sample
  std::array<double, 3> hip_m{};              ///< haptic interaction point X_h
  std::array<double, 3> proxy_m{};            ///< X_p
  std::array<double, 3> place_m{};            ///< touched_place() in the frame of the scene's parts and sounds
  std::array<double, 3> normal{};             ///< unit surface normal at the proxy, grid frame; 0 when free
  std::array<double, 3> force_n{};            ///< the renderer's force k * scale * (X_p - X_h), before the governor
  std::array<double, 3> commanded_force_n{};  ///< what the device was told
  double given_share = 1.0;                   ///< of the force before the governor that the hand was given, 0 to 1
  std::array<double, 3> device_m{};           ///< hand position, device frame
  std::array<double, 3> centre_m{};           ///< grid point that is the device frame's origin
  double scale = 1.0;                         ///< device metres per grid metre
  /// Quaternion x, y, z, w from the grid frame's axes to the device frame's: device = scale * turn * (grid - centre).
  /// Only a whole object is ever turned.
  std::array<double, 4> turn{0.0, 0.0, 0.0, 1.0};
  /// Of the grip, a unit quaternion w, x, y, z in the device frame: turns the stylus from along +z, its tip at the
  /// hand. All zero where the device does not measure it.
  std::array<double, 4> orientation{};
  double penetration_m = 0.0;         ///< |X_p - X_h|, device frame
  double slip_speed_m_per_s = 0.0;    ///< of the proxy along the surface, device frame
  double friction_coefficient = 0.0;  ///< mu_d at the proxy
  double tick_ns = 0.0;               ///< from hand position in hand to force decided
  double late_ns = 0.0;               ///< wake-up after the planned instant
  double share_in_time = 1.0;         ///< ticks begun within 1 ms of plan, of all so far
  std::uint64_t contact = 0;          ///< 1 in contact
  double touched_s = -1e9;            ///< when stone last gave the hand a force: no reader is too slow for a touch
  std::uint64_t level = 0;
  std::uint64_t surface_id = 0;                   ///< counts swaps of window, level or scene
  std::uint64_t scene = 1;                        ///< counts the scenes that the session was given
  std::uint64_t command = 0;                      ///< sequence number of the last command applied
  std::uint64_t buttons = 0;                      ///< down now
  std::array<std::uint64_t, 4> button_presses{};  ///< of the first four, so far: no reader is too slow for a click
  std::uint64_t flags = 0;                        ///< StateFlag bits
  double workspace_m = 0.0;                       ///< width of the device's workspace, device frame
  double stiffness_n_per_m = 0.0;                 ///< rendered in this tick
  double stiffness_limit_n_per_m = 0.0;           ///< that the loop bears as it is measured; 0: not yet known
  double tip_radius_m = 0.0;                      ///< of the fingertip, device frame
  std::array<std::int64_t, 4> window{};           ///< nodes of the level: first i, first j, how many in i, in j
  GuidePhase guide = GuidePhase::off;
  std::uint64_t guide_rounds = 0;       ///< times that the whole line has been led along since the guide came on
  std::array<double, 3> guide_n{};      ///< of the guide, device frame, before the governor; of one view z = 0
  double guide_stored_j = 0.0;          ///< in the guide's springs
  double guide_supplied_j = 0.0;        ///< put into them in this tick by what leads; taken out where negative
  std::array<std::uint64_t, 5> cues{};  ///< so far, in the order of scene::Cue
  double away_m = 0.0;                  ///< of the hand from the stone, device frame; 0 also where it is not measured
  std::uint64_t missed_ticks = 0;       ///< skipped since the start
  std::uint64_t dropped_records = 0;    ///< rows the recorder could not take
};

static_assert(std::is_trivially_copyable_v<State>);
static_assert(sizeof(State) % 8 == 0);

/// Where the fingertip touches the stone, grid frame; X_p when it is a point or free. X_p moves on the surface of a
/// ball's centre, lowered by its radius, and the ball touches along the normal.
[[nodiscard]] inline std::array<double, 3> touched_place(const State& state) noexcept {
  std::array<double, 3> place = state.proxy_m;
  if (state.contact == 0 || !(state.tip_radius_m > 0.0)) return place;
  const double radius_m = state.tip_radius_m / state.scale;
  for (std::size_t axis = 0; axis < place.size(); ++axis)
    place[axis] += radius_m * ((axis == 2 ? 1.0 : 0.0) - state.normal[axis]);
  return place;
}

/// One contact's beginning or end, for audio and speech.
struct ContactEvent {
  enum class Kind : std::uint64_t { touch, lift, slip };
  Kind kind = Kind::touch;
  double time_s = 0.0;                ///< servo time
  std::array<double, 3> proxy_m{};    ///< grid frame
  std::array<double, 3> place_m{};    ///< touched_place() in the frame of the scene's parts and sounds
  double normal_speed_m_per_s = 0.0;  ///< of the hand towards the surface, device frame, low-passed
  double peak_force_n = 0.0;          ///< predicted peak v_n * sqrt(k m), newtons; 0 where the hand gets no force
  std::uint64_t level = 0;
};
static_assert(std::is_trivially_copyable_v<ContactEvent>);

/// Where the pointer device's hand is wanted; written by the viewer, read by the pointer device.
struct PointerSample {
  std::array<double, 3> device_m{};  ///< device frame
  std::uint64_t buttons = 0;
  std::uint64_t sequence = 0;      ///< counts samples; 0 = none yet
  double most_force_n = 0.0;       ///< the hand gives way to more; 0: to none
  double stiffness_n_per_m = 0.0;  ///< of the stone, as the writer knows it; the hand gives way by it
};
static_assert(std::is_trivially_copyable_v<PointerSample>);

}  // namespace sparsha::haptics
