// One connection to the Inverse Service, from its greeting on, and the thread that finds another.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "haptics/device/device.h"
#include "haptics/device/haply/haply.h"
#include "haptics/device/haply/messages.h"
#include "haptics/device/haply/web_socket.h"
#include "haptics/device/hot_plug.h"

namespace sparsha::haptics::haply {

/// Why there is none.
struct ConnectProblem {
  enum class Kind : std::uint8_t { none, no_service, closed, not_understood, no_device, no_events };
  Kind kind = Kind::none;
  std::vector<std::string> ids;  ///< of the Inverse3 that are there, though none is the wanted one
};

/// States and forces, events, and whose they are. No call but connect() allocates.
struct Connection {
  std::unique_ptr<WebSocket> states;
  std::unique_ptr<WebSocket> events;  ///< null where the service has no such port
  DeviceId id;
  ForceKey force_key = ForceKey::vector;
  bool set_up = false;             ///< basis and preset have been read back after they were set
  std::vector<std::string> ids;    ///< of every Inverse3 when it was greeted
  double damping_n_s_per_m = 0.0;  ///< of the service, as it was read back
  Eigen::Vector3d position_m = Eigen::Vector3d::Zero();

  WebSocket::Status send_force(const Eigen::Vector3d& force_n) noexcept;
  WebSocket::Status send_probe() noexcept;

 private:
  std::array<char, 512> text_{};
};

/// Greets, reads the list of devices, sets the session up. Null with the problem.
[[nodiscard]] std::unique_ptr<Connection> connect(const HaplyOptions& options, ConnectProblem& problem);

/// Looks for a service on a thread of its own, and hands the connection to the servo. An Inverse3 that was taken once
/// is waited for: nobody may be at another one.
class Finder {
 public:
  explicit Finder(HaplyOptions options);

  // Servo thread; no lock, no allocation.
  void give_back(Connection* connection) noexcept {
    if (connection != nullptr) {
      taken_ = connection->id;
      had_events_ = had_events_ || connection->events != nullptr;
    }
    plug_.give_back(connection);
  }
  [[nodiscard]] Connection* take() noexcept { return plug_.take(); }
  /// Any thread.
  [[nodiscard]] const DeviceAdvice* advice() const noexcept { return advice_.load(); }

 private:
  [[nodiscard]] std::unique_ptr<Connection> find();

  HaplyOptions options_;
  DeviceId taken_;           // written while none is looked for
  bool had_events_ = false;  // likewise
  std::atomic<const DeviceAdvice*> advice_{nullptr};
  HotPlug<Connection> plug_;  // the last: its thread uses what stands above
};

}  // namespace sparsha::haptics::haply
