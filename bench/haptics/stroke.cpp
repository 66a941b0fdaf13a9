#include "bench/haptics/stroke.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "haptics/proxy/proxy.h"

namespace sparsha::bench {
namespace {

using Eigen::Vector3d;

constexpr double kTurn = 2.0 * std::numbers::pi;
constexpr double kHeight_m = 0.05;
constexpr double kTexture_m = 0.0006;
constexpr double kStiffness = 800.0;
constexpr int kTicks = 2000;
constexpr double kSpeed_m_per_s = 0.45;  // across
constexpr double kY_m = 0.2;             // where the stroke goes
constexpr double kAbove_m = 0.01;        // where an approach begins

/// Under the envelope along its normal.
Vector3d hand_at(double t, double depth) {
  const double x = 0.05 + kSpeed_m_per_s * t;
  const Vector3d normal = Vector3d(-kHeight_m * kTurn * std::cos(kTurn * x) * std::sin(kTurn * kY_m),
                                   -kHeight_m * kTurn * std::sin(kTurn * x) * std::cos(kTurn * kY_m), 1.0)
                              .normalized();
  return Vector3d(x, kY_m, stroke_envelope(x, kY_m)) - depth * normal;
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

}  // namespace

double stroke_envelope(double x, double y) { return kHeight_m * std::sin(kTurn * x) * std::sin(kTurn * y); }

double stroke_texture(double x, double y) {
  const double grain = kTurn / kStrokeGrain_m;
  return kTexture_m * std::sin(grain * x + 2.0 * std::sin(0.37 * grain * y)) * (1.0 + 0.5 * std::sin(0.23 * grain * x));
}

std::vector<Vector3d> stroke_hands(bool approach) {
  std::vector<Vector3d> hands;
  const int down = approach ? static_cast<int>(stroke_ticks(kStrokeApproach_s)) : 0;
  for (int k = 0; k < down; ++k)
    hands.push_back(hand_at(0.0, kStrokeDepth_m - (kAbove_m + kStrokeDepth_m) * (down - k) / down));
  for (int k = 0; k < kTicks; ++k) hands.push_back(hand_at(k * kStrokeTick_s, kStrokeDepth_m));
  return hands;
}

double stroke_speed() {
  const std::vector<Vector3d> hands = stroke_hands(false);
  double way_m = 0.0;
  for (std::size_t k = 1; k < hands.size(); ++k) way_m += (hands[k] - hands[k - 1]).norm();
  return way_m / (kTicks * kStrokeTick_s);
}

Stroke render_stroke(const haptics::MongeSurface& surface, const std::vector<Vector3d>& hands) {
  Stroke stroke;
  const Vector3d& origin = surface.lattice.origin_m;
  haptics::ProxyState state = start_proxy(surface, hands.front() - origin);
  for (std::size_t k = 0; k < hands.size(); ++k) {
    const Vector3d hand = hands[k] - origin;
    const haptics::ProxyUpdate update = update_exact(surface, hand, state, {});
    stroke.t.push_back(static_cast<double>(k) * kStrokeTick_s);
    stroke.z_mm.push_back(1e3 * (update.position.z() + origin.z()));
    stroke.force_n.push_back(update.contact ? kStiffness * kStrokeScale * (update.position - hand).norm() : 0.0);
  }
  return stroke;
}

double lag_ticks(const std::vector<double>& early, const std::vector<double>& late, std::size_t first) {
  constexpr int kFarthest = 60;
  const std::size_t count = early.size() - first - 2 * kFarthest;
  std::array<double, 2 * kFarthest + 1> r{};
  for (int shift = -kFarthest; shift <= kFarthest; ++shift) {
    const std::size_t from = first + kFarthest;
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

std::vector<Panel> stroke_panels(const std::vector<Stroke>& strokes, const char* unit,
                                 std::vector<double> Stroke::*value, double detail_from, double detail_to) {
  constexpr std::array<const char*, 4> kNames = {"without effects", "texture", "texture and friction", "friction"};
  constexpr std::array<const char*, 4> kColours = {"#999999", "#0072B2", "#D55E00", "#009E73"};  // Okabe & Ito
  constexpr std::array<const char*, 4> kDashes = {"7 4", "", "", "2 3"};
  std::vector<Panel> panels(2);
  for (Panel& panel : panels) {
    panel.y_label = unit;
    panel.x_to = strokes.front().t.back() + kStrokeTick_s;
    for (std::size_t k = 0; k < strokes.size(); ++k)
      panel.curves.push_back({kNames[k], kColours[k], kDashes[k], strokes[k].t, strokes[k].*value});
  }
  panels[0].mark_from = panels[1].x_from = detail_from;
  panels[0].mark_to = panels[1].x_to = detail_to;
  return panels;
}

}  // namespace sparsha::bench
