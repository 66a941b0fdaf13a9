// A stroke over z = 0.05 sin(2 pi x) sin(2 pi y) over 1 m^2 with a texture on it, the hand 4 mm under the untextured
// surface, 0.9 m in 2 s (9 cm in a 10 cm workspace). Lags are found by cross-correlation, to a share of a tick.
#include "figures.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <numbers>
#include <span>
#include <string>
#include <vector>

#include "haptics/proxy/proxy.h"
#include "haptics/surface/monge_surface.h"
#include "lines.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector3d;
using haptics::MongeSurface;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kHeight = 0.05;     // m
constexpr double kTexture = 0.0006;  // m
constexpr double kGrain = 0.03;      // m, wavelength of the texture
constexpr double kDepth = 0.004;     // m
constexpr double kMu = 0.5;
constexpr double kScale = 0.1;  // device metres per grid metre
constexpr double kStiffness = 800.0;
constexpr int kNodes = 800;
constexpr int kTicks = 2000;
constexpr double kTick = 0.001;   // s
constexpr double kSpeed = 0.45;   // m/s across
constexpr double kY = 0.2;        // m: where the stroke goes
constexpr double kSettled = 0.1;  // s: after that the slip is steady

double envelope(double x, double y) { return kHeight * std::sin(kTurn * x) * std::sin(kTurn * y); }
/// Rounded grains that differ in height.
double texture(double x, double y) {
  const double grain = kTurn / kGrain;
  return kTexture * std::sin(grain * x + 2.0 * std::sin(0.37 * grain * y)) * (1.0 + 0.5 * std::sin(0.23 * grain * x));
}

MongeSurface surface_of(bool textured, double mu) {
  MongeSurface surface;
  surface.lattice.nx = surface.lattice.ny = kNodes;
  surface.lattice.spacing_m = 1.0 / (kNodes - 1);
  for (int j = 0; j < kNodes; ++j)
    for (int i = 0; i < kNodes; ++i) {
      const double x = i * surface.lattice.spacing_m;
      const double y = j * surface.lattice.spacing_m;
      surface.height_m.push_back(static_cast<float>(envelope(x, y) + (textured ? texture(x, y) : 0.0)));
    }
  surface.highest_m = kHeight + 2.0 * kTexture;
  if (mu > 0.0) {
    surface.mu_dynamic.assign(surface.lattice.count(), static_cast<float>(mu));
    surface.mu_static.assign(surface.lattice.count(), static_cast<float>(1.2 * mu));
  }
  return surface;
}

/// The hand, under the envelope along its normal.
Vector3d hand_at(double t) {
  const double x = 0.05 + kSpeed * t;
  const Vector3d normal = Vector3d(-kHeight * kTurn * std::cos(kTurn * x) * std::sin(kTurn * kY),
                                   -kHeight * kTurn * std::sin(kTurn * x) * std::cos(kTurn * kY), 1.0)
                              .normalized();
  return Vector3d(x, kY, envelope(x, kY)) - kDepth * normal;
}

struct Stroke {
  std::vector<double> t;
  std::vector<double> z_mm;
  std::vector<double> force_n;
};

Stroke render(const MongeSurface& surface) {
  Stroke stroke;
  haptics::ProxyState state = start_proxy(surface, hand_at(0.0));
  for (int k = 0; k < kTicks; ++k) {
    const Vector3d hand = hand_at(k * kTick);
    const haptics::ProxyUpdate update = update_exact(surface, hand, state, {});
    stroke.t.push_back(k * kTick);
    stroke.z_mm.push_back(1e3 * update.position.z());
    stroke.force_n.push_back(kStiffness * kScale * (update.position - hand).norm());
  }
  return stroke;
}

