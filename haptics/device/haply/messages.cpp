#include "haptics/device/haply/messages.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "haptics/device/haply/json_walk.h"

namespace sparsha::haptics::haply {
namespace {

using Kind = JsonValue::Kind;

constexpr std::array<const char*, 3> kAxes{"x", "y", "z"};
constexpr double kDisplaced = 1e-4;  // of a transform: metres, parts of a quaternion, scale

/// Gathers x, y, z below a path; all are there when `seen` is 7. False when one is told twice.
[[nodiscard]] bool take_axis(std::string_view key, const JsonValue& value, Eigen::Vector3d& vector, unsigned& seen) {
  for (std::size_t axis = 0; axis < kAxes.size(); ++axis)
    if (key == kAxes[axis] && value.kind == Kind::number) {
      if ((seen >> axis & 1U) != 0) return false;
      vector[static_cast<Eigen::Index>(axis)] = value.number;
      seen |= 1U << axis;
    }
  return true;
}

/// Reads one message. What is told of a device comes before it is known which it is where its id stands last: each
/// element is gathered, and kept when it ends.
class StateReader {
 public:
  StateReader(std::string_view wanted, ServiceState& state) : wanted_(wanted), state_(state) {}

  void operator()(const JsonPath& path, const JsonValue& value) {
    if (path.size() == 0) {
      object_ = value.kind == Kind::object;
      return;
    }
    const std::string_view list = path[0].key;
    if (path.size() == 1) {
      keep();
      if (list == "session_id") state_.has_session = true;
      if (list == "inverse3" && value.kind == Kind::array) state_.is_state = true;
      return;
    }
    if (list == "inverse3") inverse(path, value);
    if (list == "verse_grip" || list == "wireless_verse_grip") grip(path, value);
  }

  [[nodiscard]] bool finish() {
    keep();
    return object_ && !told_twice_;
  }

 private:
  /// Of a transform that does nothing.
  [[nodiscard]] static double rest_of(std::string_view part, std::string_view axis) noexcept {
    return part == "scale" || (part == "rotation" && axis == "w") ? 1.0 : 0.0;
  }

  void inverse(const JsonPath& path, const JsonValue& value) {
    if (path.size() == 2) {
      keep();
      one_ = ServiceState();
      position_ = force_ = velocity_ = 0;
      open_ = true;
      ++state_.inverses;
    }
    if (!open_) return;
    if (path.ends_from(2, "device_id") && value.kind == Kind::text) {
      once(one_.first.size == 0);
      one_.first.set(value.text);
    }
    if (path.size() == 5 && path.ends_from(2, "state", "cursor_position", path[4].key))
      once(take_axis(path[4].key, value, one_.position_m, position_));
    if (path.size() == 5 && path.ends_from(2, "state", "current_cursor_force", path[4].key))
      once(take_axis(path[4].key, value, one_.force_n, force_));
    if (path.size() == 5 && path.ends_from(2, "state", "cursor_velocity", path[4].key))
      once(take_axis(path[4].key, value, one_.velocity_m_per_s, velocity_));
    if (path.ends_from(2, "config", "filters", "damping", "scalar") && value.kind == Kind::number)
      one_.damping_n_s_per_m = value.number;
    if (path.ends_from(2, "config", "basis", "permutation")) {
      one_.has_basis = true;
      one_.right_basis = value.kind == Kind::text && value.text == kBasis;
    }
    // A text, or an object as it is written.
    if ((path.ends_from(2, "config", "preset") || path.ends_from(2, "config", "preset", "preset")) &&
        value.kind == Kind::text) {
      one_.has_preset = true;
      one_.right_preset = value.text == kPreset;
    }
    if (path.size() == 6 && path[2].key == "state" && path[3].key == "transform" && value.kind == Kind::number)
      one_.displaced = one_.displaced || std::abs(value.number - rest_of(path[4].key, path[5].key)) > kDisplaced;
    if (path.ends_from(2, "status", "calibrated") && value.kind == Kind::boolean) one_.uncalibrated = !value.boolean;
  }

