// The servo's side of a plug-in.
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <system_error>
#include <thread>
#include <utility>

#include "base/error.h"
#include "base/text/printable.h"
#include "haptics/device/plugin/exchange.h"
#include "haptics/device/plugin/plugin.h"
#include "haptics/device/plugin/rate_watch.h"
#include "haptics/governor/governor.h"

namespace sparsha::haptics::plugin {
namespace {

constexpr double kUsualFastest_m_per_s = 5.0;
constexpr std::chrono::seconds kOpening{10};
constexpr double kRescue_s = 3.0;
constexpr int kPriority = 80;
constexpr double kSilent_s = 0.1;   // then it is said
constexpr double kRefused_s = 0.5;  // after a force that the plug-in did not take, none is asked for
constexpr double kMostAway = 4.0;   // workspaces from the middle: no place

constexpr DeviceAdvice kEnded{"plugin_ended", true};
constexpr DeviceAdvice kSilent{"plugin_silent", true};
constexpr DeviceAdvice kWrong{"plugin_wrong", true};
constexpr DeviceAdvice kRefuses{"plugin_refuses", true};

double number_of(std::uint64_t word) noexcept { return std::bit_cast<double>(word); }

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& wrong, const std::string& wanted) {
  throw Error(ErrorKind::device, {file.string()}, wrong, wanted);
}

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& wrong) {
  refuse(file, "the plug-in cannot be used: " + wrong,
         "a shared library after sparsha/device_plugin.h, version " + std::to_string(SPARSHA_DEVICE_PLUGIN_VERSION));
}

DeviceInfo info_of(const sparsha_device_info& said) {
  DeviceInfo info;
  info.name = said.name[0] == '\0' ? "a plug-in without a name" : printable(said.name);
  if (std::isfinite(said.workspace_width_m) && said.workspace_width_m >= 0.01 && said.workspace_width_m <= 2.0) {
    info.workspace_width_m = said.workspace_width_m;
  } else {
    info.warning = info.name + ": its workspace cannot be; 0.1 m is taken, and no force";
    info.workspace_width_m = 0.1;
  }
  info.limits.max_force_n = info.warning.empty() ? said.max_force_n : 0.0;
  info.limits.least_damping_n_s_per_m = said.least_damping_n_s_per_m;
  info.limits.slew_n_per_s = said.slew_n_per_s;
  info.limits.delay_ticks = static_cast<int>(std::min<std::uint32_t>(said.delay_ticks, kLongestDelayTicks));
  info.limits.encoder_step_m = 1e-6 * static_cast<double>(said.encoder_step_um);
  info.limits = usable(info.limits);
  info.paced = true;
  info.rate_hz = said.rate_hz > 0.0 ? said.rate_hz : kUsualRate_hz;
  info.fastest_m_per_s = said.fastest_m_per_s > 0.0 ? std::min(said.fastest_m_per_s, 100.0) : kUsualFastest_m_per_s;
  return info;
}

class PluginDevice final : public Device {
 public:
  PluginDevice(const std::filesystem::path& file, const std::function<bool()>& stop)
      : worker_(
            sizeof(Exchange),
            [name = file.string()](void* shared) { run_plugin(name.c_str(), *static_cast<Exchange*>(shared)); },
            [name = file.string()](void*) { switch_off(name.c_str()); }, kRescue_s, kPriority),
        shared_(*static_cast<Exchange*>(worker_.shared())) {
    wait_until_open(file, stop);
    if (const double rate_hz = shared_.info.rate_hz;
        rate_hz != 0.0 && !(rate_hz >= kLeastRate_hz && rate_hz <= kMostRate_hz))
      refuse(file, fmt::format("the plug-in cannot be used: its rate of {:g} Hz is none for a hand", rate_hz),
             fmt::format("{:g} to {:g} Hz, or 0 for {:g}", kLeastRate_hz, kMostRate_hz, kUsualRate_hz));
    info_ = info_of(shared_.info);
    rate_ = RateWatch(info_.rate_hz);
  }
  ~PluginDevice() override { put(Eigen::Vector3d::Zero()); }

  [[nodiscard]] DeviceInfo info() const override { return info_; }

  void wait(double timeout_s) noexcept override {
    shared_.servo_beats.fetch_add(1, std::memory_order_relaxed);
    // The last force is held for as long as a hand is not stale without news (kStale_s).
    const double patience_s = std::max(timeout_s, kStale_s);
    if (worker_.end() != system::WorkerEnd::none)
      std::this_thread::sleep_for(std::chrono::duration<double>(timeout_s));
    else
      system::wait_for_change(shared_.samples.count(), number_, patience_s);
    shared_.servo_beats.fetch_add(1, std::memory_order_relaxed);
  }

