#include "base/system/gamepad.h"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#if defined(__linux__)
#include <fcntl.h>
#include <linux/input.h>
#include <sys/ioctl.h>
#include <unistd.h>
#endif

namespace sparsha::system {
namespace {

// Of linux/input-event-codes.h, for systems that have none: tests feed them everywhere.
constexpr int kKey = 1, kAbsolute = 3;
constexpr int kX = 0, kY = 1, kRightTrigger = 5, kGas = 9, kHatX = 16, kHatY = 17, kPressure = 24, kTiltX = 26,
              kTiltY = 27;
constexpr double kMostTilt_rad = 1.3;  // flatter no pen is held
constexpr double kRadian_per_degree = 3.14159265358979323846 / 180.0;
constexpr int kSouth = 0x130, kEast = 0x131, kNorth = 0x133, kWest = 0x134, kRightTrigger2 = 0x139;
constexpr int kPen = 0x140, kStylus = 0x14B, kStylus2 = 0x14C;

void set_bit(std::uint32_t& bits, unsigned bit, bool on) { bits = on ? bits | 1U << bit : bits & ~(1U << bit); }

}  // namespace

void PadReader::set_range(int axis, Range range) noexcept {
  if (axis >= 0 && static_cast<std::size_t>(axis) < ranges_.size()) ranges_[static_cast<std::size_t>(axis)] = range;
}

double PadReader::share(int axis, int value) const noexcept {
  const Range range = ranges_[static_cast<std::size_t>(axis)];
  if (range.most <= range.least) return 0.0;
  const double width = static_cast<double>(range.most) - static_cast<double>(range.least);
  return std::clamp((static_cast<double>(value) - static_cast<double>(range.least)) / width, 0.0, 1.0);
}

double PadReader::stick(int axis, int value) const noexcept {
  const Range range = ranges_[static_cast<std::size_t>(axis)];
  const double middle = 0.5 * (static_cast<double>(range.least) + static_cast<double>(range.most));
  if (std::abs(static_cast<double>(value) - middle) <= static_cast<double>(range.flat)) return 0.0;
  return 2.0 * share(axis, value) - 1.0;
}

double PadReader::tilt_rad(int axis, int value) const noexcept {
  const Range range = ranges_[static_cast<std::size_t>(axis)];
  const double units = std::clamp(static_cast<double>(value), static_cast<double>(range.least),
                                  std::max(static_cast<double>(range.least), static_cast<double>(range.most)));
  const double rad = range.resolution > 0 ? units / static_cast<double>(range.resolution) : units * kRadian_per_degree;
  return std::clamp(rad, -kMostTilt_rad, kMostTilt_rad);
}

void PadReader::take_pen(int axis, int value) noexcept {
  const double part = share(axis, value);
  if (axis == kX) state_.pen_x = part;
  if (axis == kY) state_.pen_y = 1.0 - part;
  if (axis == kPressure) state_.pressure = part;
  const Range range = ranges_[static_cast<std::size_t>(axis)];
  if ((axis != kTiltX && axis != kTiltY) || range.most <= range.least) return;
  state_.has_tilt = true;
  if (axis == kTiltX) state_.tilt_x_rad = tilt_rad(axis, value);
  if (axis == kTiltY) state_.tilt_y_rad = -tilt_rad(axis, value);
}

void PadReader::take(int type, int code, int value) noexcept {
  const bool pen = kind_ == PadKind::tablet;
  if (type == kKey) {
    const bool on = value != 0;
    if (pen && code == kPen) state_.pen_near = on;
    if (pen && code == kPen && !on) state_.pressure = 0.0;
    if (pen && (code == kStylus || code == kStylus2)) set_bit(state_.buttons, code == kStylus ? 0 : 1, on);
    if (pen) return;
    if (code == kSouth || code == kEast) set_bit(state_.buttons, code == kSouth ? 0 : 1, on);
    if (code == kWest || code == kNorth) set_bit(state_.buttons, code == kWest ? 2 : 3, on);
    // Pads whose triggers are buttons press whole or not at all.
    if (code == kRightTrigger2 && ranges_[kRightTrigger].most <= ranges_[kRightTrigger].least &&
        ranges_[kGas].most <= ranges_[kGas].least)
      state_.right_trigger = on ? 1.0 : 0.0;
    return;
  }
  if (type != kAbsolute || code < 0 || static_cast<std::size_t>(code) >= ranges_.size()) return;
  if (pen) return take_pen(code, value);
  const auto step = [value] { return static_cast<double>((value > 0) - (value < 0)); };
  if (code == kX) state_.left_x = stick(code, value);
  if (code == kY) state_.left_y = -stick(code, value);
  if (code == kHatX) state_.hat_x = step();
  if (code == kHatY) state_.hat_y = -step();
  // Where there is a pedal of its own, the other axis is half of the right stick, which rests in its middle.
  const bool has_gas = ranges_[kGas].most > ranges_[kGas].least;
  if (code == (has_gas ? kGas : kRightTrigger)) state_.right_trigger = share(code, value);
}

#if defined(__linux__)

namespace {

constexpr int kMostEvents = 64;  // in one read

template <std::size_t N>
bool has(const std::array<unsigned char, N>& bits, int bit) {
  const auto at = static_cast<std::size_t>(bit);
  return at / 8 < N && (bits[at / 8] >> at % 8 & 1U) != 0;
}

class EventPad final : public Pad {
 public:
  EventPad(int file, PadKind kind) : file_(file), reader_(kind) {
    look_anew();
    std::array<unsigned char, FF_MAX / 8 + 1> effects{};
    rumbles_ = ::ioctl(file_, EVIOCGBIT(EV_FF, effects.size()), effects.data()) >= 0 && has(effects, FF_RUMBLE);
  }
  ~EventPad() override {
    if (effect_ >= 0) ::ioctl(file_, EVIOCRMFF, effect_);
    ::close(file_);
  }
  EventPad(const EventPad&) = delete;
  EventPad& operator=(const EventPad&) = delete;

