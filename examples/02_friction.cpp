// A friction map: the left half of a plate is polished, the right half is rough. The same stroke over both.
#include <cstdio>
#include <vector>

#include <sparsha/proxy.h>
#include <sparsha/surface.h>

int main() {
  using namespace sparsha;

  haptics::SurfaceParts parts;
  parts.lattice.nx = parts.lattice.ny = 101;
  parts.lattice.spacing_m = 0.001;
  parts.height_m.assign(parts.lattice.count(), 0.0F);
  for (int j = 0; j < parts.lattice.ny; ++j)
    for (int i = 0; i < parts.lattice.nx; ++i) {
      const bool polished = i < parts.lattice.nx / 2;
      parts.friction.mu_dynamic.push_back(polished ? 0.05F : 0.5F);
      parts.friction.mu_static.push_back(polished ? 0.08F : 0.7F);
    }
  const auto surface = haptics::make_surface(std::move(parts));

  // 2 mm deep, from left to right at 50 mm/s and 1 kHz.
  constexpr double kStiffness_n_per_m = 800.0;
  constexpr double kDepth_m = 0.002;
  haptics::ProxyState proxy = haptics::start_proxy(*surface, {0.01, 0.05, 0.001});
  double drag_n[2] = {0.0, 0.0};  // on the polished and on the rough half
  for (double x_m = 0.01; x_m < 0.09; x_m += 50e-6) {
    const Eigen::Vector3d hand_m(x_m, 0.05, -kDepth_m);
    const haptics::ProxyUpdate found = haptics::update_exact(*surface, hand_m, proxy, {});
    const Eigen::Vector3d force_n = kStiffness_n_per_m * (found.position - hand_m);
    if (x_m > 0.03 && x_m < 0.045) drag_n[0] = -force_n.x();
    if (x_m > 0.075) drag_n[1] = -force_n.x();
  }
  const double press_n = kStiffness_n_per_m * kDepth_m;
  std::printf("pressing with %.2f N: drag %.3f N on the polished half (mu %.2f), %.3f N on the rough one (mu %.2f)\n",
              press_n, drag_n[0], drag_n[0] / press_n, drag_n[1], drag_n[1] / press_n);
  return drag_n[0] > 0.0 && drag_n[1] > 5.0 * drag_n[0] ? 0 : 1;
}
