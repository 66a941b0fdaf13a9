// A Falcon in software behind its USB endpoints: bridge, boot loader, firmware, encoders, homing, lights, motors, and
// what can go wrong with them. Includes nothing of the driver.
#pragma once

#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include "emulator/bridge.h"
#include "emulator/codec.h"
#include "emulator/geometry.h"

namespace sparsha::emulator {

/// What the device is, and its faults. Counts of 0 mean never.
struct FalconOptions {
  bool firmware_loaded = true;
  bool heeds_event_character = true;  ///< false: the bridge takes it, and answers wait for the timer
  bool powered = true;                ///< without power nothing behind the bridge works
  bool homed = false;                 ///< knows its position already
  std::size_t image_bytes = 4096;     ///< least upload that makes running firmware
  double counts_per_newton_metre = 10000.0;
  int corrupt_echo_byte = -1;   ///< first upload only: the echo of this byte is wrong
  int deaf_handshakes = 0;      ///< this many greetings stay without reply
  int failed_loads = 0;         ///< this many uploads echo well and yet run nothing
  int lose_every = 0;           ///< every n-th command gets no answer
  int lose_byte_every = 0;      ///< every n-th byte that the firmware says is lost
  int garble_every = 0;         ///< every n-th answer is malformed
  bool split_answers = false;   ///< answers come in two USB packets
  bool garbage = false;         ///< bytes that mean nothing stand between the answers
  double latest_answer_s = 0.;  ///< answers are late, by earliest_answer_s to this
  double earliest_answer_s = 1e-3;
  double silent_every_s = 0.0;  ///< the firmware says nothing for silent_s so often; it keeps its motors on
  double silent_s = 0.3;
  double arm_missing_s = 0.0;  ///< the right arm's encoder is homed only so long after the first homing request
};

/// What the person at the grip knows when asked for its place.
struct Felt {
  double time_s = 0.0;
  Vec3 force_n{};           ///< of the motors
  std::uint8_t lights = 0;  ///< 2 green, 4 blue, 8 red
};
struct Grip {
  Vec3 place_m{0.0, 0.0, 0.1346};
  std::uint8_t buttons = 0;  ///< 1 plus, 2 forward, 4 centre, 8 minus
};

/// Bytes on the wire.
struct WireEvent {
  enum class Kind : std::uint8_t { to_device, to_host, control, plugged, unplugged, power_off, power_on };
  double time_s = 0.0;
  Kind kind = Kind::to_device;
  std::vector<std::uint8_t> bytes;  ///< of a packet; of a control request: request, value low, value high
};

/// Thread-safe. Times in seconds, from any start; a call with an earlier time than the last one's counts as that.
class Falcon {
 public:
  using Hand = std::function<Grip(const Felt&)>;
  using Log = std::function<void(const WireEvent&)>;

  explicit Falcon(const FalconOptions& options = {});

  void set_hand(Hand hand);
  void set_place(const Vec3& place_m);     ///< and take the hand away
  void set_buttons(std::uint8_t buttons);  ///< held down beside the hand's
  void set_log(Log log);
  /// Gone from the bus. `power` = false: its firmware and homing are lost with it.
  void unplug(bool power, double time_s);
  void plug(double time_s);
  void power_cycle();
  /// Its own supply, pulled or plugged in; the bridge is powered by USB.
  void set_power(bool on, double time_s);

  // The endpoints.
  bool control(std::uint8_t request, std::uint16_t value, double time_s);
  void write(std::span<const std::uint8_t> bytes, double time_s);
  /// When the host gets the next packet, and that packet, modem status first.
  [[nodiscard]] double packet_s() const;
  [[nodiscard]] std::optional<std::vector<std::uint8_t>> read(double time_s);
  [[nodiscard]] bool plugged() const;
  [[nodiscard]] bool powered() const;
  [[nodiscard]] std::uint8_t latency_ms() const;

  // What it has seen.
  [[nodiscard]] std::array<int, 3> motors() const;
  [[nodiscard]] Vec3 force_n() const;
  [[nodiscard]] std::uint64_t commands() const;
  [[nodiscard]] std::uint64_t unsafe_commands() const;  ///< with force while not homed
  [[nodiscard]] std::uint8_t flags() const;             ///< of the last command
  [[nodiscard]] bool firmware_loaded() const;
  [[nodiscard]] bool homed() const;
  [[nodiscard]] std::vector<std::uint8_t> uploaded() const;

 private:
  enum class Mode : std::uint8_t { run, greeting, begin, upload };

  void lose_power();
  void tell(WireEvent::Kind kind, std::span<const std::uint8_t> bytes, double time_s) const;
  void modem(std::uint16_t value);
  void boot(std::uint8_t byte, double time_s);
  void echo(std::uint8_t byte, double time_s);
  void serve(const Command& command, double time_s);
  void hold(double time_s);
  void home(const PerArm& angles, double time_s);
  [[nodiscard]] std::array<int, 3> counts() const;
  void answer(double time_s);
  void say(std::span<const std::uint8_t> bytes, double time_s);

  mutable std::mutex mutex_;
  FalconOptions options_;
  Bridge bridge_;
  CommandParser parser_;
  Hand hand_;
  Log log_;
  Grip grip_;
  std::uint8_t pressed_ = 0;  // besides the hand's
  Vec3 force_n_{};
  std::array<int, 3> power_up_counts_{};
  Command command_;
  bool plugged_ = true;
  Mode mode_ = Mode::run;
  bool dtr_low_ = false;
  bool loaded_;
  std::array<bool, 3> pulled_out_{}, homed_{};
  std::size_t greeted_ = 0;  // bytes of the greeting seen
  std::vector<std::uint8_t> uploaded_;
  double homing_since_s_ = -1.0;
  double silent_until_s_ = -1.0, last_silence_s_ = 0.0;
  std::uint64_t commands_ = 0, answers_ = 0, unsafe_ = 0, bytes_said_ = 0, uploads_ = 0;
  int greetings_ = 0;
  bool corrupted_ = false;
};

}  // namespace sparsha::emulator
