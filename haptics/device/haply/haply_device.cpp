// The servo's side of the Inverse Service: a command a tick, its answer the next position.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <string>
#include <thread>
#include <utility>

#include "base/error.h"
#include "haptics/device/haply/connection.h"
#include "haptics/device/haply/force_match.h"
#include "haptics/device/haply/haply.h"
#include "haptics/governor/governor.h"

namespace sparsha::haptics::haply {
namespace {

using Steady = std::chrono::steady_clock;
using Status = WebSocket::Status;

constexpr double kSilent_s = 0.1;  // then the service does not answer any more
constexpr int kMostMessages = 16;  // taken in a tick: more come only from a damaged service
constexpr int kFinalZeros = 3;
/// Of the damping that the limits count on, where the service has none: a gate that closes and opens gives no more than
/// with it (docs/touch.md, "Behind a service").
constexpr double kUndampedShare = 0.4;
/// The sheet: 4 N in 80 % of the workspace, 10 N at most.
constexpr double kMostForce_n = 4.0;
constexpr double kLift_s = 2.0;  // so long it is said that the hand must be lifted

constexpr DeviceAdvice kBrake{"device_ebrake", true};
constexpr DeviceAdvice kLift{"device_lift", true};
constexpr DeviceAdvice kShared{"device_shared", true};
constexpr DeviceAdvice kNotSetUp{"device_not_set_up", true};
constexpr DeviceAdvice kChanged{"device_changes_force", false, true};
constexpr DeviceAdvice kNoBrakeTold{"device_tells_no_brake", false, true};
constexpr DeviceAdvice kTaken{"device_changes_force", true};
constexpr double kNothing = 0.1;  // of a force, that arrives: nobody feels it

/// Ours: x right, y up, z towards the person.
Eigen::Vector3d to_device(const Eigen::Vector3d& service) { return {service.x(), service.z(), -service.y()}; }
Eigen::Vector3d to_service(const Eigen::Vector3d& device) { return {device.x(), -device.z(), device.y()}; }

class HaplyDevice final : public Device {
 public:
  HaplyDevice(std::unique_ptr<Connection> connection, const HaplyOptions& options)
      : options_(options), info_(haply_info()), finder_(options) {
    if (connection && connection->ids.size() > 1 && options.device_id.empty())
      info_.warning += "; there are " + std::to_string(connection->ids.size()) + " Inverse3, and the first, " +
                       connection->ids.front() + ", is taken";
    if (connection && !connection->events)
      info_.warning += "; this service tells of no emergency brake: keep a hand at the plug";
    if (options.watch_only) {
      info_.limits.max_force_n = 0.0;
      info_.warning += "; it is only watched: places are told from the origin that its service has";
    } else if (connection && !damps(connection->damping_n_s_per_m)) {
      info_.limits.least_damping_n_s_per_m *= kUndampedShare;
      info_.warning += "; its service has not taken the damping that it was asked for: walls are softer";
      needs_damping_ = false;
    }
    if (connection)
      adopt(connection.release());
    else
      finder_.give_back(nullptr);
  }
  ~HaplyDevice() override {
    const std::unique_ptr<Connection> connection(connection_);
    if (!connection || options_.watch_only) return;
    for (int i = 0; i < kFinalZeros; ++i)
      if (connection->send_force(Eigen::Vector3d::Zero()) != Status::ok) break;
  }

  [[nodiscard]] DeviceInfo info() const override { return info_; }

  void wait(double timeout_s) noexcept override {
    const Steady::time_point now = Steady::now();
    const auto period = std::chrono::duration_cast<Steady::duration>(std::chrono::duration<double>(timeout_s));
    next_ = std::max(next_ + period, now - period);
    std::this_thread::sleep_until(next_);
    if (connection_ == nullptr) {
      if (Connection* const found = finder_.take()) {
        adopt(found);
        tells_no_brake_ = !found->events;
      }
      return;
    }
    watch_events();
    if (connection_ != nullptr) take_answers(0.0);
    if (connection_ == nullptr || fresh_) return;
    if (!asked_) ask(Eigen::Vector3d::Zero());
    // The force of before has ended by itself: the service holds a command for one tick.
    if (connection_ != nullptr) take_answers(kStale_s);
    if (connection_ == nullptr || fresh_) return;
    asked_ = false;  // lost, and asked for again
    calm_ = false;
    if (since(heard_) > kSilent_s) lose();
  }