  void once(bool is) noexcept { told_twice_ = told_twice_ || !is; }

  void grip(const JsonPath& path, const JsonValue& value) {
    if (path[1].index != 0) return;
    if (path.size() == 5 && path.ends_from(2, "state", "buttons", path[4].key) && value.kind == Kind::boolean &&
        value.boolean) {
      const std::string_view name = path[4].key;
      if (name == "a" || name == "b" || name == "c") state_.buttons |= 1U << static_cast<unsigned>(name[0] - 'a');
    }
    if (path.ends_from(2, "state", "button") && value.kind == Kind::boolean && value.boolean) state_.buttons |= 1U;
    if (path.size() == 5 && path.ends_from(2, "state", "orientation", path[4].key) && value.kind == Kind::number) {
      constexpr std::string_view kParts = "wxyz";
      const std::string_view name = path[4].key;
      const std::size_t part = name.size() == 1 ? kParts.find(name[0]) : std::string_view::npos;
      if (part == std::string_view::npos) return;
      orientation_[part] = value.number;
      turn_ |= 1U << part;
      if (turn_ == 15U) state_.orientation = orientation_;
    }
  }

  void keep() {
    if (!open_) return;
    open_ = false;
    if (state_.inverses == 1) state_.first = one_.first;
    const bool wanted = wanted_.empty() ? state_.inverses == 1 : one_.first == wanted_;
    if (!wanted) return;
    once(!state_.found);
    if (state_.found) return;
    state_.found = true;
    state_.has_position = position_ == 7U;
    state_.position_m = one_.position_m;
    state_.has_force = force_ == 7U;
    state_.force_n = one_.force_n;
    state_.has_velocity = velocity_ == 7U;
    state_.velocity_m_per_s = one_.velocity_m_per_s;
    state_.damping_n_s_per_m = one_.damping_n_s_per_m;
    state_.has_basis = one_.has_basis;
    state_.right_basis = one_.right_basis;
    state_.has_preset = one_.has_preset;
    state_.right_preset = one_.right_preset;
    state_.displaced = one_.displaced;
    state_.uncalibrated = one_.uncalibrated;
  }

  std::string_view wanted_;
  ServiceState& state_;
  ServiceState one_;
  unsigned position_ = 0, force_ = 0, velocity_ = 0;
  std::array<double, 4> orientation_{};
  unsigned turn_ = 0;  // which of its parts were told
  bool open_ = false, object_ = false;
  bool told_twice_ = false;  ///< who says two things of one hand is not believed in either
};

/// Text into a buffer of fixed size.
class Writer {
 public:
  explicit Writer(std::span<char> text) noexcept : text_(text) {}
  void add(std::string_view part) noexcept {
    if (part.size() > text_.size() - size_) {
      failed_ = true;
      return;
    }
    std::copy(part.begin(), part.end(), text_.begin() + static_cast<std::ptrdiff_t>(size_));
    size_ += part.size();
  }
  void add(double number) noexcept {
    std::array<char, 32> digits{};
    const auto [stop, error] = std::to_chars(digits.data(), digits.data() + digits.size(), number);
    if (error != std::errc() || !std::isfinite(number)) failed_ = true;
    add(std::string_view(digits.data(), static_cast<std::size_t>(stop - digits.data())));
  }
  [[nodiscard]] std::size_t size() const noexcept { return failed_ ? 0 : size_; }

