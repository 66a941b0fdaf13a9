// Gamepads and tablets as the system shows them: Linux's event devices; nothing elsewhere.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace sparsha::system {

enum class PadKind : std::uint8_t { gamepad, tablet };

struct PadState {
  bool connected = true;
  double left_x = 0.0, left_y = 0.0;  ///< of a gamepad's left stick, -1 to 1, right and up positive
  double right_trigger = 0.0;         ///< 0 to 1
  double hat_x = 0.0, hat_y = 0.0;    ///< of the directional pad, -1, 0 or 1
  std::uint32_t buttons = 0;          ///< bit 0 south, 1 east, 2 west, 3 north; of a pen 0 and 1
  bool pen_near = false;              ///< a tablet sees its pen
  double pen_x = 0.0, pen_y = 0.0;    ///< 0 to 1 of the tablet, right and up positive
  double pressure = 0.0;              ///< 0 to 1
  bool has_tilt = false;
  double tilt_x_rad = 0.0, tilt_y_rad = 0.0;  ///< of the pen's far end, to the right and up the tablet
};

/// What a pad's events add up to. Type, code and value are those of Linux's input_event.
class PadReader {
 public:
  struct Range {
    int least = 0, most = 0;
    int flat = 0;        ///< about the middle of a stick, which counts as the middle
    int resolution = 0;  ///< of a tilt: units a radian; 0: its units are degrees
  };
  explicit PadReader(PadKind kind) noexcept : kind_(kind) {}
  void set_range(int axis, Range range) noexcept;
  void take(int type, int code, int value) noexcept;
  [[nodiscard]] const PadState& state() const noexcept { return state_; }

 private:
  [[nodiscard]] double share(int axis, int value) const noexcept;
  [[nodiscard]] double stick(int axis, int value) const noexcept;
  [[nodiscard]] double tilt_rad(int axis, int value) const noexcept;
  void take_pen(int axis, int value) noexcept;

  PadKind kind_;
  PadState state_;
  std::array<Range, 64> ranges_{};
};

class Pad {
 public:
  virtual ~Pad() = default;
  [[nodiscard]] virtual std::string name() const = 0;
  /// What has come since; neither waits nor allocates.
  virtual void read(PadState& state) noexcept = 0;
  /// Both motors, 0 to 1, for `seconds` at most. From another thread than read(). False when it cannot.
  virtual bool rumble(double strong, double weak, double seconds) noexcept = 0;
};

/// An open event device, which the pad closes; null where it is none of this kind, and stays open then. Linux.
[[nodiscard]] std::unique_ptr<Pad> pad_of_file(int file, PadKind kind);

/// The one of this node below /dev/input ("event7", "by-id/..."), or the first that this user may open where `node` is
/// empty; null and why there is none.
[[nodiscard]] std::unique_ptr<Pad> open_pad(PadKind kind, const std::string& node, std::string& problem);

struct FoundPad {
  std::string node, name;
};
/// All that this user may open, in the order of their nodes; none, and why.
[[nodiscard]] std::vector<FoundPad> find_pads(PadKind kind, std::string& problem);

}  // namespace sparsha::system