  [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
    DeviceSample sample;
    sample.position_m = to_device(position_m_ - options_.centre_m);
    sample.buttons = buttons_;
    sample.orientation = orientation_;
    sample.applied_n = applied_n_;
    sample.tells_applied = tells_applied_;
    sample.time_s = time_s;
    sample.delay_s = delay_s_;
    sample.fresh = fresh_;
    sample.connected = connection_ != nullptr;
    // What is no place, or no force, begins anew in free space.
    sample.homed = connection_ != nullptr && (options_.watch_only ? calm_ : may_push());
    fresh_ = false;
    if (!calm_) excited_ = Steady::now();
    advise();
    calm_ = true;
    return sample;
  }

  void write(const Eigen::Vector3d& force_n) noexcept override {
    if (connection_ == nullptr) return;
    const Eigen::Vector3d safe_n =
        may_push() ? deliverable(force_n, info_.limits.max_force_n) : Eigen::Vector3d::Zero();
    ask(zeroed_.exchange(false) ? Eigen::Vector3d::Zero() : to_service(safe_n));
  }
  [[nodiscard]] double force_share() const noexcept override { return match_.share(); }
  /// A command holds for one tick only: the servo's silence is zero force. Whatever it says next is zero as well.
  void zero() noexcept override { zeroed_.store(true); }

  [[nodiscard]] const DeviceAdvice* advice() const noexcept override {
    if (const DeviceAdvice* const own = advice_.load()) return own;
    return finder_.advice();
  }

 private:
  [[nodiscard]] static double since(Steady::time_point then) noexcept {
    return std::chrono::duration<double>(Steady::now() - then).count();
  }
  [[nodiscard]] bool may_push() const noexcept { return !braked_ && !shared_ && is_set_up() && calm_; }
  /// Basis, preset and the damping that the limits count on.
  [[nodiscard]] bool is_set_up() const noexcept { return set_up_ && (!needs_damping_ || damps(damping_n_s_per_m_)); }

  void adopt(Connection* connection) noexcept {
    connection_ = connection;
    set_up_ = connection->set_up;
    position_m_ = connection->position_m;
    velocity_m_per_s_.setZero();
    damping_n_s_per_m_ = connection->damping_n_s_per_m;
    braked_ = shared_ = asked_ = fresh_ = nothing_arrives_ = false;
    commanded_n_ = before_n_ = Eigen::Vector3d::Zero();
    match_.clear();
    heard_ = next_ = Steady::now();
  }
  void lose() noexcept {
    Connection* const connection = connection_;
    connection_ = nullptr;
    fresh_ = asked_ = false;
    buttons_ = 0;
    finder_.give_back(connection);
  }

  void ask(const Eigen::Vector3d& force_n) noexcept {
    const Status status = options_.watch_only ? connection_->send_probe() : connection_->send_force(force_n);
    if (status == Status::closed || status == Status::malformed) lose();
    if (status != Status::ok) return;
    before_n_ = commanded_n_;
    commanded_n_ = force_n;
    asked_ = true;
    asked_at_ = Steady::now();
  }

  void take_answers(double timeout_s) noexcept {
    for (int message = 0; message < kMostMessages; ++message) {
      std::string_view text;
      const Status status = connection_->states->receive(text, fresh_ ? 0.0 : timeout_s);
      if (status == Status::nothing) return;
      ServiceState state;
      // Whoever says what cannot be understood is not believed any more: connected anew, or not at all.
      if (status != Status::ok || !read_state(text, connection_->id.view(), state)) {
        lose();
        return;
      }
      if (state.is_state) take(state);
      if (connection_ == nullptr) return;
    }
  }

