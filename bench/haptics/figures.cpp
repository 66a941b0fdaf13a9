// The stroke of stroke.h over the analytic surface at its nodes, with a friction of one value: what scanning adds is
// left to scanned.cpp.
#include "bench/haptics/figures.h"

#include <cstdio>
#include <fstream>
#include <vector>

#include "bench/haptics/stroke.h"

namespace sparsha::bench {
namespace {

using haptics::MongeSurface;

constexpr double kMu = 0.5;
constexpr int kNodes = 800;

MongeSurface surface_of(bool textured, double mu) {
  MongeSurface surface;
  surface.lattice.nx = surface.lattice.ny = kNodes;
  surface.lattice.spacing_m = 1.0 / (kNodes - 1);
  for (int j = 0; j < kNodes; ++j)
    for (int i = 0; i < kNodes; ++i) {
      const double x = i * surface.lattice.spacing_m;
      const double y = j * surface.lattice.spacing_m;
      surface.height_m.push_back(static_cast<float>(stroke_envelope(x, y) + (textured ? stroke_texture(x, y) : 0.0)));
    }
  if (mu > 0.0) {
    surface.mu_dynamic.assign(surface.lattice.count(), static_cast<float>(mu));
    surface.mu_static.assign(surface.lattice.count(), static_cast<float>(1.2 * mu));
  }
  return surface;
}

}  // namespace

bool write_figures(const std::filesystem::path& out) {
  const std::vector<Eigen::Vector3d> hands = stroke_hands(false);
  const std::vector<Stroke> strokes = {render_stroke(surface_of(false, 0.0), hands),
                                       render_stroke(surface_of(true, 0.0), hands),
                                       render_stroke(surface_of(true, kMu), hands)};
  // On a plane friction keeps the proxy mu * depth behind, along the surface.
  const double plane_ms = 1e3 * kMu * kStrokeDepth_m / stroke_speed();
  constexpr std::size_t kFirst = stroke_ticks(kStrokeSettled_s);
  const double z_ms = 1e3 * kStrokeTick_s * lag_ticks(strokes[1].z_mm, strokes[2].z_mm, kFirst);
  const double force_ms = 1e3 * kStrokeTick_s * lag_ticks(strokes[1].force_n, strokes[2].force_n, kFirst);
  std::printf("lag by friction: z %.2f ms, force %.2f ms; mu * depth / speed on a plane %.2f ms\n", z_ms, force_ms,
              plane_ms);
  const auto figure = [&](const char* file, const char* title, const char* unit, double lag_ms,
                          std::vector<double> Stroke::*value) {
    char head[120];
    std::snprintf(head, sizeof head, "%s; with friction %.1f ms later", title, lag_ms);
    return write_lines(out / file, head, "time, s (below: the shaded part)",
                       stroke_panels(strokes, unit, value, 0.4, 0.65));
  };
  std::ofstream csv(out / "haptics_figures.csv");
  csv << "t_s,z_without_mm,z_texture_mm,z_texture_friction_mm,force_without_n,force_texture_n,force_texture_friction_"
         "n\n";
  for (std::size_t k = 0; k < strokes[0].t.size(); ++k) {
    csv << strokes[0].t[k];
    for (const Stroke& stroke : strokes) csv << ',' << stroke.z_mm[k];
    for (const Stroke& stroke : strokes) csv << ',' << stroke.force_n[k];
    csv << '\n';
  }
  csv << std::flush;
  return static_cast<bool>(csv) &&
         figure("haptics_z.svg", "Height of the proxy on a sinusoid", "z, mm", z_ms, &Stroke::z_mm) &&
         figure("haptics_force.svg", "Force on a sinusoid, 4 mm deep", "force, N", force_ms, &Stroke::force_n);
}

}  // namespace sparsha::bench
