// A device of your own: here a mass that falls onto a plate. Put your device's driver into read() and write(); the
// servo limits stiffness and force to what info() says it can bear.
#include <chrono>
#include <cstdio>
#include <thread>

#include <sparsha/device.h>
#include <sparsha/servo.h>
using namespace sparsha::haptics;

class FallingMass final : public Device {
 public:
  [[nodiscard]] DeviceInfo info() const override {
    DeviceInfo info;
    info.name = "falling mass";
    info.limits.max_force_n = 5.0;
    info.planned_time = true;  // computed from planned periods; a real device leaves this out
    return info;
  }
  [[nodiscard]] DeviceSample read(double time_s, double period_s) noexcept override {
    velocity_m_per_s_ +=
        (force_n_.z() - kMass_kg * 9.81 - kDamping_n_s_per_m * velocity_m_per_s_) / kMass_kg * period_s;
    position_m_.z() += velocity_m_per_s_ * period_s;
    return {.position_m = position_m_, .time_s = time_s, .fresh = true, .finished = time_s > 2.0};
  }
  void write(const Eigen::Vector3d& force_n) noexcept override { force_n_ = force_n; }
  void zero() noexcept override {}  // called from the watchdog's thread: real devices switch their motors off here

 private:
  static constexpr double kMass_kg = 0.1, kDamping_n_s_per_m = 2.0;
  Eigen::Vector3d position_m_{0.0, 0.0, 0.01};
  Eigen::Vector3d force_n_ = Eigen::Vector3d::Zero();
  double velocity_m_per_s_ = 0.0;
};

int main() {
  SurfaceParts plate;
  plate.lattice.nx = plate.lattice.ny = 11;
  plate.lattice.spacing_m = 0.01;
  plate.height_m.assign(plate.lattice.count(), 0.0F);
  HapticWindow window;
  window.surface = make_surface(std::move(plate));
  FallingMass device;
  ServoOptions options;
  options.real_time = false;
  options.renderer.longest_gap_s = 0.2;
  Seqlock<State> state;
  Servo servo(device, options, window, state, {}, nullptr);
  servo.start();
  while (!servo.finished()) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  const double z_m = state.read().device_m[2];
  servo.stop();
  std::printf("the mass rests %.2f mm deep; m g / k is %.2f mm at 800 N/m\n", -1e3 * z_m, 1e3 * 0.1 * 9.81 / 800.0);
  // Where the machine pauses, the wall gives way a little; without it the mass falls a metre.
  return (z_m > -0.05 && z_m < 0.01) || servo.silences() > 0 ? 0 : 1;
}
