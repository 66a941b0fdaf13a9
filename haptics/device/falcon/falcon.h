// The Novint Falcon as a device of the servo, and what `sparsha device` asks about it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "haptics/device/device.h"
#include "haptics/device/falcon/transport.h"

namespace sparsha::haptics::falcon {

struct FalconOptions {
  /// Firmware image for a device that runs none; empty = the environment variable SPARSHA_FALCON_FIRMWARE, if set, else
  /// ~/.config/sparsha/falcon.bin, if there.
  std::filesystem::path firmware;
  /// Motor command of one newton metre at an arm. Differs between devices: `sparsha device calibrate`. 0 = what that
  /// has stored, else kUsualCounts.
  double counts_per_newton_metre = 0.0;
  /// The device frame's origin, Falcon frame: the middle of the workspace.
  Eigen::Vector3d centre_m{0.0, 0.0, 0.140};
  /// After homing the grip must be seen once beyond this z (Falcon frame, metres) before forces are possible; 0 = no
  /// such gate.
  double release_z_m = 0.155;
  /// Begin without a Falcon, or beside one that has no power, is not permitted or is held by another program, and take
  /// the first that can be had.
  bool wait_for_device = false;
  /// Asked while opening and measuring, which take seconds; true ends them. Opening then throws Cancelled.
  std::function<bool()> stop;
  /// Told what opening does.
  std::function<void(const std::string&)> say;
};

/// Motor counts per newton metre: those of the options, else kUsualCounts.
[[nodiscard]] double counts_of(const FalconOptions& options);

/// What a Falcon is for the servo. Device frame: metres about options.centre_m. Its force is what the motors have in
/// every direction within 35 mm of there, and 5 N at most.
[[nodiscard]] DeviceInfo falcon_info(const FalconOptions& options = {});

/// A Falcon on USB.
struct FoundFalcon {
  int bus = 0;
  int address = 0;
  bool accessible = false;  ///< this user may open it, and no other program holds it
  std::string problem;      ///< why not
};
/// Those plugged in. Empty when USB itself is not there.
[[nodiscard]] std::vector<FoundFalcon> find_falcons();

/// Opens the first one, loads firmware when it runs none, and makes it a device, which may be unplugged, or lose its
/// power, and come back: it is then brought up, homed and released anew. A process of its own ends the force when this
/// one cannot. Throws Error{device} with the remedy.
[[nodiscard]] std::unique_ptr<Device> make_falcon_device(const FalconOptions& options = {});
/// The same over any wire; unplugging, or a second without an answer, ends it.
[[nodiscard]] std::unique_ptr<Device> make_falcon_device(std::unique_ptr<Transport> wire, const FalconOptions& options);

}  // namespace sparsha::haptics::falcon