 private:
  std::span<char> text_;
  std::size_t size_ = 0;
  bool failed_ = false;
};

void add_force(Writer& writer, std::string_view id, const Eigen::Vector3d& force_n, ForceKey key,
               std::string_view preset = {}) noexcept {
  writer.add(R"("inverse3":[{"device_id":")");
  writer.add(id);
  writer.add(R"(",)");
  if (!preset.empty()) {
    writer.add(R"("configure":{"preset":{"preset":")");
    writer.add(preset);
    writer.add(R"("},"damping":{"scalar":)");
    writer.add(kServiceDamping);
    writer.add("}},");
  }
  writer.add(R"("commands":{"set_cursor_force":{")");
  writer.add(key == ForceKey::vector ? "vector" : "values");
  writer.add(R"(":{"x":)");
  writer.add(force_n.x());
  writer.add(R"(,"y":)");
  writer.add(force_n.y());
  writer.add(R"(,"z":)");
  writer.add(force_n.z());
  writer.add("}}}}]}");
}

}  // namespace

void DeviceId::set(std::string_view id) noexcept {
  size = id.size() <= text.size() ? id.size() : 0;
  std::copy(id.begin(), id.begin() + static_cast<std::ptrdiff_t>(size), text.begin());
}

bool read_state(std::string_view text, std::string_view wanted, ServiceState& state) noexcept {
  state = ServiceState();
  StateReader reader(wanted, state);
  if (!walk_json(text, reader)) return false;
  return reader.finish();
}

std::vector<std::string> device_ids(std::string_view text) {
  std::vector<std::string> ids;
  const auto visit = [&](const JsonPath& path, const JsonValue& value) {
    if (path.size() == 3 && path[0].key == "inverse3" && path.ends_from(2, "device_id") && value.kind == Kind::text)
      ids.emplace_back(value.text);
  };
  return walk_json(text, visit) ? ids : std::vector<std::string>();
}

bool read_event(std::string_view text, std::string_view wanted, ServiceEvent& event) noexcept {
  event = ServiceEvent();
  bool object = false, released = false, other_device = false;
  const auto visit = [&](const JsonPath& path, const JsonValue& value) {
    if (path.size() == 0) object = value.kind == Kind::object;
    if (value.kind != Kind::text) return;
    if (path.ends_from(0, "name")) {
      using Event = ServiceEvent::Kind;
      const std::string_view name = value.text;
      if (name == "device-safety-triggered") event.kind = Event::safety;
      if (name == "device-disconnected" || name == "device-sleep" || name == "device-calibration-failed")
        event.kind = Event::disconnected;
      if (name == "device-connected") event.kind = Event::connected;
      if (name == "device-busy") event.kind = Event::busy;
    }
    if (path.ends_from(0, "data", "safety_type")) released = value.text == "ebrake_released";
    if (path.ends_from(0, "data", "device_id")) other_device = !wanted.empty() && value.text != wanted;
  };
  if (!walk_json(text, visit) || !object) return false;
  if (event.kind == ServiceEvent::Kind::safety && released) event.kind = ServiceEvent::Kind::released;
  event.about = !other_device;
  return true;
}

std::size_t write_setup(std::span<char> text, std::string_view id, ForceKey key) noexcept {
  Writer writer(text);
  writer.add(R"({"session":{"configure":{"profile":{"name":"sparsha"},"basis":{"permutation":")");
  writer.add(kBasis);
  writer.add(R"("}}},)");
  add_force(writer, id, Eigen::Vector3d::Zero(), key, kPreset);
  return writer.size();
}

std::size_t write_full_state_request(std::span<char> text, std::string_view id, ForceKey key) noexcept {
  Writer writer(text);
  writer.add(R"({"session":{"force_render_full_state":{}},)");
  add_force(writer, id, Eigen::Vector3d::Zero(), key);
  return writer.size();
}

std::size_t write_probe(std::span<char> text, std::string_view id) noexcept {
  Writer writer(text);
  writer.add(R"({"inverse3":[{"device_id":")");
  writer.add(id);
  writer.add(R"(","commands":{"probe_position":{}}}]})");
  return writer.size();
}

std::size_t write_force(std::span<char> text, std::string_view id, const Eigen::Vector3d& force_n,
                        ForceKey key) noexcept {
  Writer writer(text);
  writer.add("{");
  add_force(writer, id, force_n, key);
  return writer.size();
}

}  // namespace sparsha::haptics::haply
