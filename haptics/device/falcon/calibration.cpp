#include "haptics/device/falcon/calibration.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <utility>

#include <fmt/format.h>

#include "base/error.h"
#include "base/files/files.h"
#include "base/phrases/phrases.h"
#include "base/yaml/yaml.h"
#include "haptics/device/falcon/link.h"
#include "haptics/governor/adaptive_velocity.h"

namespace sparsha::haptics::falcon {
namespace {

using Eigen::Vector3d;

// The spring that holds the grip. Where the true scale is four times the assumed one, it is still stable.
constexpr double kSpring_n_per_m = 80.0;
constexpr double kDamper_n_s_per_m = 3.0;
constexpr double kIntegral_per_s = 1.0;  // of the spring's force, what is learned in a second
constexpr double kMost_n = 4.5;
constexpr double kNear_m = 0.015;  // of the middle: the person has brought it there
constexpr double kSoftStart_s = 1.0;
constexpr double kStill_m = 0.0004;  // a grip at rest stays within this
constexpr double kStill_s = 2.0;
constexpr double kMeasure_s = 3.0;
constexpr double kPlanned_s = 0.001;
constexpr double kLate_s = 0.010;   // for so long the force is held while no answer comes
constexpr double kBeyond_s = 0.1;   // at the greatest force for so long, the weight is not held
constexpr double kStep_m = 100e-6;  // of the encoders across the grip's way, with the unknown time of their answer
constexpr double kNotice = 0.05;    // of the weight, with more counts than any Falcon has: the weight hangs

/// The device, driven tick by tick, with the time that its clock gives.
class Bench {
 public:
  Bench(Device& device, const CalibrationOptions& options, const std::function<void(const std::string&)>& say,
        const std::function<bool()>& stop)
      : device_(device), options_(options), say_(say), stop_(stop) {}
  Bench(const Bench&) = delete;
  Bench& operator=(const Bench&) = delete;
  ~Bench() {
    device_.write(Vector3d::Zero());
    device_.zero();
  }

  void say(const std::string& words) const {
    if (say_) say_(words);
  }
  /// One tick with the force that the last one decided; false when it is to end.
  [[nodiscard]] bool tick() {
    if (stop_ && stop_()) return false;
    device_.wait(kPlanned_s);
    const DeviceSample sample = device_.read(seconds(), kPlanned_s);
    if (!sample.connected)
      throw Error(ErrorKind::device, {}, "calibration: the Falcon was unplugged, or its power failed",
                  "USB and power that stay plugged in; should its motors still push, pull its power supply");
    const bool was_ready = std::exchange(ready_, sample.homed);
    if (const DeviceAdvice* const advice = device_.advice(); advice != nullptr && advice != told_) {
      told_ = advice;
      if (advice->needed) say(phrases_.text_or(advice->phrase));
    }
    const double now_s = seconds();
    if (!sample.fresh) {
      // A force that comes and goes would never let the weight rest.
      const bool late = ready_ && sample.homed && now_s - fresh_s_ < kLate_s;
      device_.write(late ? force_n_ : Vector3d(Vector3d::Zero()));
      return true;
    }
    motion_.add(sample.position_m, fresh_s_ > 0.0 ? now_s - fresh_s_ : 0.0);
    period_s_ = fresh_s_ > 0.0 ? std::min(0.01, now_s - fresh_s_) : kPlanned_s;
    fresh_s_ = now_s;
    position_m_ = sample.position_m;
    if (holding_ && ready_ && !was_ready) grasp();  // homed anew, the grip is far from the middle
    hold();
    return true;
  }
  /// Ticks until `done`; false when it is to end. Throws after the person's patience.
  template <class Done>
  [[nodiscard]] bool until(const Done& done, const char* wrong, const char* expected) {
    const double began_s = seconds();
    while (!done()) {
      if (!tick()) return false;
      if (seconds() - began_s > options_.patience_s)
        throw Error(ErrorKind::device, {}, std::string("calibration: ") + wrong, expected);
    }
    return true;
  }

