// What a kind of device is to the program: its name, and how it is found, made and checked. A new device is a folder
// with one of these and a line in app/exploration/devices.cpp.
#pragma once

#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "haptics/device/device.h"
#include "haptics/device/device_check.h"
#include "haptics/device/steered/steering_script.h"
#include "haptics/state/seqlock.h"
#include "haptics/state/state.h"

namespace sparsha::haptics {

/// All that a device may need to be made.
struct DeviceRequest {
  std::string argument;  ///< what follows `NAME:`
  std::filesystem::path firmware;
  bool window = false;                              ///< a window will be open
  bool wait_for_device = false;                     ///< begin without it, and take it as soon as it can be had
  bool watch_only = false;                          ///< another program may be at it: look, and change nothing
  std::shared_ptr<Seqlock<PointerSample>> pointer;  ///< where a window writes the mouse
  std::shared_ptr<Seqlock<SteeringSample>> keys;    ///< where a terminal writes its keys
  std::function<bool()> stop;                       ///< asked while opening takes seconds; true ends it: Cancelled
  std::function<void(const std::string&)> say;      ///< told what opening does
};

/// One that is there, or why there is none.
struct FoundDevice {
  std::string place;  ///< "bus 1 address 5"; empty where there is one of its kind only
  bool available = false;
  std::string problem;                               ///< why not
  std::vector<std::pair<std::string, int>> numbers;  ///< of the place, for programs
};

/// What a calibration found.
struct CalibrationReport {
  std::vector<std::pair<std::string, double>> numbers;  ///< for programs: name with its unit, value
  std::string line, sentence;                           ///< the same for a person, short and as a whole sentence
  std::filesystem::path file;                           ///< where it is kept
};

struct DeviceKind {
  const char* name;      ///< of `--device`
  const char* argument;  ///< that follows it and a colon; in brackets where it may be missing; null: none
  const char* what;      ///< who moves it, a sentence's end
  /// Those that `make` could open now; one that is not available where there is none.
  std::function<std::vector<FoundDevice>(const DeviceRequest&)> find;
  /// Throws Error{device} with the remedy.
  std::function<std::unique_ptr<Device>(const DeviceRequest&)> make;
  /// Each step to the device with its remedy, forces zero, about `seconds` long; empty: made, and watched as any device
  /// is (haptics/conformance). Never throws for what is wrong with the device.
  std::function<CheckReport(const DeviceRequest&, double seconds)> check;
  /// With a weight of so many newtons on the grip; what to do is told by the request's `say`. Keeps what it finds.
  /// Empty: there is nothing to calibrate. Throws Error.
  std::function<CalibrationReport(const DeviceRequest&, double weight_n)> calibrate = nullptr;
};

}  // namespace sparsha::haptics
