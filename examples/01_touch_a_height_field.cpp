// A surface from plain heights, a hand that presses on it, and the force that it feels.
#include <cmath>
#include <cstdio>
#include <vector>

#include <sparsha/proxy.h>
#include <sparsha/surface.h>

int main() {
  using namespace sparsha;

  // Gentle waves on 101 x 101 nodes, 1 mm apart; heights in metres.
  haptics::SurfaceParts parts;
  parts.lattice.nx = parts.lattice.ny = 101;
  parts.lattice.spacing_m = 0.001;
  for (int j = 0; j < parts.lattice.ny; ++j)
    for (int i = 0; i < parts.lattice.nx; ++i) {
      const double x_m = parts.lattice.x_m(i);
      const double y_m = parts.lattice.y_m(j);
      parts.height_m.push_back(static_cast<float>(0.002 * std::sin(60.0 * x_m) * std::cos(50.0 * y_m)));
    }
  const auto surface = haptics::make_surface(std::move(parts));

  // The hand comes down in the middle, to 5 mm below the surface, a tenth of a millimetre per tick.
  constexpr double kStiffness_n_per_m = 800.0;
  const double x_m = 0.5 * surface->width_m();
  const double y_m = 0.5 * surface->depth_m();
  const double surface_m = surface->height(x_m, y_m);
  Eigen::Vector3d hand_m(x_m, y_m, surface_m + 0.005);
  haptics::ProxyState proxy = haptics::start_proxy(*surface, hand_m);
  haptics::ProxyUpdate found;
  Eigen::Vector3d force_n = Eigen::Vector3d::Zero();
  std::printf("hand above surface [mm]  force [N]\n");
  for (int tick = 0; tick <= 100; ++tick) {
    hand_m.z() = surface_m + 0.005 - 0.0001 * tick;
    found = haptics::update_exact(*surface, hand_m, proxy, {});
    if (found.contact) force_n = kStiffness_n_per_m * (found.position - hand_m);
    if (tick % 10 == 0) std::printf("%23.1f  %9.3f\n", 1e3 * (hand_m.z() - surface_m), force_n.norm());
  }
  std::printf("normal at the end (%.3f, %.3f, %.3f)\n", found.normal.x(), found.normal.y(), found.normal.z());
  return found.contact && force_n.z() > 0.0 ? 0 : 1;
}
