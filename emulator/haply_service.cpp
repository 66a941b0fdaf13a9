#include "emulator/haply_service.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <random>
#include <utility>

namespace sparsha::emulator {
namespace {

using Json = nlohmann::json;

constexpr std::uint8_t kBlue = 4;
constexpr double kPoll_s = 0.02;
constexpr Vec3 kCentre_m{0.0, -0.1, 0.17};  // of the workspace, the service's frame
constexpr double kFalconMiddle_m = 0.140;   // along the person's axis
constexpr double kOther_n = 1.5;
constexpr std::uint64_t kCrossing = 3;  // commands that may have crossed an event

std::string device_id(int index) { return "EMU" + std::to_string(index); }

// The service's frame: x right, y away from the person, z up. The hand's: x right, y up, z towards the person.
Vec3 to_service(const Vec3& hand_m) {
  return {hand_m[0] + kCentre_m[0], -(hand_m[2] - kFalconMiddle_m) + kCentre_m[1], hand_m[1] + kCentre_m[2]};
}
Vec3 force_on_hand(const Vec3& service_n) { return {service_n[0], service_n[2], -service_n[1]}; }

Json xyz(const Vec3& vector) { return {{"x", vector[0]}, {"y", vector[1]}, {"z", vector[2]}}; }

/// 0 where it is missing or no number.
double number_at(const Json& object, const char* key) {
  const auto found = object.find(key);
  return found != object.end() && found->is_number() ? found->get<double>() : 0.0;
}

double size_of(const Vec3& vector) { return std::hypot(vector[0], vector[1], vector[2]); }

/// Which of the service's axes are a client's, and their signs: "X-ZY" is x, -z, y.
struct Basis {
  std::string text = "XYZ";
  std::array<std::size_t, 3> axis{0, 1, 2};
  Vec3 sign{1.0, 1.0, 1.0};