  [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
    SampleWords words{};
    std::uint32_t number = 0;
    const bool came = shared_.samples.get(words, number) && number != number_;
    if (came) {
      number_ = number;
      words_ = words;
      heard_s_ = time_s;
    }
    DeviceSample sample;
    sample.position_m = {number_of(words_[0]), number_of(words_[1]), number_of(words_[2])};
    for (std::size_t i = 0; i < 4; ++i) sample.orientation[i] = number_of(words_[3 + i]);
    sample.buttons = words_[8];
    sample.time_s = time_s;
    sample.delay_s = number_of(words_[7]);  // the servo takes none that cannot be
    sample.fresh = came && (words_[9] & 1U) != 0;
    const bool runs = worker_.end() == system::WorkerEnd::none;
    sample.connected = runs && (words_[9] & 4U) != 0;
    rate_.tick(time_s, sample.fresh);
    if (const std::uint32_t refusals = shared_.refusals.load(std::memory_order_relaxed); refusals != refusals_) {
      refusals_ = refusals;
      refused_until_s_ = time_s + kRefused_s;
    }
    const bool away = sample.position_m.allFinite() && sample.position_m.norm() > kMostAway * info_.workspace_width_m;
    sample.homed = (words_[9] & 2U) != 0 && !rate_.wrong() && !away && time_s >= refused_until_s_;
    advise(runs, time_s, away || !sample.position_m.allFinite());
    return sample;
  }

  void write(const Eigen::Vector3d& force_n) noexcept override { put(deliverable(force_n, info_.limits.max_force_n)); }
  void zero() noexcept override {
    // From the watchdog's thread: only the servo's own writes mails.
    shared_.void_up_to.store(shared_.force.count().load());
  }
  [[nodiscard]] const DeviceAdvice* advice() const noexcept override { return advice_.load(); }

 private:
  void wait_until_open(const std::filesystem::path& file, const std::function<bool()>& stop) {
    const auto began = std::chrono::steady_clock::now();
    for (;;) {
      const Stage stage = shared_.stage.load();
      if (stage == Stage::runs) return;
      if (stage == Stage::refused) refuse(file, printable(shared_.problem));
      if (stage == Stage::not_open)
        refuse(file, std::string("the plug-in cannot open its device: ") + printable(shared_.problem),
               "a device that is plugged in and in order, as its driver wants it");
      if (worker_.end() != system::WorkerEnd::none)
        refuse(file,
               "the plug-in crashed while it was opened (signal " + std::to_string(shared_.head.signal.load()) + ")",
               "a plug-in whose open() returns");
      if (stop && stop()) throw Cancelled();
      if (std::chrono::steady_clock::now() - began > kOpening)
        refuse(file, "the plug-in has not opened its device for ten seconds",
               "a plug-in whose open() returns within them");
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

  void put(const Eigen::Vector3d& force_n) noexcept {
    std::array<std::uint64_t, 3> words{};
    for (std::size_t i = 0; i < 3; ++i) words[i] = std::bit_cast<std::uint64_t>(force_n[static_cast<Eigen::Index>(i)]);
    shared_.force.put(words);
  }

  void advise(bool runs, double time_s, bool wrong) noexcept {
    const DeviceAdvice* advice = nullptr;
    if (!runs)
      advice = worker_.end() == system::WorkerEnd::hung ? &kSilent : &kEnded;
    else if (time_s - heard_s_ > kSilent_s)
      advice = &kSilent;
    else if (wrong || rate_.wrong())
      advice = &kWrong;
    else if (time_s < refused_until_s_)
      advice = &kRefuses;
    advice_.store(advice, std::memory_order_relaxed);
  }

  system::Worker worker_;
  Exchange& shared_;
  DeviceInfo info_;
  RateWatch rate_{kUsualRate_hz};
  std::uint32_t number_ = 0;
  SampleWords words_{};
  double heard_s_ = 0.0;
  std::uint32_t refusals_ = 0;
  double refused_until_s_ = 0.0;
  std::atomic<const DeviceAdvice*> advice_{nullptr};
};

}  // namespace

std::unique_ptr<Device> make_plugin_device(const std::filesystem::path& file, const std::function<bool()>& stop) {
  std::error_code code;
  const std::filesystem::path whole = std::filesystem::absolute(file, code);
  if (code || !std::filesystem::is_regular_file(whole, code)) refuse(file, "there is no such file");
  return std::make_unique<PluginDevice>(whole, stop);
}

DeviceKind plugin_kind() {
  return {"plugin",
          "FILE.so",
          "a driver of your own, after sparsha/device_plugin.h, as plugin:FILE.so",
          [](const DeviceRequest&) -> std::vector<FoundDevice> {
            return {{"", true, "", {}}};
          },
          [](const DeviceRequest& request) { return make_plugin_device(request.argument, request.stop); },
          {}};
}

}  // namespace sparsha::haptics::plugin
