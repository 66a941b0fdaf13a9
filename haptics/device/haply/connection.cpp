#include "haptics/device/haply/connection.h"

#include <algorithm>
#include <chrono>
#include <utility>

namespace sparsha::haptics::haply {
namespace {

using Steady = std::chrono::steady_clock;
using Kind = ConnectProblem::Kind;

constexpr double kGreeting_s = 1.0;
constexpr double kReadBack_s = 0.5;
constexpr double kAsksAgain_s = 0.1;  // without an answer
constexpr int kReadBackMessages = 8;

constexpr DeviceAdvice kNoService{"device_no_service", true};
constexpr DeviceAdvice kAway{"device_away", true};
constexpr DeviceAdvice kNoEvents{"device_no_events", true};

const DeviceAdvice* advice_on(Kind problem) {
  if (problem == Kind::no_device) return &kAway;
  return problem == Kind::no_events ? &kNoEvents : &kNoService;
}

double since(Steady::time_point then) { return std::chrono::duration<double>(Steady::now() - then).count(); }

/// The inventory comes by itself.
bool read_inventory(Connection& connection, const HaplyOptions& options, ConnectProblem& problem) {
  const Steady::time_point began = Steady::now();
  while (since(began) < kGreeting_s) {
    std::string_view text;
    const auto status = connection.states->receive(text, kGreeting_s - since(began));
    ServiceState state;
    if (status == WebSocket::Status::closed) {
      problem.kind = Kind::closed;
      return false;
    }
    if (status != WebSocket::Status::ok || !read_state(text, options.device_id, state)) break;
    if (!state.is_state) continue;
    problem = {Kind::no_device, device_ids(text)};
    if (!state.found) return false;
    if (options.device_id.empty())
      connection.id = state.first;
    else
      connection.id.set(options.device_id);
    if (connection.id.size == 0) return false;
    connection.ids = problem.ids;
    connection.position_m = state.position_m;
    return true;
  }
  problem.kind = Kind::not_understood;
  return false;
}

/// What the service tells after the settings were sent, asked for in messages of their own: what it told before counts
/// for nothing, and its usual answers leave the configuration out.
bool read_back(Connection& connection, ConnectProblem& problem) {
  problem.kind = Kind::closed;
  std::array<char, 512> text{};
  const auto send = [&](std::size_t size) {
    return size > 0 && connection.states->send({text.data(), size}) == WebSocket::Status::ok;
  };
  if (!send(write_setup(text, connection.id.view(), connection.force_key))) return false;
  const Steady::time_point began = Steady::now();
  for (int message = 0; message < kReadBackMessages && since(began) < kReadBack_s; ++message) {
    std::string_view answer;
    const auto status = connection.states->receive(answer, std::min(kAsksAgain_s, kReadBack_s - since(began)));
    if (status == WebSocket::Status::nothing) {
      if (!send(write_full_state_request(text, connection.id.view(), connection.force_key))) return false;
      continue;
    }
    ServiceState state;
    if (status == WebSocket::Status::closed) return false;
    if (status != WebSocket::Status::ok || !read_state(answer, connection.id.view(), state)) {
      problem.kind = Kind::not_understood;
      return false;
    }
    if (state.has_position) connection.position_m = state.position_m;
    connection.set_up = state.is_set_up();
    if (state.damping_n_s_per_m >= 0.0) connection.damping_n_s_per_m = state.damping_n_s_per_m;
    if (connection.set_up && damps(connection.damping_n_s_per_m)) break;
    if (!send(write_full_state_request(text, connection.id.view(), connection.force_key))) return false;
  }
  return true;
}

}  // namespace

WebSocket::Status Connection::send_force(const Eigen::Vector3d& force_n) noexcept {
  const std::size_t size = write_force(text_, id.view(), force_n, force_key);
  return size == 0 ? WebSocket::Status::malformed : states->send({text_.data(), size});
}

WebSocket::Status Connection::send_probe() noexcept {
  const std::size_t size = write_probe(text_, id.view());
  return size == 0 ? WebSocket::Status::malformed : states->send({text_.data(), size});
}

std::unique_ptr<Connection> connect(const HaplyOptions& options, ConnectProblem& problem) {
  problem = {Kind::no_service, {}};
  auto connection = std::make_unique<Connection>();
  connection->states = WebSocket::open(options.port, kGreeting_s);
  if (!connection->states || !read_inventory(*connection, options, problem)) return nullptr;
  connection->events = WebSocket::open(options.events_port, kGreeting_s);
  if (!connection->events && options.needs_events) {
    problem.kind = Kind::no_events;
    return nullptr;
  }
  // Only services with events, 3.5 and later, are known to want `vector`.
  connection->force_key = connection->events ? ForceKey::vector : ForceKey::values;
  if (!options.watch_only && !read_back(*connection, problem)) return nullptr;
  problem = {};
  return connection;
}

Finder::Finder(HaplyOptions options) : options_(std::move(options)), plug_([this] { return find(); }) {}

std::unique_ptr<Connection> Finder::find() {
  HaplyOptions options = options_;
  if (taken_.size > 0) options.device_id = taken_.view();
  options.needs_events = had_events_;
  ConnectProblem problem;
  std::unique_ptr<Connection> found = connect(options, problem);
  advice_.store(found ? nullptr : advice_on(problem.kind));
  return found;
}

}  // namespace sparsha::haptics::haply