  [[nodiscard]] std::string name() const override {
    std::array<char, 128> text{};
    if (::ioctl(file_, EVIOCGNAME(text.size() - 1), text.data()) < 0) return "a pad without a name";
    return text.data();
  }

  void read(PadState& state) noexcept override {
    std::array<input_event, kMostEvents> events{};
    const ssize_t got = ::read(file_, events.data(), sizeof events);
    if (got < 0 && errno != EAGAIN && errno != EINTR) gone_ = true;
    bool lost = false;
    for (std::size_t i = 0; got > 0 && i < static_cast<std::size_t>(got) / sizeof(input_event); ++i) {
      lost = lost || (events[i].type == EV_SYN && events[i].code == SYN_DROPPED);
      reader_.take(events[i].type, events[i].code, events[i].value);
    }
    if (lost) look_anew();
    state = reader_.state();
    state.connected = !gone_;
  }

  bool rumble(double strong, double weak, double seconds) noexcept override {
    if (!rumbles_) return false;
    constexpr double kFull = 65535.0;
    ff_effect effect{};
    effect.type = FF_RUMBLE;
    effect.id = static_cast<__s16>(effect_);
    effect.replay.length = static_cast<__u16>(std::clamp(1e3 * seconds, 1.0, 1000.0));
    effect.u.rumble.strong_magnitude = static_cast<__u16>(kFull * std::clamp(strong, 0.0, 1.0));
    effect.u.rumble.weak_magnitude = static_cast<__u16>(kFull * std::clamp(weak, 0.0, 1.0));
    if (::ioctl(file_, EVIOCSFF, &effect) < 0) return false;
    effect_ = effect.id;
    input_event play{};
    play.type = EV_FF;
    play.code = static_cast<__u16>(effect_);
    play.value = 1;
    return ::write(file_, &play, sizeof play) == static_cast<ssize_t>(sizeof play);
  }

