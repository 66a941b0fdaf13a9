// Devices and windows that servo tests are made of.
#pragma once

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <thread>
#include <utility>

#include "haptics/device/device.h"
#include "haptics/servo/command.h"
#include "haptics/servo/servo.h"
#include "haptics/surface/monge_surface.h"
#include "haptics/window/surface.h"
#include "tests/support/scenes.h"

namespace sparsha::haptics {

/// A window on a whole level of a scene, workspace 0.1 m.
inline HapticWindow window_on(const scene::ScenePointer& scene, int level = 0, std::uint64_t id = 1,
                              bool friction = true) {
  const scene::Lattice& lattice = scene->description().levels.at(static_cast<std::size_t>(level));
  SurfaceOptions options;
  options.id = id;
  options.effects.friction = friction;
  HapticWindow window;
  const double scale = 0.1 / ((lattice.nx - 1) * lattice.spacing_m);
  window.surface = make_surface(scene->description(), scene->read_level(level), level, scale, options);
  window.level_nx = lattice.nx;
  window.level_ny = lattice.ny;
  window.id = id;
  window.effects.friction = friction;
  return window;
}

inline DeviceSample sample_at(const Eigen::Vector3d& position_m, double time_s) {
  DeviceSample sample;
  sample.position_m = position_m;
  sample.time_s = time_s;
  sample.fresh = true;
  return sample;
}

/// Options for tests of anything but lateness: a machine that takes its processors away for up to `longest_gap_s`,
/// again and again, changes nothing in them.
inline ServoOptions patient(double longest_gap_s = 1.0) {
  ServoOptions options;
  options.renderer.longest_gap_s = longest_gap_s;
  return options;
}

/// Does in read() what a test wants, and keeps the last force. Safe to watch from other threads.
class ScriptedDevice final : public Device {
 public:
  using Script = std::function<DeviceSample(std::uint64_t tick, double time_s)>;
  explicit ScriptedDevice(Script script, bool planned_time = false) : script_(std::move(script)) {
    info_.name = "scripted";
    info_.planned_time = planned_time;
  }

  [[nodiscard]] DeviceInfo info() const override { return info_; }
  [[nodiscard]] DeviceSample read(double time_s, double) noexcept override {
    return script_(ticks_.fetch_add(1), time_s);
  }
  void write(const Eigen::Vector3d& force_n) noexcept override {
    force_n_.store(force_n.norm());
    if (force_n.norm() > strongest_n_.load()) strongest_n_.store(force_n.norm());
  }
  void zero() noexcept override {
    force_n_.store(0.0);
    zeros_.fetch_add(1);
  }

  [[nodiscard]] double force_n() const { return force_n_.load(); }
  [[nodiscard]] double strongest_n() const { return strongest_n_.load(); }
  void forget_strongest() { strongest_n_.store(0.0); }
  [[nodiscard]] std::uint64_t zeros() const { return zeros_.load(); }
  [[nodiscard]] std::uint64_t ticks() const { return ticks_.load(); }

 private:
  DeviceInfo info_;
  Script script_;
  std::atomic<std::uint64_t> ticks_{0};
  std::atomic<std::uint64_t> zeros_{0};
  std::atomic<double> force_n_{0.0};
  std::atomic<double> strongest_n_{0.0};
};

/// Waits until something is so; false after a time that only a hang exceeds.
inline bool eventually(const std::function<bool()>& so) {
  for (int i = 0; i < 20'000; ++i) {
    if (so()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

/// A servo on flat stone whose only clock is the device's, from its start to the device's last sample.
struct ClockedRun {
  template <typename ClockedDevice>
  explicit ClockedRun(ClockedDevice& device, double rate_hz = 1000.0)
      : servo(device, options(device.clock(), rate_hz), window_on(sparsha::test::flat_scene()), state, {}, nullptr) {
    servo.start();
    finished = eventually([&] { return servo.finished(); });
    servo.stop();
  }

  Seqlock<State> state;
  Servo servo;
  bool finished = false;

 private:
  static ServoOptions options(ServoClock clock, double rate_hz) {
    ServoOptions result;
    result.real_time = false;
    result.renderer.rate_hz = rate_hz;
    result.clock = std::move(clock);
    return result;
  }
};

}  // namespace sparsha::haptics