  /// False, and unchanged, where the text is no permutation.
  bool set(const std::string& permutation) {
    Basis read;
    read.text = permutation;
    std::size_t count = 0;
    double sign_of_next = 1.0;
    std::array<bool, 3> seen{};
    for (const char one : permutation) {
      if (one == '+' || one == '-') {
        sign_of_next = one == '-' ? -1.0 : 1.0;
        continue;
      }
      if (one < 'X' || one > 'Z' || count == 3) return false;
      const auto which = static_cast<std::size_t>(one - 'X');
      seen[which] = true;
      read.axis[count] = which;
      read.sign[count++] = std::exchange(sign_of_next, 1.0);
    }
    if (!seen[0] || !seen[1] || !seen[2]) return false;
    *this = read;
    return true;
  }
  [[nodiscard]] Vec3 to_client(const Vec3& service) const {
    Vec3 client{};
    for (std::size_t i = 0; i < 3; ++i) client[i] = sign[i] * service[axis[i]];
    return client;
  }
  [[nodiscard]] Vec3 to_service(const Vec3& client) const {
    Vec3 service{};
    for (std::size_t i = 0; i < 3; ++i) service[axis[i]] = sign[i] * client[i];
    return service;
  }
};

/// The same in a way that a client may meet with another version: exponents, ids last, keys and kinds that nobody
/// knows.
std::string in_other_words(const Json& list, const Json& grip) {
  const auto exponents = [](const Json& vector) {
    std::string text = "{\"unit\":\"si\"";
    for (const char* const axis : {"z", "x", "y"}) {
      std::array<char, 40> number{};
      std::snprintf(number.data(), number.size(), "%.12E", vector[axis].get<double>());
      text += std::string(",\"") + axis + "\" : " + number.data();
    }
    return text + "}";
  };
  std::string text =
      "{\n\"minverse\":[{\"device_id\":\"M\",\"state\":{\"cursor_position\":{\"x\":9,\"y\":9,\"z\":9}}}],"
      "\"time\":[1,[2,{\"inverse3\":[]}]],\"inverse3\":[";
  for (const Json& one : list) {
    if (text.back() != '[') text += ",";
    text += "{\"status\":{\"new\":[]},\"state\":{\"cursor_position\":" + exponents(one["state"]["cursor_position"]) +
            ",\"current_cursor_force\":" + exponents(one["state"]["current_cursor_force"]) +
            ",\"transform\":{\"scale\":{\"x\":1.0}}}";
    if (one.contains("config")) text += ",\"config\":" + one["config"].dump();
    text += ",\"device_id\":" + one["device_id"].dump() + "}";
  }
  return text + "],\"wireless_verse_grip\":[" + grip.dump() + "]}";
}

Vec3 minus(const Vec3& a, const Vec3& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

}  // namespace

struct HaplyService::Client {
  std::unique_ptr<WebSocketPeer> peer;
  bool events = false;
  bool ended = false;
  Vec3 commanded_n{};
  double commanded_s = -1.0;
  std::string held;  ///< an answer that waits for the next
  int session = 0;
  Basis basis;
  std::string preset = "defaults";
  double damping_n_s_per_m = 0.0;
  std::mt19937 random{7};
};

HaplyService::HaplyService(HaplyOptions options, Falcon::Hand hand) : options_(options), hand_(std::move(hand)) {
  states_ = std::make_unique<system::StreamListener>(options_.port);
  port_ = states_->port();
  if (!options_.version_3_1) {
    events_ = std::make_unique<system::StreamListener>(options_.events_port);
    events_port_ = events_->port();
  }
  advanced_s_ = now_s();
  own_.emplace_back([this] { accept(*states_, false); });
  if (events_) own_.emplace_back([this] { accept(*events_, true); });
  own_.emplace_back([this] { watch_events(); });
}

HaplyService::~HaplyService() {
  stopping_.store(true);
  for (std::thread& thread : own_) thread.join();  // they begin the others
  for (std::thread& thread : servers_) thread.join();
}

double HaplyService::now_s() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void HaplyService::note(bool to_client, const std::string& text) {
  if (log_) log_({now_s(), to_client, text});
}

void HaplyService::accept(system::StreamListener& listener, bool events) {
  int sessions = 0;
  while (!stopping_.load()) {
    auto stream = listener.accept(kPoll_s);
    if (!stream) continue;
    {
      const std::lock_guard lock(mutex_);
      if ((options_.dies || (events && options_.loses_events)) && fault_is_on()) continue;  // nobody is there
    }
    auto peer = WebSocketPeer::greet(std::move(stream));
    if (!peer) continue;
    const std::lock_guard lock(mutex_);
    clients_.push_back(std::make_unique<Client>());
    Client& client = *clients_.back();
    client.peer = std::move(peer);
    client.events = events;
    client.session = ++sessions;
    client.damping_n_s_per_m = options_.damping_n_s_per_m;
    servers_.emplace_back([this, &client] { serve(client); });
  }
}

std::string HaplyService::state(const Client& client, bool with_config) {
  Json list = Json::array();
  const bool gone = options_.disconnect && was_on_;
  const Vec3 origin_m = client.preset.ends_with("_centered") ? kCentre_m : Vec3{};
  for (int i = 0; i < options_.devices; ++i) {
    if (i == 0 && gone) continue;
    Json one{{"device_id", device_id(i)},
             {"state",
              {{"cursor_position", xyz(client.basis.to_client(minus(i == 0 ? place_m_ : kCentre_m, origin_m)))},
               {"cursor_velocity", xyz(client.basis.to_client(i == 0 ? velocity_ : Vec3{}))},
               {"current_cursor_force", xyz(client.basis.to_client(i == 0 ? applied_n_ : Vec3{}))},
               {"control_domain", "cartesian"},
               {"control_mode", size_of(applied_n_) > 0.0 ? "force" : "idle"}}},
             {"status", {{"calibrated", true}, {"battery", nullptr}}}};
    if (with_config) {
      one["config"] = {
          {"type", "inverse3"},
          {"handedness", "right"},
          {"preset", client.preset},
          {"basis", {{"permutation", client.basis.text}}},
          {"filters", {{"force_gate", {{"gain", 0.3}}}, {"damping", {{"scalar", client.damping_n_s_per_m}}}}}};
      if (options_.no_preset) one["config"].erase("preset");
      if (options_.other_words && !options_.no_preset) one["config"]["preset"] = {{"preset", client.preset}};
    }
    list.push_back(one);
  }
  const Json grip{
      {"device_id", "GRIP0"},
      {"state",
       {{"orientation",
         {{"w", std::cos(0.5 * options_.grip_tilt_rad)},
          {"x", std::sin(0.5 * options_.grip_tilt_rad)},
          {"y", 0.0},
          {"z", 0.0}}},
        {"buttons", {{"a", (buttons_ & 1U) != 0}, {"b", (buttons_ & 2U) != 0}, {"c", (buttons_ & 4U) != 0}}}}}};
  if (!options_.other_words) return Json{{"inverse3", list}, {"verse_grip", Json::array({grip})}}.dump();
  return in_other_words(list, grip);
}

std::string HaplyService::inventory(const Client& client) {
  Json all = Json::parse(state(client, true));
  all["session_id"] = client.session;
  return all.dump();
}

// The motors hold the sum of all commands of this tick; the hand moves by it.
void HaplyService::advance() {
  const double time_s = now_s();
  Vec3 sum{}, drag{};
  for (const auto& client : clients_)
    if (!client->ended && !client->events && client->commanded_s >= 0.0 &&
        time_s - client->commanded_s <= options_.tick_s)
      for (std::size_t i = 0; i < 3; ++i) {
        sum[i] += client->commanded_n[i] * options_.gate;
        drag[i] -= client->damping_n_s_per_m * velocity_[i];
      }
  const bool stopped = (options_.brake || options_.disconnect) && was_on_;
  if (options_.second_client && was_on_) sum[2] += kOther_n;
  if (stopped) sum = drag = {};
  strongest_n_ = std::max(strongest_n_, size_of(sum));
  for (std::size_t i = 0; i < 3; ++i) applied_n_[i] = sum[i] + drag[i];
  const Grip grip = hand_({time_s, force_on_hand(applied_n_), kBlue});
  const Vec3 place_m = to_service(grip.place_m);
  const double passed_s = std::max(1e-4, time_s - advanced_s_);
  for (std::size_t i = 0; seen_ && i < 3; ++i) velocity_[i] = (place_m[i] - place_m_[i]) / passed_s;
  seen_ = true;
  place_m_ = place_m;
  buttons_ = grip.buttons;
  advanced_s_ = time_s;
}

bool HaplyService::fault_is_on() {
  const double since_s = first_force_s_ < 0.0 ? -1.0 : now_s() - first_force_s_ - options_.fault_after_s;
  const bool on = since_s >= 0.0 && std::fmod(since_s, options_.fault_s + options_.fault_after_s) < options_.fault_s;
  if (on && !was_on_) spoilt_ = false;
  was_on_ = on;
  ever_on_ = ever_on_ || on;
  return on;
}

void HaplyService::configure(Client& client, const std::string& permutation, const std::string& preset) {
  if (!permutation.empty()) client.basis.set(permutation);
  if (!preset.empty()) client.preset = preset;
  if (!options_.keeps_settings) return;
  client.basis.set("XZY");
  client.preset = "custom";
}

bool HaplyService::take(Client& client, const std::string& text) {
  const Json message = Json::parse(text, nullptr, false);
  if (message.is_discarded() || !message.is_object()) return false;
  const auto text_at = [](const Json& json, const char* where) {
    const Json::json_pointer pointer{std::string(where)};
    return json.contains(pointer) && json[pointer].is_string() ? json[pointer].get<std::string>() : std::string();
  };
  configure(client, text_at(message, "/session/configure/basis/permutation"), {});
  const bool asks = message.contains(Json::json_pointer("/session/force_render_full_state"));
  client.commanded_n = {};
  client.commanded_s = now_s();
  ++commands_;
  if (!message.contains("inverse3") || !message["inverse3"].is_array()) return asks;
  for (const Json& one : message["inverse3"]) {
    if (!one.is_object() || text_at(one, "/device_id") != device_id(0)) continue;
    configure(client, text_at(one, "/configure/basis/permutation"), text_at(one, "/configure/preset/preset"));
    const Json::json_pointer damping("/configure/damping/scalar");
    if (one.contains(damping) && one[damping].is_number() && !options_.keeps_settings && options_.damps)
      client.damping_n_s_per_m = std::clamp(one[damping].get<double>(), 0.0, 20.0);
    // What is deprecated is still taken by a service of 3.5.
    for (const char* const key : {"vector", "values"}) {
      const Json::json_pointer where(std::string("/commands/set_cursor_force/") + key);
      if (!one.contains(where) || !one[where].is_object() || (options_.version_3_1 && key[1] == 'e') ||
          options_.version_3_6)
        continue;
      const Json& force = one[where];
      client.commanded_n =
          client.basis.to_service({number_at(force, "x"), number_at(force, "y"), number_at(force, "z")});
    }
  }
  const bool pushes = size_of(client.commanded_n) > 0.0;
  if (pushes && first_force_s_ < 0.0) first_force_s_ = now_s();
  if (pushes && told_ && commands_ > commands_told_ + kCrossing) ++unsafe_;
  return asks;
}

bool HaplyService::answer(Client& client, const std::string& text) {
  note(true, text);
  if (options_.merged) {
    if (client.held.empty()) {
      client.held = WebSocketPeer::frames_of(text, 1);
      return true;
    }
    return client.peer->send_raw(std::exchange(client.held, {}) + WebSocketPeer::frames_of(text, 1));
  }
  if (!options_.split) return client.peer->send(text);
  const std::string bytes = WebSocketPeer::frames_of(text, 3);
  const std::size_t each = bytes.size() / 6 + 1;
  for (std::size_t begin = 0; begin < bytes.size(); begin += each)
    if (!client.peer->send_raw(std::string_view(bytes).substr(begin, each))) return false;
  return true;
}

void HaplyService::serve(Client& client) {
  if (!client.events) {
    const std::lock_guard lock(mutex_);
    advance();
    configure(client, {}, {});
    const std::string text = inventory(client);
    note(true, text);
    if (!client.peer->send(text)) client.ended = true;
  }
  while (!stopping_.load() && !client.ended) {
    std::string text;
    const auto got = client.peer->receive(text, kPoll_s);
    const std::lock_guard lock(mutex_);
    const bool on = fault_is_on();
    const bool ends = options_.dies || (client.events && options_.loses_events);
    if (got == WebSocketPeer::Got::closed || (ends && on)) client.ended = true;
    if (got != WebSocketPeer::Got::text || client.ended || client.events) continue;
    note(false, text);
    const bool asks = take(client, text);
    advance();
    if (options_.silent && on) continue;
    std::string answered = state(client, asks);
    if (on && !spoilt_ && (options_.malformed || options_.not_framed)) {
      spoilt_ = true;
      if (options_.malformed) answered = "{\"inverse3\": [{\"state\": {\"cursor_position\": {\"x\": 0.0, ";
      if (options_.not_framed) client.peer->send_raw(std::string(32, '\xFF'));
    }
    if (options_.late) {
      std::uniform_real_distribution<double> late_s(0.001, 0.020);
      mutex_.unlock();
      std::this_thread::sleep_for(std::chrono::duration<double>(late_s(client.random)));
      mutex_.lock();
    }
    if (!answer(client, answered)) client.ended = true;
  }
  client.peer->close();
}

void HaplyService::tell(std::string_view event) {
  note(true, std::string(event));
  for (const auto& client : clients_)
    if (client->events && !client->ended && !client->peer->send(event)) client->ended = true;
}

// Events go out when the fault begins and ends, whether clients ask or not.
void HaplyService::watch_events() {
  bool told = false;
  while (!stopping_.load()) {
    std::this_thread::sleep_for(std::chrono::microseconds(500));
    const std::lock_guard lock(mutex_);
    const bool on = fault_is_on();
    if (on == told || (!options_.brake && !options_.disconnect && !options_.loses_events)) continue;
    told = on;
    const std::string id = device_id(0);
    if (options_.brake)
      tell(R"({"name":"device-safety-triggered","category":"device","level":"error","data":{"device_family":"inverse",)"
           R"("device_id":")" +
           id + R"(","safety_type":")" + (on ? "ebrake_triggered" : "ebrake_released") + R"("},"message":""})");
    else if (options_.disconnect)
      tell(std::string(R"({"name":")") + (on ? "device-disconnected" : "device-connected") +
           R"(","category":"device","level":"info","data":{"device_id":")" + id + R"("},"message":""})");
    told_ = on && !options_.loses_events;  // whose end nobody is told
    commands_told_ = commands_;
  }
}

double HaplyService::force_n() {
  const std::lock_guard lock(mutex_);
  static_cast<void>(fault_is_on());
  advance();
  return size_of(applied_n_);
}
double HaplyService::strongest_n() {
  const std::lock_guard lock(mutex_);
  return strongest_n_;
}
std::uint64_t HaplyService::unsafe_commands() {
  const std::lock_guard lock(mutex_);
  return unsafe_;
}
std::uint64_t HaplyService::commands() {
  const std::lock_guard lock(mutex_);
  return commands_;
}
bool HaplyService::faulty() {
  const std::lock_guard lock(mutex_);
  return ever_on_;
}

}  // namespace sparsha::emulator
