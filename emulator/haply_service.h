// The Inverse Service in software: a WebSocket for states and forces, one for events, an Inverse3 with a hand, and what
// can go wrong with them. From the vendor's pages (service 3.5) and open clients; includes nothing of the driver.
#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "base/system/stream_socket.h"
#include "emulator/falcon.h"
#include "emulator/web_socket_server.h"

namespace sparsha::emulator {

struct HaplyOptions {
  std::uint16_t port = 10001;         ///< 0: any that is free
  std::uint16_t events_port = 10020;  ///< 0: any that is free
  int devices = 1;                    ///< Inverse3 in the list; the hand holds the first
  /// A command moves the motors for so long and is forgotten.
  double tick_s = 0.0015;
  // Faults. Those that begin do so `fault_after_s` after the first force, last for `fault_s`, and come again.
  double fault_after_s = 2.0;
  double fault_s = 1.0;
  bool brake = false;           ///< the emergency brake is pulled
  bool disconnect = false;      ///< the device leaves the list
  bool loses_events = false;    ///< the port of the events closes, and is there again
  bool dies = false;            ///< the service ends, and is started again
  bool silent = false;          ///< no answers
  bool malformed = false;       ///< one answer is no JSON
  bool not_framed = false;      ///< one answer is no frame
  bool second_client = false;   ///< another program pushes by 1.5 N
  bool late = false;            ///< answers come 1 to 20 ms late, always
  bool split = false;           ///< each message in three frames and six writes, always
  bool merged = false;          ///< two answers in one write, always
  bool keeps_settings = false;  ///< another basis, whatever a client configures
  bool damps = true;            ///< takes the damping that a client sets
  bool version_3_1 = false;     ///< no events, and forces under `values` alone
  bool version_3_6 = false;     ///< one that nobody knows yet: forces under a key of its own, which no client sends
  bool other_words = false;     ///< exponents, unknown keys and kinds, ids last, a wireless grip, a preset as an object
  bool no_preset = false;       ///< the configuration tells of none
  double grip_tilt_rad = 0.0;   ///< of the grip about x; negative: its far end is held up
  double gate = 1.0;            ///< share of the force that the service lets through
  double damping_n_s_per_m = 0.0;  ///< until a client sets it
};

/// A message, either way.
struct HaplyMessage {
  double time_s = 0.0;
  bool to_client = false;
  std::string text;
};

/// Serves until destroyed. The hand is asked in the Falcon's frame, as person.h makes it, its light always blue.
class HaplyService {
 public:
  HaplyService(HaplyOptions options, Falcon::Hand hand);
  ~HaplyService();
  HaplyService(const HaplyService&) = delete;
  HaplyService& operator=(const HaplyService&) = delete;

  [[nodiscard]] std::uint16_t port() const noexcept { return port_; }
  [[nodiscard]] std::uint16_t events_port() const noexcept { return events_port_; }
  /// Called for each message from several threads, one after the other. Before the first client.
  void set_log(std::function<void(const HaplyMessage&)> log) { log_ = std::move(log); }

  /// On the motors now, newtons: zero a tick after the last command.
  [[nodiscard]] double force_n();
  /// Of the commanded forces that went to the motors, without the service's damping.
  [[nodiscard]] double strongest_n();
  /// Commands of a force other than zero while the brake was on, or to a device that was not there.
  [[nodiscard]] std::uint64_t unsafe_commands();
  [[nodiscard]] std::uint64_t commands();
  /// Times at which the fault was on at least once.
  [[nodiscard]] bool faulty();

 private:
  struct Client;
  void accept(system::StreamListener& listener, bool events);
  void serve(Client& client);
  void watch_events();
  void tell(std::string_view event);
  std::string inventory(const Client& client);
  std::string state(const Client& client, bool with_config);
  /// True when the client asks for the configuration.
  bool take(Client& client, const std::string& text);
  void configure(Client& client, const std::string& permutation, const std::string& preset);
  void advance();
  bool fault_is_on();
  bool answer(Client& client, const std::string& text);
  void note(bool to_client, const std::string& text);
  double now_s() const;

  HaplyOptions options_;
  Falcon::Hand hand_;
  std::function<void(const HaplyMessage&)> log_;
  std::mutex mutex_;  // of all below
  std::vector<std::unique_ptr<Client>> clients_;
  double first_force_s_ = -1.0, advanced_s_ = 0.0, strongest_n_ = 0.0;
  Vec3 applied_n_{};
  Vec3 place_m_{}, velocity_{};
  std::uint8_t buttons_ = 0;
  std::uint64_t commands_ = 0, unsafe_ = 0, commands_told_ = 0;
  bool told_ = false, was_on_ = false, seen_ = false, ever_on_ = false, spoilt_ = false;
  std::uint16_t port_ = 0, events_port_ = 0;
  std::unique_ptr<system::StreamListener> states_, events_;
  std::atomic<bool> stopping_{false};
  std::vector<std::thread> own_, servers_;
};

}  // namespace sparsha::emulator
