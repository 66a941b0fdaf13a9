// The driver's wire to an emulated Falcon in this process, in virtual or real time, and the emulator as tests ask it.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include "emulator/falcon.h"
#include "haptics/device/falcon/transport.h"

namespace sparsha::test {

using EmulatorOptions = emulator::FalconOptions;

/// The emulated device, with Eigen's vectors and its motors as the driver names them.
class EmulatedFalcon {
 public:
  /// Where the grip is (Falcon frame, metres) at a time, given the force it gets, newtons.
  using Hand = std::function<Eigen::Vector3d(double time_s, const Eigen::Vector3d& force_n)>;

  explicit EmulatedFalcon(const EmulatorOptions& options = {});
  void set_hand(Hand hand);
  void set_position(const Eigen::Vector3d& position_m);
  [[nodiscard]] std::array<int, 3> command() const { return device->motors(); }
  [[nodiscard]] Eigen::Vector3d force_n() const;

  std::shared_ptr<emulator::Falcon> device;
};

/// How its time runs.
enum class Clock : std::uint8_t {
  virtual_time,  ///< waiting costs nothing
  real_time
};

[[nodiscard]] std::unique_ptr<haptics::falcon::Transport> make_wire(const EmulatedFalcon& falcon, Clock clock);

}  // namespace sparsha::test
