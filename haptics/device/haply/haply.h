// The Haply Inverse3 through its vendor's local service: `--device haply`. From the vendor's pages and open clients;
// not tried on hardware.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>

#include "haptics/device/device.h"
#include "haptics/device/kind.h"

namespace sparsha::haptics::haply {

struct HaplyOptions {
  std::uint16_t port = 10001;         ///< of states and forces
  std::uint16_t events_port = 10020;  ///< of what happens, the emergency brake among it
  std::string device_id;              ///< empty: the first Inverse3
  /// The device frame's origin in the service's frame, metres: with the preset that is set, the middle of the
  /// workspace.
  Eigen::Vector3d centre_m = Eigen::Vector3d::Zero();
  /// Begin without a service or a device, and take the first that can be had.
  bool wait_for_device = false;
  /// Nothing is set and no force is commanded, not even zero: another program may be at the device. Places are then
  /// told from the origin that the service has, and the device counts as one that may not push.
  bool watch_only = false;
  /// The service has told of events before: one that tells of none is not taken.
  bool needs_events = false;
  std::function<bool()> stop;  ///< asked while opening; true ends it: Cancelled
};

/// The ports may be given by SPARSHA_HAPLY_PORT and SPARSHA_HAPLY_EVENTS_PORT.
[[nodiscard]] HaplyOptions options_of(const DeviceRequest& request);

/// What an Inverse3 is for the servo: the force of its sheet, and a workspace well within the sheet's
/// (docs/use/hardware.md, "Where the figures come from").
[[nodiscard]] DeviceInfo haply_info();

/// Connects, sets basis and preset and reads them back: without that there is no force. Forces are zero from the tick
/// in which an emergency brake, a disconnection, a message that is none or 7 ms without an answer is seen, and come
/// back once the brake is released and the hand has been in free space. A service that ends is looked for again, and
/// one that told of events has to tell of them again. Where the first one has not taken the damping that it is asked
/// for, the limits are those of a hand with less of it; a later one gets no force then. Throws Error{device}: no
/// service, no Inverse3.
[[nodiscard]] std::unique_ptr<Device> make_haply_device(const HaplyOptions& options = {});

[[nodiscard]] DeviceKind haply_kind();

}  // namespace sparsha::haptics::haply