 private:
  /// Where axes and keys are now: events tell changes only, and the kernel drops them where nobody reads.
  void look_anew() noexcept {
    for (const int axis : {kX, kY, kRightTrigger, kGas, kHatX, kHatY, kPressure, kTiltX, kTiltY}) {
      input_absinfo info{};
      if (::ioctl(file_, EVIOCGABS(static_cast<unsigned>(axis)), &info) < 0) continue;
      reader_.set_range(axis, {info.minimum, info.maximum, info.flat, info.resolution});
      reader_.take(kAbsolute, axis, info.value);
    }
    std::array<unsigned char, KEY_MAX / 8 + 1> keys{};
    if (::ioctl(file_, EVIOCGKEY(keys.size()), keys.data()) < 0) return;
    for (const int key : {kSouth, kEast, kWest, kNorth, kRightTrigger2, kStylus, kStylus2, kPen})
      reader_.take(kKey, key, has(keys, key) ? 1 : 0);
  }

  int file_;
  PadReader reader_;
  bool rumbles_ = false, gone_ = false;
  int effect_ = -1;
};

bool is_kind(int file, PadKind kind) {
  std::array<unsigned char, KEY_MAX / 8 + 1> keys{};
  if (::ioctl(file, EVIOCGBIT(EV_KEY, keys.size()), keys.data()) < 0) return false;
  return has(keys, kind == PadKind::gamepad ? kSouth : kPen);
}

}  // namespace

std::unique_ptr<Pad> pad_of_file(int file, PadKind kind) {
  return is_kind(file, kind) ? std::make_unique<EventPad>(file, kind) : nullptr;
}

namespace {

const std::filesystem::path kNodes = "/dev/input";

/// A file that the pad closes; negative where this user may not open it, with its name in `problem`.
int open_node(const std::filesystem::path& node, std::string& problem) {
  int file = ::open(node.c_str(), O_RDWR | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) file = ::open(node.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
  if (file < 0 && errno == EACCES) problem += ", or this user may not open " + node.string() + " (group input)";
  return file;
}

std::unique_ptr<Pad> pad_of_node(const std::filesystem::path& node, PadKind kind, std::string& problem) {
  const int file = open_node(node, problem);
  if (file < 0) return nullptr;
  auto pad = pad_of_file(file, kind);
  if (!pad) ::close(file);
  return pad;
}

std::vector<std::filesystem::path> event_nodes() {
  std::error_code code;
  std::vector<std::filesystem::path> nodes;
  // Nodes come and go while they are listed.
  for (std::filesystem::directory_iterator at(kNodes, code), end; !code && at != end; at.increment(code))
    if (at->path().filename().string().starts_with("event")) nodes.push_back(at->path());
  const auto place = [](const std::filesystem::path& node) { return std::pair(node.string().size(), node.string()); };
  std::sort(nodes.begin(), nodes.end(), [&](const auto& a, const auto& b) { return place(a) < place(b); });
  return nodes;
}

std::string none_of(PadKind kind) {
  return kind == PadKind::gamepad ? "no gamepad is plugged in" : "no tablet with a pen is plugged in";
}

}  // namespace

std::unique_ptr<Pad> open_pad(PadKind kind, const std::string& node, std::string& problem) {
  problem = none_of(kind);
  if (!node.empty()) {
    problem = node + " is " + (kind == PadKind::gamepad ? "no gamepad" : "no tablet with a pen") + " of /dev/input";
    return pad_of_node(kNodes / node, kind, problem);
  }
  for (const auto& one : event_nodes())
    if (auto pad = pad_of_node(one, kind, problem)) return pad;
  return nullptr;
}

std::vector<FoundPad> find_pads(PadKind kind, std::string& problem) {
  problem = none_of(kind);
  std::vector<FoundPad> found;
  for (const auto& one : event_nodes())
    if (const auto pad = pad_of_node(one, kind, problem)) found.push_back({one.filename().string(), pad->name()});
  return found;
}

#else

std::unique_ptr<Pad> pad_of_file(int, PadKind) { return nullptr; }

std::unique_ptr<Pad> open_pad(PadKind, const std::string&, std::string& problem) {
  problem = "this system shows no event devices";
  return nullptr;
}

std::vector<FoundPad> find_pads(PadKind, std::string& problem) {
  problem = "this system shows no event devices";
  return {};
}

#endif

}  // namespace sparsha::system
