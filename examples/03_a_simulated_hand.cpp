// The servo with a simulated hand: 1000 ticks a second, and what they tell, read from another thread.
#include <chrono>
#include <cmath>
#include <cstdio>
#include <thread>
#include <vector>

#include <sparsha/device.h>
#include <sparsha/servo.h>

int main() {
  using namespace sparsha;

  // A dome, 20 mm high, on 100 mm; it fills the workspace of the device.
  haptics::SurfaceParts parts;
  parts.lattice.nx = parts.lattice.ny = 201;
  parts.lattice.spacing_m = 0.0005;
  for (int j = 0; j < parts.lattice.ny; ++j)
    for (int i = 0; i < parts.lattice.nx; ++i) {
      const double r_m = std::hypot(parts.lattice.x_m(i) - 0.05, parts.lattice.y_m(j) - 0.05);
      parts.height_m.push_back(static_cast<float>(0.02 * std::exp(-r_m * r_m / (0.03 * 0.03))));
    }
  haptics::HapticWindow window;
  window.surface = haptics::make_surface(std::move(parts));

  constexpr double kSeconds = 4.0;
  const auto hand = haptics::make_simulated_device(1, kSeconds);
  haptics::ServoOptions options;
  options.real_time = false;             // true asks for SCHED_FIFO and locked memory
  options.renderer.longest_gap_s = 0.2;  // no person holds this device; leave the default where one does
  haptics::Seqlock<haptics::State> state;
  haptics::Servo servo(*hand, options, window, state, {}, nullptr);
  servo.start();
  double peak_n = 0.0;
  int in_contact = 0;
  while (!servo.finished()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
    const haptics::State now = state.read();
    const double force_n = std::hypot(now.commanded_force_n[0], now.commanded_force_n[1], now.commanded_force_n[2]);
    peak_n = std::max(peak_n, force_n);
    in_contact += now.contact != 0 ? 1 : 0;
  }
  servo.stop();
  std::printf("%llu ticks, seen in contact %d times, peak force %.2f N, %.0f ns per tick (median)\n",
              static_cast<unsigned long long>(servo.figures().ticks), in_contact, peak_n,
              servo.figures().tick_ns.quantile_ns(0.5));
  return servo.figures().ticks > 0 ? 0 : 1;
}