  void take(const ServiceState& state) noexcept {
    if (!state.found) {  // the device has gone
      lose();
      return;
    }
    if (state.tells_settings()) set_up_ = state.is_set_up();
    if (state.displaced) set_up_ = false;
    if (state.uncalibrated) calm_ = false;
    buttons_ = state.buttons;
    // The same turn, seen in our frame.
    const std::array<double, 4>& q = state.orientation;
    orientation_ = {q[0], q[1], q[3], -q[2]};
    if (!state.has_position) return;
    follow_velocity(state);
    heard_ = Steady::now();
    if (asked_) delay_s_ = since(asked_at_);
    asked_ = false;
    position_m_ = state.position_m;
    fresh_ = true;
    tells_applied_ = state.has_force;
    if (state.damping_n_s_per_m >= 0.0) damping_n_s_per_m_ = state.damping_n_s_per_m;
    if (!state.has_force) return;
    applied_n_ = to_device(state.force_n);
    match_.see(commanded_n_, before_n_, state.force_n, -damping_n_s_per_m_ * velocity_m_per_s_,
               std::min(delay_s_, 0.01));
    if (match_.others()) shared_ = true;
    // Said once, and not anew at each touch.
    if (commanded_n_.norm() > ForceMatch::kFelt_n)
      nothing_arrives_ = match_.share() < kNothing && (nothing_arrives_ || match_.differs());
  }

  /// As the service tells it; from its places where it does not.
  void follow_velocity(const ServiceState& state) noexcept {
    constexpr double kShare = 0.2, kShortest_s = 1e-4;  // of a new difference quotient
    const double passed_s = std::max(kShortest_s, since(heard_));
    if (state.has_velocity)
      velocity_m_per_s_ = state.velocity_m_per_s;
    else
      velocity_m_per_s_ += kShare * ((state.position_m - position_m_) / passed_s - velocity_m_per_s_);
  }

  void watch_events() noexcept {
    if (!connection_->events) return;
    for (int message = 0; message < kMostMessages; ++message) {
      std::string_view text;
      const Status status = connection_->events->receive(text, 0.0);
      if (status == Status::nothing) return;
      ServiceEvent event;
      if (status != Status::ok || !read_event(text, connection_->id.view(), event)) {
        lose();
        return;
      }
      using Kind = ServiceEvent::Kind;
      if (!event.about) continue;
      if (event.kind == Kind::safety) braked_ = true;
      if (event.kind == Kind::released) {
        braked_ = false;
        calm_ = false;  // a tick without a place: what follows is a fresh approach
      }
      if (event.kind == Kind::busy) shared_ = true;
      if (event.kind == Kind::disconnected) {
        lose();
        return;
      }
    }
  }

  void advise() noexcept {
    const DeviceAdvice* advice = nullptr;
    if (connection_ != nullptr) {
      if (braked_)
        advice = &kBrake;
      else if (shared_)
        advice = &kShared;
      else if (!is_set_up() && !options_.watch_only)
        advice = &kNotSetUp;
      else if (since(excited_) < kLift_s)
        advice = &kLift;
      else if (nothing_arrives_)
        advice = &kTaken;
      else if (match_.differs())
        advice = &kChanged;
      else if (tells_no_brake_)
        advice = &kNoBrakeTold;
    }
    advice_.store(advice, std::memory_order_relaxed);
  }