  /// Takes the grip where it is and leads it to the middle.
  void grasp() {
    holding_ = true;
    held_since_s_ = seconds();
    from_m_ = position_m_;
    learned_n_.setZero();
  }
  [[nodiscard]] bool ready() const { return ready_; }
  [[nodiscard]] bool near_middle() const { return ready_ && position_m_.norm() < kNear_m; }
  /// Upwards, as the motors make it by the present scale.
  [[nodiscard]] double lift_n() const { return share_ * force_n_.y(); }
  [[nodiscard]] double seconds() const {
    if (options_.clock_s) return options_.clock_s();
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
  }
  /// For so long has the grip stayed where it is.
  [[nodiscard]] double still_s() {
    if ((position_m_ - still_m_).norm() > kStill_m) {
      still_m_ = position_m_;
      still_since_s_ = seconds();
    }
    return seconds() - still_since_s_;
  }
  /// A single tick at the greatest force is one that came late.
  [[nodiscard]] bool at_limit() const { return beyond_s_ > kBeyond_s; }

 private:
  const Phrases phrases_ = Phrases::of("en");
  void hold() {
    force_n_.setZero();
    if (holding_ && ready_) {
      const double share = std::clamp((seconds() - held_since_s_) / kSoftStart_s, 0.0, 1.0);
      const Vector3d way_m = (1.0 - share) * from_m_ - position_m_;
      learned_n_ += kIntegral_per_s * period_s_ * kSpring_n_per_m * way_m;
      if (learned_n_.norm() > kMost_n) learned_n_ *= kMost_n / learned_n_.norm();
      force_n_ = kSpring_n_per_m * way_m + learned_n_ - kDamper_n_s_per_m * motion_.velocity(kStep_m);
      if (force_n_.norm() > kMost_n) force_n_ *= kMost_n / force_n_.norm();
    }
    beyond_s_ = force_n_.norm() > 0.98 * kMost_n ? beyond_s_ + period_s_ : 0.0;
    share_ = device_.force_share();
    device_.write(force_n_);
  }

