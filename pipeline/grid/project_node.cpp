// Windows grow until the decision about the front layer is safe; docs/architecture.md tells why each rule is there.
#include "pipeline/grid/project_node.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "pipeline/grid/project_step.h"

namespace sparsha::pipeline {
namespace {

// With nine points of the front in a window, 1.5 of their spacings fit into it, and chance has not hidden a layer.
constexpr std::size_t kSafe = 9;
constexpr std::size_t kLeastFit = 4;

bool higher(const NodePoint& a, const NodePoint& b) {
  if (a.z != b.z) return a.z > b.z;
  if (a.u != b.u) return a.u < b.u;
  return a.v < b.v;
}

// True when the node is inside the hull of the points within `radius`, but for `tolerance`, seen in eight directions.
bool surrounds(std::span<const NodePoint> points, double radius, double tolerance) {
  std::array<float, 4> low{1e9F, 1e9F, 1e9F, 1e9F};
  std::array<float, 4> high{-1e9F, -1e9F, -1e9F, -1e9F};
  const auto r2 = static_cast<float>(radius * radius);
  std::size_t near = 0;
  for (const NodePoint& p : points) {
    if (p.u * p.u + p.v * p.v > r2) continue;
    ++near;
    constexpr float kHalfRoot = 0.70710678F;
    const std::array<float, 4> along{p.u, p.v, (p.u + p.v) * kHalfRoot, (p.u - p.v) * kHalfRoot};
    for (std::size_t d = 0; d < 4; ++d) {
      low[d] = std::min(low[d], along[d]);
      high[d] = std::max(high[d], along[d]);
    }
  }
  if (near < kLeastFit) return false;
  const auto t = static_cast<float>(tolerance);
  for (std::size_t d = 0; d < 4; ++d) {
    if (low[d] > t || high[d] < -t) return false;
  }
  return true;
}

// 1.5 spacings, less where there are points to spare.
double kernel_radius(double spacing, std::size_t points, double window_area) {
  const double density = static_cast<double>(points) / window_area;
  const double spare = density * spacing * spacing / 4.0;
  return 1.5 * spacing * (spare > 1.0 ? std::max(0.7, std::pow(spare, -1.0 / 6.0)) : 1.0);
}

}  // namespace

double layer_gap_m(double noise_m, double point_spacing_m) { return 6.0 * noise_m + 1.5 * point_spacing_m; }

std::size_t NodeFitter::count_window(int i, int j, int reach) const {
  const BinLattice& lattice = bins_.lattice;
  const int i0 = std::max(i - reach, -BinLattice::kMargin);
  const int i1 = std::min(i + reach, lattice.nx - 1 + BinLattice::kMargin);
  const int j0 = std::max(j - reach, -BinLattice::kMargin);
  const int j1 = std::min(j + reach, lattice.ny - 1 + BinLattice::kMargin);
  std::size_t count = 0;
  for (int b = j0; b <= j1; ++b) count += bins_.start[lattice.bin(i1, b) + 1] - bins_.start[lattice.bin(i0, b)];
  return count;
}

void NodeFitter::gather(int i, int j, int reach) {
  const BinLattice& lattice = bins_.lattice;
  const int i0 = std::max(i - reach, -BinLattice::kMargin);
  const int i1 = std::min(i + reach, lattice.nx - 1 + BinLattice::kMargin);
  const int j0 = std::max(j - reach, -BinLattice::kMargin);
  const int j1 = std::min(j + reach, lattice.ny - 1 + BinLattice::kMargin);
  const auto x = static_cast<float>(lattice.x0_m + i * lattice.spacing_m);
  const auto y = static_cast<float>(lattice.y0_m + j * lattice.spacing_m);
  const auto per_m = static_cast<float>(1.0 / lattice.spacing_m);
  points_.clear();
  for (int b = j0; b <= j1; ++b) {
    const std::size_t end = bins_.start[lattice.bin(i1, b) + 1];
    for (std::size_t k = bins_.start[lattice.bin(i0, b)]; k < end; ++k) {
      points_.push_back({bins_.z[k], (bins_.x[k] - x) * per_m, (bins_.y[k] - y) * per_m});
    }
  }
  std::sort(points_.begin(), points_.end(), higher);
}

void NodeFitter::split_layers(double gap_m, std::size_t least) {
  layers_.clear();
  const auto gap = static_cast<float>(gap_m);
  std::size_t begin = 0;
  for (std::size_t k = 1; k <= points_.size(); ++k) {
    if (k < points_.size() && points_[k - 1].z - points_[k].z <= gap) continue;
    if (k - begin >= least) layers_.push_back({begin, k});
    begin = k;
  }
}

// Local spacing of a layer's points, in nodes: from the density around the points, not around the node, so that the
// inside of a hole does not pass for a sparse cloud.
double NodeFitter::point_spacing(int i, int j, int reach, const Layer& layer) const {
  if (reach == 1) return 1.0;
  const int near = (reach + 1) / 2;
  const double area = static_cast<double>((2 * near + 1) * (2 * near + 1));
  double sum = 0.0;
  for (const NodePoint& p : points_of(layer)) {
    const int a = std::clamp(i + static_cast<int>(std::lround(p.u)), 0, bins_.lattice.nx - 1);
    const int b = std::clamp(j + static_cast<int>(std::lround(p.v)), 0, bins_.lattice.ny - 1);
    sum += std::sqrt(area / static_cast<double>(std::max<std::size_t>(1, count_window(a, b, near))));
  }
  const double share = static_cast<double>(points_.size()) / static_cast<double>(layer.size());
  return std::max(1.0, sum / static_cast<double>(layer.size()) * std::sqrt(share));
}

// The front, unless it lies to one side and a line parts it from the next layer on the node's side: then it is a step.
const NodeFitter::Layer* NodeFitter::layer_at_node(double spacing) const {
  const Layer& front = layers_.front();
  if (layers_.size() == 1) return &front;
  double u = 0.0;
  double v = 0.0;
  for (const NodePoint& p : points_of(front)) {
    u += static_cast<double>(p.u);
    v += static_cast<double>(p.v);
  }
  const auto count = static_cast<double>(front.size());
  if (std::hypot(u, v) / count <= 0.5 * spacing) return &front;
  const Separation line = separate(points_of(front), points_of(layers_[1]));
  return line.separable && line.node_side < 0.0 ? &layers_[1] : &front;
}

NodeFit NodeFitter::fit(int i, int j) {
  const double step_m = bins_.lattice.spacing_m;
  for (int reach = 1; reach <= rule_.widest_window; ++reach) {
    const std::size_t count = count_window(i, j, reach);
    const bool last = reach == rule_.widest_window;
    if (count < kLeastFit || (count < kSafe && !last)) continue;
    gather(i, j, reach);
    const double side = 2.0 * reach + 1.0;
    const double total_spacing = std::sqrt(side * side / static_cast<double>(count));
    split_layers(layer_gap_m(rule_.noise_m, total_spacing * step_m), std::max<std::size_t>(3, (count + 11) / 12));
    if (layers_.empty()) continue;
    const double spacing = point_spacing(i, j, reach, layers_.front());
    const Layer& layer = *layer_at_node(spacing);
    const double radius = kernel_radius(spacing, layer.size(), side * side);
    const bool whole = surrounds(points_of(layer), 1.5 * spacing, 0.5 * spacing);
    if (!last && 1.5 * spacing > reach + 0.5 && (!whole || layers_.front().size() < kSafe)) continue;
    if (!last && reach < 3 && layers_.front().size() < kSafe && layers_.size() > 1) continue;
    if (!whole) return {};
    const LocalFit fit = fit_locally(points_of(layer), {radius, rule_.noise_m, step_m}, scratch_);
    if (!std::isfinite(fit.height_m) || fit.support < kLeastFit) return {};
    return {true, fit.height_m, fit.slope_u_m / step_m, fit.slope_v_m / step_m};
  }
  return {};
}

}  // namespace sparsha::pipeline