  HaplyOptions options_;
  DeviceInfo info_;
  Finder finder_;
  Connection* connection_ = nullptr;  // servo thread
  Eigen::Vector3d position_m_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d commanded_n_ = Eigen::Vector3d::Zero(), before_n_ = Eigen::Vector3d::Zero();
  Eigen::Vector3d velocity_m_per_s_ = Eigen::Vector3d::Zero();
  ForceMatch match_;
  std::uint64_t buttons_ = 0;
  std::array<double, 4> orientation_{};
  Eigen::Vector3d applied_n_ = Eigen::Vector3d::Zero();  ///< as the service tells it
  bool tells_applied_ = false;
  double delay_s_ = 0.0;
  double damping_n_s_per_m_ = 0.0;  ///< of the service
  bool braked_ = false;             ///< an emergency brake, or another thing that keeps the service from force
  bool shared_ = false;             ///< somebody else sends forces: until the next connection
  bool nothing_arrives_ = false;    ///< of the last force that could be felt
  bool set_up_ = false;
  bool needs_damping_ = true;     ///< else the limits are those of a service without it
  bool tells_no_brake_ = false;   ///< of a service that came later; of the first, the warning says it
  bool calm_ = true;              ///< nothing has happened in this tick after which a hand must begin anew
  Steady::time_point excited_{};  ///< when something had
  bool asked_ = false, fresh_ = false;
  Steady::time_point asked_at_{}, heard_{}, next_{};
  std::atomic<bool> zeroed_{false};
  std::atomic<const DeviceAdvice*> advice_{nullptr};
};

std::uint16_t port_of(const char* variable, std::uint16_t usual) {
  const char* const text = std::getenv(variable);
  if (text == nullptr) return usual;
  const long port = std::strtol(text, nullptr, 10);
  return port > 0 && port < 65536 ? static_cast<std::uint16_t>(port) : usual;
}

Error missing(const ConnectProblem& problem, const std::string& wanted) {
  using Kind = ConnectProblem::Kind;
  if (problem.kind == Kind::no_device && !problem.ids.empty()) {
    std::string ids;
    for (const std::string& id : problem.ids) ids += (ids.empty() ? "" : ", ") + id;
    return {ErrorKind::device, {}, "the Inverse Service knows no Inverse3 with the id '" + wanted + "'", ids};
  }
  if (problem.kind == Kind::no_device)
    return {ErrorKind::device, {}, "the Inverse Service knows no Inverse3", "one that is plugged in and calibrated"};
  if (problem.kind == Kind::closed)
    return {ErrorKind::device,
            {},
            "the Inverse Service ended the connection while it was set up",
            "a service that is not just starting or ending"};
  if (problem.kind == Kind::not_understood)
    return {ErrorKind::device,
            {},
            "what answers on the Inverse Service's port is not understood",
            "a service of 3.1 to 3.5"};
  return {ErrorKind::device,
          {},
          "no Inverse Service answers on this machine",
          "Haply's Inverse Service 3.1 to 3.5, running (port 10001)"};
}

}  // namespace

HaplyOptions options_of(const DeviceRequest& request) {
  HaplyOptions options;
  options.port = port_of("SPARSHA_HAPLY_PORT", options.port);
  options.events_port = port_of("SPARSHA_HAPLY_EVENTS_PORT", options.events_port);
  options.device_id = request.argument;
  options.wait_for_device = request.wait_for_device;
  options.watch_only = request.watch_only;
  options.stop = request.stop;
  return options;
}

DeviceInfo haply_info() {
  DeviceInfo info;
  info.name = "Haply Inverse3";
  info.workspace_width_m = 0.1;
  info.limits.max_force_n = kMostForce_n;
  info.limits.least_damping_n_s_per_m = 1.0;
  info.limits.delay_ticks = 2;
  info.paced = true;
  info.fastest_m_per_s = 5.0;
  info.warning =
      "The Inverse3's driver was not tried on hardware; the force is limited to the 4 N of its sheet, and a workspace "
      "of "
      "0.1 m is assumed to be reached everywhere";
  return info;
}

std::unique_ptr<Device> make_haply_device(const HaplyOptions& options) {
  ConnectProblem problem;
  std::unique_ptr<Connection> connection = connect(options, problem);
  if (options.stop && options.stop()) throw Cancelled();
  if (!connection && !options.wait_for_device) throw missing(problem, options.device_id);
  return std::make_unique<HaplyDevice>(std::move(connection), options);
}

DeviceKind haply_kind() {
  return {"haply",
          "[ID]",
          "the Inverse3 of Haply's Inverse Service",
          [](const DeviceRequest& request) -> std::vector<FoundDevice> {
            ConnectProblem problem;
            HaplyOptions options = options_of(request);
            options.watch_only = true;  // a list disturbs nobody
            const std::unique_ptr<Connection> connection = connect(options, problem);
            if (!connection) return {{"", false, missing(problem, request.argument).wrong(), {}}};
            std::vector<FoundDevice> found;
            for (const std::string& id : connection->ids) found.push_back({id, true, "", {}});
            return found;
          },
          [](const DeviceRequest& request) { return make_haply_device(options_of(request)); },
          {}};
}

}  // namespace sparsha::haptics::haply