  Device& device_;
  const CalibrationOptions& options_;
  const std::function<void(const std::string&)>& say_;
  const std::function<bool()>& stop_;
  std::chrono::steady_clock::time_point began_ = std::chrono::steady_clock::now();
  const DeviceAdvice* told_ = nullptr;
  AdaptiveVelocity motion_;
  Vector3d position_m_ = Vector3d::Zero();
  Vector3d force_n_ = Vector3d::Zero();
  Vector3d learned_n_ = Vector3d::Zero();
  Vector3d from_m_ = Vector3d::Zero();
  Vector3d still_m_ = Vector3d::Zero();
  double share_ = 1.0;  // of the force, that warm motors make
  double still_since_s_ = 0.0;
  double held_since_s_ = 0.0;
  double fresh_s_ = 0.0;
  double beyond_s_ = 0.0;  // at the greatest force without a break, while answers came
  double period_s_ = kPlanned_s;
  bool ready_ = false;
  bool holding_ = false;
};

struct Mean {
  double value = 0.0;
  double error = 0.0;  // standard error, from ten parts of the time: what follows closely is not independent
};

/// The upward force over some seconds; empty when it is to end.
std::optional<Mean> measure_once(Bench& bench) {
  constexpr int kParts = 10;
  std::array<double, kParts> parts{};
  for (double& part : parts) {
    const double until_s = bench.seconds() + kMeasure_s / kParts;
    double sum = 0.0;
    std::uint64_t count = 0;
    while (bench.seconds() < until_s || count == 0) {
      if (!bench.tick()) return std::nullopt;
      sum += bench.lift_n();
      ++count;
    }
    part = sum / static_cast<double>(count);
  }
  Mean mean;
  for (const double part : parts) mean.value += part / kParts;
  for (const double part : parts) mean.error += (part - mean.value) * (part - mean.value);
  mean.error = std::sqrt(mean.error / (kParts * (kParts - 1)));
  return mean;
}

/// Again where the machine paused or somebody touched the grip: the calmest of some.
std::optional<Mean> measure(Bench& bench) {
  constexpr int kTries = 4;
  constexpr double kCalm_n = 0.005;
  std::optional<Mean> best;
  for (int i = 0; i < kTries && !(best && best->error < kCalm_n); ++i) {
    if (i > 0 && !bench.until([&] { return bench.still_s() > kStill_s; }, "the grip does not come to rest",
                              "nobody touching it"))
      return std::nullopt;
    const std::optional<Mean> mean = measure_once(bench);
    if (!mean) return std::nullopt;
    if (!best || mean->error < best->error) best = mean;
  }
  return best;
}

Calibration conclude(const CalibrationOptions& options, const Mean& empty, const Mean& loaded) {
  Calibration result;
  result.weight_n = options.weight_n;
  result.empty_n = empty.value;
  result.loaded_n = loaded.value;
  result.scatter_n = std::hypot(empty.error, loaded.error);
  const double grown_n = loaded.value - empty.value;
  // The motors made `weight_n` out of the commands for `grown_n`.
  result.counts_per_newton_metre = options.counts_per_newton_metre * grown_n / options.weight_n;
  const double counts = result.counts_per_newton_metre;
  if (!(counts >= kLeastCounts && counts <= kMostCounts))
    throw Error(ErrorKind::device, {},
                fmt::format("calibration: {:.0f} motor counts per newton metre come out, which no Falcon has", counts),
                fmt::format("a weight of {:.0f} g hanging freely from the grip, and nothing else touching it",
                            1e3 * options.weight_n / 9.80665));
  if (!(result.scatter_n < 0.05 * grown_n))
    throw Error(ErrorKind::device, {},
                fmt::format("calibration: the forces scatter by {:.0f} %", 100.0 * result.scatter_n / grown_n),
                "a weight at rest; try again with a heavier one");
  return result;
}

}  // namespace

std::filesystem::path calibration_file() { return own_file("falcon.yaml"); }

std::optional<double> stored_calibration(const std::filesystem::path& file) {
  std::error_code code;
  if (file.empty() || !std::filesystem::exists(file, code)) return std::nullopt;
  const yaml::Node node = yaml::parse_file(file);
  yaml::MapReader reader(node, "the Falcon's calibration");
  double counts = kUsualCounts;
  static_cast<void>(reader.required("counts_per_newton_metre"));
  reader.read("counts_per_newton_metre", counts, kLeastCounts, kMostCounts);
  reader.finish();
  return counts;
}

void require_calibration_place(const std::filesystem::path& file) {
  if (file.empty())
    throw Error(ErrorKind::device, {}, "calibration: no place to keep it", "HOME or XDG_CONFIG_HOME set");
  std::error_code code;
  std::filesystem::create_directories(file.parent_path(), code);
  if (code)
    throw Error(ErrorKind::failure, {file.parent_path().string()}, "cannot create the folder: " + code.message(),
                "a place where the calibration can be kept");
  require_writable(file);
}

void store_calibration(double counts_per_newton_metre, const std::filesystem::path& file) {
  require_calibration_place(file);
  write_file(file, fmt::format("# Written by `sparsha device calibrate`.\ncounts_per_newton_metre: {:.1f}\n",
                               counts_per_newton_metre));
}

std::optional<Calibration> calibrate(Device& device, const CalibrationOptions& options,
                                     const std::function<void(const std::string&)>& say,
                                     const std::function<bool()>& stop) {
  Bench bench(device, options, say, stop);
  if (!bench.until([&] { return bench.ready(); }, "the Falcon was not homed in time",
                   "the grip pulled fully out, pushed fully in, and pulled out once more"))
    return std::nullopt;
  bench.say("Bring the grip to the middle of its way, then let it go: the Falcon holds it");
  if (!bench.until([&] { return bench.near_middle(); }, "the grip did not come to the middle",
                   "the grip in the middle of its way"))
    return std::nullopt;
  bench.grasp();
  const auto still = [&] { return bench.still_s() > kStill_s; };
  if (!bench.until(still, "the bare grip does not come to rest", "nobody touching it")) return std::nullopt;
  const std::optional<Mean> empty = measure(bench);
  if (!empty) return std::nullopt;
  bench.say(fmt::format("Hang {:.0f} g from the grip and let go", 1e3 * options.weight_n / 9.80665));
  const double notice_n = kNotice * options.weight_n;
  double light_s = bench.seconds();  // when the force was last that of the bare grip
  const auto hangs = [&] {
    if (bench.at_limit())
      throw Error(ErrorKind::device, {}, "calibration: the weight is more than the motors hold", "a lighter weight");
    if (bench.lift_n() < empty->value + notice_n) light_s = bench.seconds();
    return bench.seconds() - light_s > kStill_s && still();
  };
  if (!bench.until(hangs, "no weight was felt, or it does not come to rest", "the weight hanging still from the grip"))
    return std::nullopt;
  const std::optional<Mean> loaded = measure(bench);
  if (!loaded) return std::nullopt;
  return conclude(options, *empty, *loaded);
}

}  // namespace sparsha::haptics::falcon
