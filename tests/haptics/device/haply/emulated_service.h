// The driver under the servo on an emulated service that shares no code with it, and what goes over the wire.
#pragma once

#include <cmath>
#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "emulator/haply_service.h"
#include "emulator/person.h"
#include "haptics/device/haply/haply.h"
#include "haptics/servo/servo.h"
#include "tests/support/servo_parts.h"

namespace sparsha::haptics::haply {

class Service {
 public:
  explicit Service(emulator::HaplyOptions options = {}) : Service(options, emulator::make_person()) {}
  Service(emulator::HaplyOptions options, emulator::Falcon::Hand hand) {
    options.port = options.events_port = 0;
    service = std::make_unique<emulator::HaplyService>(options, std::move(hand));
    service->set_log([this](const emulator::HaplyMessage& message) {
      const std::lock_guard lock(mutex_);
      log_.push_back(message);
    });
    client.port = service->port();
    client.events_port = service->events_port();
  }
  [[nodiscard]] std::vector<emulator::HaplyMessage> log() {
    const std::lock_guard lock(mutex_);
    return log_;
  }

  HaplyOptions client;

 private:
  std::mutex mutex_;
  std::vector<emulator::HaplyMessage> log_;

 public:
  std::unique_ptr<emulator::HaplyService> service;  // the last, since its threads write the log until they end
};

/// Faults soon after the first force, and long enough to be seen.
inline emulator::HaplyOptions soon() {
  emulator::HaplyOptions options;
  options.fault_after_s = 0.3;
  options.fault_s = 0.3;
  return options;
}

/// Newtons of a client's message; negative when it is none.
inline double asked_n(const emulator::HaplyMessage& message) {
  if (message.to_client) return -1.0;
  const nlohmann::json json = nlohmann::json::parse(message.text, nullptr, false);
  if (json.is_discarded()) return -1.0;
  const nlohmann::json& command = json["inverse3"][0]["commands"]["set_cursor_force"];
  const nlohmann::json& force = command.contains("vector") ? command["vector"] : command["values"];
  return std::hypot(force["x"].get<double>(), force["y"].get<double>(), force["z"].get<double>());
}

struct Running {
  explicit Running(Device& device, double rate_hz = 1000.0, double patience_s = 0.2)
      : servo(device, options_of_rate(rate_hz, patience_s), window_on(sparsha::test::flat_scene()), state, {},
              nullptr) {
    servo.start();
  }
  ~Running() { servo.stop(); }
  static ServoOptions options_of_rate(double rate_hz, double patience_s) {
    ServoOptions options = patient(patience_s);
    options.renderer.rate_hz = rate_hz;
    return options;
  }
  Seqlock<State> state;
  Servo servo;
};

inline bool says(const Device& device, const std::string& phrase) {
  return eventually([&] {
    const DeviceAdvice* const advice = device.advice();  // once: the servo changes it
    return advice != nullptr && advice->phrase == phrase;
  });
}

/// A service whose settings cannot be trusted is told of, asked on, and never commanded a force.
inline void expect_no_force_from(const emulator::HaplyOptions& options) {
  Service emulated(options);
  const auto device = make_haply_device(emulated.client);
  const Running run(*device);
  ASSERT_TRUE(says(*device, "device_not_set_up"));
  ASSERT_TRUE(eventually([&] { return emulated.service->commands() > 500; }));
  EXPECT_EQ(emulated.service->strongest_n(), 0.0);
}

}  // namespace sparsha::haptics::haply
