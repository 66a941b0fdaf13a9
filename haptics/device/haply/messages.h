// What the Inverse Service says and is told. Own frame of the service: x right, y forward, z up, metres and newtons.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

namespace sparsha::haptics::haply {

/// A device's name as the service gives it; longer ones are cut, and then match nothing.
struct DeviceId {
  std::array<char, 48> text{};
  std::size_t size = 0;
  void set(std::string_view id) noexcept;
  [[nodiscard]] std::string_view view() const noexcept { return {text.data(), size}; }
  [[nodiscard]] bool operator==(std::string_view id) const noexcept { return view() == id; }
};

/// What one message tells of one Inverse3 and of the grips.
struct ServiceState {
  bool has_session = false;
  int inverses = 0;           ///< in the list of them
  DeviceId first;             ///< of that list
  bool found = false;         ///< the wanted one is in it (the first, where none was wanted)
  bool has_position = false;  ///< all three coordinates
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();
  bool has_force = false;  ///< what the service lets through to the motors
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  bool has_velocity = false;
  Eigen::Vector3d velocity_m_per_s = Eigen::Vector3d::Zero();
  double damping_n_s_per_m = -1.0;                ///< config.filters.damping.scalar; negative: not told
  bool has_basis = false, right_basis = false;    ///< config.basis.permutation, and it is XYZ
  bool has_preset = false, right_preset = false;  ///< config.preset, and it is kPreset
  bool displaced = false;                         ///< state.transform moves, turns or scales what the service tells
  bool uncalibrated = false;                      ///< status.calibrated is false
  std::array<double, 4> orientation{};  ///< of the first grip: w, x, y, z; all zero where it tells not all of them
  std::uint64_t buttons = 0;            ///< a, b, c as bits 0, 1, 2
  bool is_state = false;                ///< it has a list of Inverse3

  [[nodiscard]] bool tells_settings() const noexcept { return has_basis || has_preset; }
  [[nodiscard]] bool is_set_up() const noexcept {
    return has_basis && right_basis && has_preset && right_preset && !displaced;
  }
};

/// False when the message is no JSON object, a number of it is none, or it tells twice what is needed of one device:
/// its id, or a coordinate of its place or force. Unknown keys and kinds are passed over, in any order.
[[nodiscard]] bool read_state(std::string_view text, std::string_view wanted, ServiceState& state) noexcept;

/// Of every Inverse3 that a message lists, in its order; empty where it is no message.
[[nodiscard]] std::vector<std::string> device_ids(std::string_view text);

/// What an event of the second port means for the force.
struct ServiceEvent {
  enum class Kind : std::uint8_t { other, safety, released, disconnected, connected, busy };
  Kind kind = Kind::other;
  bool about = true;  ///< it is about the wanted device, or names none
};
/// False when it is no JSON object.
[[nodiscard]] bool read_event(std::string_view text, std::string_view wanted, ServiceEvent& event) noexcept;

/// How a force is written: services of 3.5 want `vector`, older ones `values`.
enum class ForceKey : std::uint8_t { vector, values };

/// The factory configuration that is asked for: its origin is the middle of the workspace, its arm looks forward (the
/// vendor's page on mount and workspace, 3.5).
inline constexpr std::string_view kPreset = "arm_front_centered";
/// x right, y forward, z up: the service's own axes.
inline constexpr std::string_view kBasis = "XYZ";
/// That the service is asked for, N s/m: with less, a force gate that closes and opens in contact gives a hand more
/// than 10 mJ (docs/touch.md, "Behind a service").
inline constexpr double kServiceDamping = 2.0;
/// Whether a service that tells this damping has taken kServiceDamping, or more.
[[nodiscard]] constexpr bool damps(double damping_n_s_per_m) noexcept {
  return damping_n_s_per_m >= 0.99 * kServiceDamping;
}

/// The first message: session, basis and preset, and no force. Its size; 0 where it does not fit.
[[nodiscard]] std::size_t write_setup(std::span<char> text, std::string_view id, ForceKey key) noexcept;
/// Asks for an answer that tells the configuration again, which others leave out; no force. Its size; 0 where it does
/// not fit.
[[nodiscard]] std::size_t write_full_state_request(std::span<char> text, std::string_view id, ForceKey key) noexcept;
/// Asks for an answer and commands nothing. Its size; 0 where it does not fit.
[[nodiscard]] std::size_t write_probe(std::span<char> text, std::string_view id) noexcept;
/// The message of a tick.
[[nodiscard]] std::size_t write_force(std::span<char> text, std::string_view id, const Eigen::Vector3d& force_n,
                                      ForceKey key) noexcept;

}  // namespace sparsha::haptics::haply
