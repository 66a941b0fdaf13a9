// The process in which a plug-in lives.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <thread>

#include "base/system/library.h"
#include "haptics/device/plugin/exchange.h"

namespace sparsha::haptics::plugin {
namespace {

constexpr double kForceWait = 0.5;  // of a period: so long a position's own force is waited for
constexpr int kFinalZeros = 3;
constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kNoCall = 0;  // between two ticks

void refuse(Exchange& shared, const std::string& problem, Stage stage = Stage::refused) {
  std::snprintf(shared.problem, sizeof shared.problem, "%s", problem.c_str());
  shared.stage.store(stage);
}

/// The table, or null and the reason.
const sparsha_device_plugin* load(const char* file, std::string& problem) {
  void* const library = system::load_library(file, problem);
  if (library == nullptr) return nullptr;
  using Entry = const sparsha_device_plugin* (*)();
  const auto entry = reinterpret_cast<Entry>(system::symbol(library, "sparsha_device_plugin_entry"));
  const sparsha_device_plugin* const table = entry == nullptr ? nullptr : entry();
  if (table == nullptr) {
    problem = "it has no function sparsha_device_plugin_entry() that returns a table";
  } else if (table->version != SPARSHA_DEVICE_PLUGIN_VERSION || table->size < sizeof(sparsha_device_plugin)) {
    problem = "it is written for version " + std::to_string(table->version) +
              " of sparsha/device_plugin.h, and this is " + std::to_string(SPARSHA_DEVICE_PLUGIN_VERSION);
  } else if (table->open == nullptr || table->info == nullptr || table->read == nullptr || table->write == nullptr ||
             table->zero == nullptr || table->close == nullptr) {
    problem = "a function of its table is missing";
  } else {
    return table;
  }
  return nullptr;
}

bool open(const sparsha_device_plugin& plugin, std::string& problem) {
  char text[256] = {};
  if (plugin.open(text, sizeof text) == 0) return true;
  text[sizeof text - 1] = '\0';
  problem = text[0] == '\0' ? "it does not say why" : text;
  return false;
}

/// One thread calls the plug-in; another switches the motors off while a call hangs.
class Host {
 public:
  Host(const sparsha_device_plugin& plugin, Exchange& shared) : plugin_(plugin), shared_(shared) {}

  void run() {
    const double rate_hz = shared_.info.rate_hz > 0.0 ? shared_.info.rate_hz : kUsualRate_hz;
    const auto period_ns = static_cast<std::int64_t>(1e9 / std::clamp(rate_hz, kLeastRate_hz, kMostRate_hz));
    std::thread guard([this] { watch(); });
    std::int64_t planned_ns = system::shared_time_ns();
    while (shared_.head.stop.load(std::memory_order_relaxed) == 0) {
      planned_ns = std::max(planned_ns + period_ns, system::shared_time_ns() - period_ns);
      system::sleep_until_shared_ns(planned_ns);
      tick(1e-9 * static_cast<double>(period_ns));
    }
    for (int i = 0; i < kFinalZeros; ++i) write({});
    shared_.head.rescue.store(0);
    over_.store(true);
    guard.join();
    plugin_.zero();
    plugin_.close();
  }

 private:
  void tick(double period_s) {
    begin_call();
    sparsha_device_sample sample{};
    const bool read = plugin_.read(&sample) == 0;
    if (!read) sample = {};
    const std::uint32_t before = shared_.force.count().load();
    shared_.samples.put(words_of(sample));
    system::wait_for_change(shared_.force.count(), before, kForceWait * period_s);
    begin_call();
    write(wanted());
    called_ns_.store(kNoCall);
  }

  void begin_call() {
    shared_.head.beats.fetch_add(1);
    called_ns_.store(system::shared_time_ns());
  }

  std::array<double, 3> wanted() {
    std::array<std::uint64_t, 3> words{};
    std::uint32_t number = 0;
    const std::int64_t now_ns = system::shared_time_ns();
    if (const std::uint64_t beats = shared_.servo_beats.load(); beats != servo_beats_) {
      servo_beats_ = beats;
      servo_heard_ns_ = now_ns;
    }
    if (now_ns - servo_heard_ns_ > kServoSilent_ns || !shared_.force.get(words, number)) return {};
    if (static_cast<std::int32_t>(number - shared_.void_up_to.load()) <= 0) return {};  // the watchdog's zero
    std::array<double, 3> force_n{};
    for (std::size_t i = 0; i < 3; ++i) force_n[i] = std::bit_cast<double>(words[i]);
    for (const double part_n : force_n)
      if (!std::isfinite(part_n)) return {};
    return force_n;
  }

  void write(const std::array<double, 3>& force_n) {
    const bool force = force_n != std::array<double, 3>{};
    if (force) shared_.head.rescue.store(1);  // before it goes out
    if (plugin_.write(force_n.data()) != 0) {
      shared_.refusals.fetch_add(1);
      plugin_.zero();
    } else if (!force && ++zeros_ >= kFinalZeros) {
      shared_.head.rescue.store(0);
    }
    if (force) zeros_ = 0;
  }

  void watch() {
    while (!over_.load()) {
      system::sleep_until_shared_ns(system::shared_time_ns() + kMs);
      const std::int64_t called_ns = called_ns_.load();
      if (called_ns != kNoCall && system::shared_time_ns() - called_ns > kCallHangs_ns) plugin_.zero();
    }
  }

  const sparsha_device_plugin& plugin_;
  Exchange& shared_;
  std::atomic<std::int64_t> called_ns_{kNoCall};
  std::atomic<bool> over_{false};
  std::uint64_t servo_beats_ = 0;
  std::int64_t servo_heard_ns_ = 0;
  int zeros_ = 0;
};

}  // namespace

void run_plugin(const char* file, Exchange& shared) {
  std::string problem;
  shared.stage.store(Stage::opens);
  const sparsha_device_plugin* const plugin = load(file, problem);
  if (plugin == nullptr) {
    refuse(shared, problem);
    return;
  }
  if (!open(*plugin, problem)) {
    refuse(shared, problem, Stage::not_open);
    return;
  }
  sparsha_device_info info{};
  if (plugin->info(&info) != 0) {
    plugin->close();
    refuse(shared, "it does not say what its device can do: info() fails");
    return;
  }
  info.name[sizeof info.name - 1] = '\0';
  shared.info = info;
  shared.head.hangs_after_ms.store(kKilledAfter_ms);
  shared.stage.store(Stage::runs);
  Host(*plugin, shared).run();
}

void switch_off(const char* file) {
  std::string problem;
  const sparsha_device_plugin* const plugin = load(file, problem);
  if (plugin == nullptr) return;
  static_cast<void>(open(*plugin, problem));
  for (int i = 0; i < kFinalZeros; ++i) plugin->zero();
  plugin->close();
}

}  // namespace sparsha::haptics::plugin