double correlation(std::span<const double> a, std::span<const double> b) {
  double mean_a = 0.0;
  double mean_b = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) mean_a += a[k], mean_b += b[k];
  mean_a /= static_cast<double>(a.size());
  mean_b /= static_cast<double>(b.size());
  double ab = 0.0;
  double aa = 0.0;
  double bb = 0.0;
  for (std::size_t k = 0; k < a.size(); ++k) {
    ab += (a[k] - mean_a) * (b[k] - mean_b);
    aa += (a[k] - mean_a) * (a[k] - mean_a);
    bb += (b[k] - mean_b) * (b[k] - mean_b);
  }
  return ab / std::sqrt(aa * bb);
}

/// Ticks by which `late` comes after `early`: where their correlation is largest, refined by a parabola.
double lag_ticks(const std::vector<double>& early, const std::vector<double>& late) {
  constexpr int kFarthest = 60;
  constexpr auto kFirst = static_cast<std::size_t>(kSettled / kTick);
  const std::size_t count = early.size() - kFirst - 2 * kFarthest;
  std::array<double, 2 * kFarthest + 1> r{};
  for (int shift = -kFarthest; shift <= kFarthest; ++shift) {
    const std::size_t from = kFirst + kFarthest;
    const auto shifted = static_cast<std::size_t>(static_cast<int>(from) + shift);
    r[static_cast<std::size_t>(shift + kFarthest)] =
        correlation(std::span(early).subspan(from, count), std::span(late).subspan(shifted, count));
  }
  const auto best = static_cast<int>(std::max_element(r.begin(), r.end()) - r.begin());
  if (best == 0 || best == 2 * kFarthest) return best - kFarthest;
  const auto at = [&r](int k) { return r[static_cast<std::size_t>(k)]; };
  const double bend = at(best - 1) - 2.0 * at(best) + at(best + 1);
  return best - kFarthest + 0.5 * (at(best - 1) - at(best + 1)) / bend;
}

}  // namespace

bool write_figures(const std::filesystem::path& out) {
  const std::array<Stroke, 3> strokes = {render(surface_of(false, 0.0)), render(surface_of(true, 0.0)),
                                         render(surface_of(true, kMu))};
  const std::array<const char*, 3> names = {"without effects", "texture", "texture and friction"};
  const std::array<const char*, 3> colours = {"#999999", "#0072B2", "#D55E00"};  // Okabe & Ito
  const std::array<const char*, 3> dashes = {"7 4", "", ""};

  // On a plane friction keeps the proxy mu * depth behind, along the surface.
  double way_m = 0.0;
  for (int k = 1; k < kTicks; ++k) way_m += (hand_at(k * kTick) - hand_at((k - 1) * kTick)).norm();
  const double plane_ms = 1e3 * kMu * kDepth / (way_m / (kTicks * kTick));
  const double z_ms = 1e3 * kTick * lag_ticks(strokes[1].z_mm, strokes[2].z_mm);
  const double force_ms = 1e3 * kTick * lag_ticks(strokes[1].force_n, strokes[2].force_n);
  std::printf("lag by friction: z %.2f ms, force %.2f ms; mu * depth / speed on a plane %.2f ms\n", z_ms, force_ms,
              plane_ms);

  const auto figure = [&](const char* file, const char* title, const char* unit, double lag_ms,
                          std::vector<double> Stroke::*value) {
    std::vector<Panel> panels(2);
    constexpr double kDetailFrom = 0.4;
    constexpr double kDetailTo = 0.65;
    for (Panel& panel : panels) {
      panel.y_label = unit;
      panel.x_to = kTicks * kTick;
      for (std::size_t k = 0; k < strokes.size(); ++k)
        panel.curves.push_back({names[k], colours[k], dashes[k], strokes[k].t, strokes[k].*value});
    }
    panels[0].mark_from = panels[1].x_from = kDetailFrom;
    panels[0].mark_to = panels[1].x_to = kDetailTo;
    char head[120];
    std::snprintf(head, sizeof head, "%s; with friction %.1f ms later", title, lag_ms);
    return write_lines(out / file, head, "time, s (below: the shaded part)", panels);
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
