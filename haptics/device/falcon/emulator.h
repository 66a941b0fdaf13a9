// A Falcon in software, at the level of its wire: boot loader, firmware upload, encoders, homing, motors, faults.
// For tests, and to try the program without the device.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "haptics/device/falcon/packet.h"
#include "haptics/device/falcon/transport.h"

namespace sparsha::haptics::falcon {

/// What the emulated device is and what goes wrong with it.
struct EmulatorOptions {
  bool firmware_loaded = true;
  bool powered = true;             ///< without power the boot loader is dumb
  bool homed = false;              ///< already knows its position
  std::size_t image_bytes = 4096;  ///< least upload that makes running firmware
  double counts_per_newton_metre = 10000.0;
  int corrupt_echo_byte = -1;  ///< first upload only: this byte comes back wrong
  int deaf_handshakes = 0;     ///< this many greetings stay without reply
  int lose_every = 0;          ///< every n-th packet gets no answer
  int garble_every = 0;        ///< every n-th answer is malformed
  bool split_answers = false;  ///< answers come in two USB packets
};

/// Bytes in, bytes out. Thread-safe.
class FalconEmulator {
 public:
  /// Where the grip is at a time (Falcon frame, metres), given the force it gets, newtons.
  using Hand = std::function<Eigen::Vector3d(double time_s, const Eigen::Vector3d& force_n)>;

  explicit FalconEmulator(const EmulatorOptions& options = {});

  void set_hand(Hand hand);
  void set_position(const Eigen::Vector3d& position_m);
  void set_buttons(std::uint8_t buttons);
  void unplug();
  /// Power off and on: firmware and homing are lost.
  void power_cycle();

  // The wire, as the bridge does it.
  void control(Request request, std::uint16_t value);
  void write(std::span<const std::uint8_t> bytes, double time_s);
  /// The next USB packet's data (at most 62 bytes, without modem status); empty when there is none.
  [[nodiscard]] std::vector<std::uint8_t> read();
  [[nodiscard]] bool plugged() const;

  // What it has seen.
  [[nodiscard]] MotorCommand command() const;
  [[nodiscard]] Eigen::Vector3d force_n() const;
  [[nodiscard]] Eigen::Vector3d position_m() const;
  [[nodiscard]] std::uint64_t packets() const;
  [[nodiscard]] std::uint64_t force_before_homing() const;  ///< packets with force while not homed: must stay 0
  [[nodiscard]] std::uint8_t flags() const;                 ///< of the last packet: homing request and lights
  [[nodiscard]] bool firmware_loaded() const;
  [[nodiscard]] const std::vector<std::uint8_t>& uploaded() const;

 private:
  enum class Mode { run, greeting, begin, upload };

  void boot(std::span<const std::uint8_t> bytes);
  void serve(std::span<const std::uint8_t> bytes, double time_s);
  void answer(const Packet& packet, double time_s);
  void move(double time_s);

  mutable std::mutex mutex_;
  EmulatorOptions options_;
  Hand hand_;
  Eigen::Vector3d position_m_{0.0, 0.0, 0.1346};
  Eigen::Vector3d force_n_ = Eigen::Vector3d::Zero();
  Counts power_up_counts_{};
  std::uint8_t buttons_ = 0;
  bool plugged_ = true;
  Mode mode_ = Mode::run;
  bool dtr_was_low_ = false;
  std::uint16_t baud_ = 0;
  bool loaded_ = false;
  bool homed_ = false;
  bool pulled_out_ = false;
  std::vector<std::uint8_t> uploaded_;
  std::vector<std::uint8_t> partial_;
  std::deque<std::vector<std::uint8_t>> outgoing_;
  MotorCommand command_{};
  std::uint8_t flags_ = 0;
  std::uint64_t packets_ = 0;
  std::uint64_t answers_ = 0;
  std::uint64_t unsafe_ = 0;
  int greetings_ = 0;
  bool corrupted_ = false;
};

/// How an emulator's time runs.
enum class Clock : std::uint8_t {
  virtual_time,  ///< waiting costs nothing: tests
  real_time      ///< one answer a millisecond, as USB frames allow
};

/// A wire to an emulator.
[[nodiscard]] std::unique_ptr<Transport> make_emulated_transport(std::shared_ptr<FalconEmulator> emulator, Clock clock);

}  // namespace sparsha::haptics::falcon
