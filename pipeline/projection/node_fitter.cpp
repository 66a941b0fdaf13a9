// Windows grow until the decision about the front layer is safe (docs/change/surface.md, "Node fitter").
#include "pipeline/projection/node_fitter.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pipeline/projection/simd/kernels.h"
#include "pipeline/projection/step.h"

namespace sparsha::pipeline {
namespace {

// With nine points of the front in a window, 1.5 of their spacings fit into it, and chance has not hidden a layer.
constexpr std::size_t kSafe = 9;
constexpr std::size_t kLeastFit = 4;
// Mean loss of Tukey's biweight: 0.14 is what Gaussian noise costs.
constexpr double kExplained = 0.3;
// A front of average density has more than two points among so many.
constexpr std::size_t kSureOfOutliers = 24;
// So many points of two interleaved layers part along a line once in four million times.
constexpr std::size_t kSureOfLine = 32;
// What is less likely is not put down to chance: among few points, among many, and where the next layer does not go on
// beneath the front as a back would.
constexpr std::size_t kMany = 48;
constexpr double kChance = 1e-3;
constexpr double kChanceOfMany = 1e-2;
constexpr double kChanceAlone = 1e-1;
// The kernel's radius at four points per node, and its share of that where there are many.
constexpr double kRadius = 1.5;
constexpr double kNarrowest = 0.7;
// Ranks are counted pair by pair up to so many points; more are sorted.
constexpr std::size_t kMostRanked = 1024;
// So many points of a layer may hold one that is not of the surface.
constexpr std::size_t kPerOutlier = 32;

// Points that make a layer of a window's.
std::size_t least_support(std::size_t points) { return std::max<std::size_t>(3, (points + 11) / 12); }

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

// Where the cloud is sparser than the grid, four points lie within two of their spacings but for once in 600 times,
// within one and a half but for once in 12. What is wider is a hole.
double surround_radius(double spacing) { return 1.5 + 2.25 * (spacing - 1.0); }

}  // namespace

double layer_gap_m(double noise_m, double point_spacing_m) { return 6.0 * noise_m + 1.5 * point_spacing_m; }

double kernel_radius(double spacing, std::size_t points, double window_area) {
  const double density = static_cast<double>(points) / window_area * spacing * spacing / 4.0;
  return kRadius * spacing * std::clamp(std::pow(density, density > 1.0 ? -1.0 / 12.0 : -0.25), kNarrowest, 1.4);
}

double least_kernel_radius() { return kRadius * kNarrowest; }

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

bool NodeFitter::misses_thin_front(int i, int j, float above_m) const {
  const BinLattice& lattice = bins_.lattice;
  std::size_t above = 0;
  std::size_t count = 0;
  for (int b = j - 1; b <= j + 1; ++b) {
    const std::size_t begin = bins_.start[lattice.bin(i - 1, b)];
    const std::size_t end = bins_.start[lattice.bin(i + 1, b) + 1];
    for (std::size_t k = begin; k < end; ++k) above += bins_.z[k] > above_m ? 1 : 0;
    count += end - begin;
  }
  return above > 0 && above < least_support(count);
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
  gathered_.clear();
  for (int b = j0; b <= j1; ++b) {
    const std::size_t end = bins_.start[lattice.bin(i1, b) + 1];
    for (std::size_t k = bins_.start[lattice.bin(i0, b)]; k < end; ++k) {
      gathered_.push_back({bins_.z[k], (bins_.x[k] - x) * per_m, (bins_.y[k] - y) * per_m});
    }
  }
}

// Layers in the heights that are left when the slope is taken out; at the node these are the heights themselves.
void NodeFitter::split_layers(Slope slope, double gap_m) {
  const auto slope_u = static_cast<float>(slope.u);
  const auto slope_v = static_cast<float>(slope.v);
  const auto rise = [&](const NodePoint& p) { return p.z - slope_u * p.u - slope_v * p.v; };
  const std::size_t count = gathered_.size();
  rise_.resize(count + LayerKernel::kReadAhead);
  rank_.resize(count);
  for (std::size_t k = 0; k < count; ++k) rise_[k] = rise(gathered_[k]);
  if (count > kMostRanked || !fastest_kernels().rank_descending(rise_.data(), count, rank_.data())) {
    // Equal ones stay in the order of the bins, which is that of coordinates.
    sorted_.clear();
    for (std::uint32_t k = 0; k < count; ++k) sorted_.emplace_back(-rise_[k], k);
    std::sort(sorted_.begin(), sorted_.end());
    for (std::uint32_t k = 0; k < count; ++k) rank_[sorted_[k].second] = k;
  }
  points_.resize(count);
  for (std::size_t k = 0; k < count; ++k) points_[rank_[k]] = gathered_[k];

  layers_.clear();
  const auto gap = static_cast<float>(gap_m);
  const std::size_t least = least_support(points_.size());
  std::size_t begin = 0;
  for (std::size_t k = 1; k <= points_.size(); ++k) {
    if (k < points_.size() && rise(points_[k - 1]) - rise(points_[k]) <= gap) continue;
    if (k - begin >= least) layers_.push_back({begin, k});
    begin = k;
  }
}

// Share of the window's points that lie in thin layers.
double NodeFitter::compactness(Slope slope, double thickness_m) const {
  const auto rise = [&](const NodePoint& p) {
    return static_cast<double>(p.z) - slope.u * static_cast<double>(p.u) - slope.v * static_cast<double>(p.v);
  };
  std::size_t thin = 0;
  for (const Layer& layer : layers_) {
    // The fifth at either end may be outliers or the wall of a step.
    const std::size_t fifth = layer.size() / 5;
    const double thickness = rise(points_[layer.begin + fifth]) - rise(points_[layer.end - 1 - fifth]);
    if (thickness <= thickness_m) thin += layer.size();
  }
  return static_cast<double>(thin) / static_cast<double>(points_.size());
}

// A slope makes one layer look like several, or several like one: tries no slope, that of a first fit to the front, and
// that of the front under a wider gap, and keeps the one under which the layers are thinnest.
void NodeFitter::split_along_best_slope(Slope plain_fit, double total_spacing_m) {
  const double step_m = bins_.lattice.spacing_m;
  const double narrow = 6.0 * rule_.noise_m + 0.75 * total_spacing_m;
  const double thickness = 6.0 * rule_.noise_m + 0.25 * step_m;
  const double plain_gap = layer_gap_m(rule_.noise_m, total_spacing_m);
  const auto bounded = [&](Slope s) {
    const double most = 4.0 * step_m;
    return Slope{std::clamp(s.u, -most, most), std::clamp(s.v, -most, most)};
  };
  // The layers are split without slope when this is called.
  const double plain = layers_.empty() ? 0.0 : compactness({}, thickness);
  if (plain >= 0.9) return;
  split_layers({}, 2.0 * plain_gap);
  Slope wide;
  if (!layers_.empty()) {
    const LocalFit fit = fit_locally(points_of(layers_.front()), {4.0, rule_.noise_m, step_m}, scratch_);
    if (std::isfinite(fit.height_m)) wide = {fit.slope_u_m, fit.slope_v_m};
  }
  const std::array<Slope, 3> candidates{Slope{}, bounded(plain_fit), bounded(wide)};
  std::size_t best = 0;
  double best_compactness = plain;
  for (std::size_t c = 1; c < candidates.size(); ++c) {
    split_layers(candidates[c], narrow);
    const double compact = compactness(candidates[c], thickness);
    if (compact > best_compactness + 1e-9) {
      best = c;
      best_compactness = compact;
    }
  }
  split_layers(candidates[best], best == 0 ? plain_gap : narrow);
}

// Local spacing of a layer's points, in nodes: from the density around the points, not around the node, so that the
// inside of a hole does not pass for a sparse cloud.
double NodeFitter::point_spacing(int i, int j, int reach, const Layer& layer) {
  if (reach == 1) return 1.0;
  const int near = (reach + 1) / 2;
  const int side = 2 * reach + 1;
  const double area = static_cast<double>((2 * near + 1) * (2 * near + 1));
  double sum = 0.0;
  for (const NodePoint& p : points_of(layer)) {
    const int a = std::clamp(static_cast<int>(std::floor(p.u + 0.5F)), -reach, reach);
    const int b = std::clamp(static_cast<int>(std::floor(p.v + 0.5F)), -reach, reach);
    float& spacing = spacing_of_bin_[static_cast<std::size_t>((b + reach) * side + a + reach)];
    if (spacing == 0.0F) {
      const int bin_i = std::clamp(i + a, 0, bins_.lattice.nx - 1);
      const int bin_j = std::clamp(j + b, 0, bins_.lattice.ny - 1);
      const std::size_t count = std::max<std::size_t>(1, count_window(bin_i, bin_j, near));
      spacing = static_cast<float>(std::sqrt(area / static_cast<double>(count)));
    }
    sum += static_cast<double>(spacing);
  }
  const double share = static_cast<double>(points_.size()) / static_cast<double>(layer.size());
  return std::max(1.0, sum / static_cast<double>(layer.size()) * std::sqrt(share));
}

// Distance of a layer's centroid from the node, spacings of the lattice.
double NodeFitter::off_centre(const Layer& layer) const {
  double u = 0.0;
  double v = 0.0;
  for (const NodePoint& p : points_of(layer)) {
    u += static_cast<double>(p.u);
    v += static_cast<double>(p.v);
  }
  return std::hypot(u, v) / static_cast<double>(layer.size());
}

// The points of a layer that lie within noise, and a little form, of a plane through it.
void NodeFitter::keep_near_fit(const Layer& layer, std::vector<NodePoint>& kept) {
  const double step_m = bins_.lattice.spacing_m;
  const LocalFit fit = fit_locally(points_of(layer), {4.0, rule_.noise_m, step_m}, scratch_);
  const double most = 5.0 * rule_.noise_m + 0.1 * step_m;
  kept.clear();
  for (const NodePoint& p : points_of(layer)) {
    const double plane =
        fit.height_m + fit.slope_u_m * static_cast<double>(p.u) + fit.slope_v_m * static_cast<double>(p.v);
    if (!(std::abs(static_cast<double>(p.z) - plane) > most)) kept.push_back(p);
  }
}

// True when the front ends at a line between it and the node, though the next layer goes on beneath it: the back of the
// high side of a step, linked to the low side's front.
bool NodeFitter::ends_before_node() {
  const std::array<NodePoint, 1> node{};
  Separation line = separate(sides_[0], node);
  if (!line.separable && sides_[0].size() >= kPerOutlier) {
    // An outlier may stand at the front's height where the front is not.
    float u = 0.0F;
    float v = 0.0F;
    for (const NodePoint& p : sides_[0]) {
      u += p.u;
      v += p.v;
    }
    const auto outliers = static_cast<std::ptrdiff_t>(sides_[0].size() / kPerOutlier);
    const auto farther = [&](const NodePoint& p, const NodePoint& q) { return u * p.u + v * p.v > u * q.u + v * q.v; };
    std::nth_element(sides_[0].begin(), sides_[0].end() - outliers, sides_[0].end(), farther);
    line = separate({sides_[0].data(), sides_[0].size() - static_cast<std::size_t>(outliers)}, node);
  }
  if (!line.separable) return false;
  const auto along = [&](const NodePoint& p) {
    return line.u * static_cast<double>(p.u) + line.v * static_cast<double>(p.v);
  };
  const auto across = [&](const NodePoint& p) {
    return line.u * static_cast<double>(p.v) - line.v * static_cast<double>(p.u);
  };
  // The next layer's points beneath the front, seen as a box along the line, and the nearest that is not.
  double depth = 0.0;
  double left = std::numeric_limits<double>::infinity();
  double right = -left;
  for (const NodePoint& p : sides_[0]) {
    depth = std::max(depth, along(p));
    left = std::min(left, across(p));
    right = std::max(right, across(p));
  }
  std::size_t beneath = 0;
  double nearest = -std::numeric_limits<double>::infinity();
  for (const NodePoint& p : sides_[1]) {
    const double at = along(p);
    if (at < line.margin) nearest = std::max(nearest, at);
  }
  for (const NodePoint& p : points_of(layers_[1])) {
    const double at = along(p);
    beneath += at >= line.margin && at <= depth && across(p) >= left && across(p) <= right ? 1 : 0;
  }
  // Were the front about the node too, chance would have kept all of its points beyond the line.
  std::size_t beyond = 0;
  for (const NodePoint& p : points_) beyond += along(p) >= line.margin ? 1 : 0;
  const auto front = static_cast<double>(sides_[0].size());
  const double share = static_cast<double>(beyond) / static_cast<double>(points_.size());
  const double most = points_.size() > kSureOfLine && 8 * beneath <= sides_[0].size() ? kChanceAlone
                      : points_.size() > kMany                                        ? kChanceOfMany
                                                                                      : kChance;
  // The edge is midway to the nearest point of the next layer that is not beneath the front.
  return front * std::pow(share, front - 1.0) <= most && nearest > -line.margin;
}

// The front, unless it lies to one side and a line parts it from the next layer on the node's side: then it is a step.
const NodeFitter::Layer& NodeFitter::layer_at_node(double spacing) {
  const Layer& front = layers_.front();
  if (layers_.size() == 1 || off_centre(front) <= 0.5 * spacing) return front;
  const Layer& next = layers_[1];
  // Outliers that the gap has linked to a layer must not stand across its edge.
  for (std::size_t side = 0; side < 2; ++side) keep_near_fit(layers_[side], sides_[side]);
  if (sides_[0].empty() || sides_[1].empty()) return front;
  Separation line = separate(sides_[0], sides_[1]);
  const std::size_t points = sides_[0].size() + sides_[1].size();
  if (!line.separable && ends_before_node()) return next;
  if (!line.separable && points > kSureOfLine) {
    // A curved edge, or an outlier still: the nearest points see it straight. Fewer would part by chance.
    const auto r2 = [](const NodePoint& p) { return p.u * p.u + p.v * p.v; };
    const double share = static_cast<double>(sides_[0].size()) / static_cast<double>(points);
    std::vector<float>& distances = scratch_;
    distances.clear();
    for (const std::vector<NodePoint>& side : sides_) {
      for (const NodePoint& p : side) distances.push_back(r2(p));
    }
    std::nth_element(distances.begin(), distances.begin() + kSureOfLine - 1, distances.end());
    const float limit = distances[kSureOfLine - 1];
    for (std::vector<NodePoint>& side : sides_) std::erase_if(side, [&](const NodePoint& p) { return r2(p) > limit; });
    if (sides_[0].empty()) {
      // Were the front in front here too, chance would have to have kept all of its points away.
      return std::pow(1.0 - share, static_cast<double>(sides_[1].size())) < 1e-5 ? next : front;
    }
    if (sides_[1].empty()) return front;
    line = separate(sides_[0], sides_[1]);
  }
  return line.separable && line.node_side < 0.0 ? next : front;
}

NodeFit NodeFitter::fit(int i, int j, int least_reach) {
  const double step_m = bins_.lattice.spacing_m;
  for (int reach = least_reach; reach <= rule_.widest_window; ++reach) {
    const std::size_t count = count_window(i, j, reach);
    const bool last = reach == rule_.widest_window;
    if (count < kLeastFit || (count < kSafe && !last)) continue;
    gather(i, j, reach);
    spacing_of_bin_.assign(static_cast<std::size_t>((2 * reach + 1) * (2 * reach + 1)), 0.0F);
    const double side = 2.0 * reach + 1.0;
    const double total_spacing_m = std::sqrt(side * side / static_cast<double>(count)) * step_m;
    split_layers({}, layer_gap_m(rule_.noise_m, total_spacing_m));
    if (layers_.empty()) continue;
    // One or two points above the front may be a front that chance has thinned.
    if (!last && reach < 3 && layers_.front().begin > 0 && count < kSureOfOutliers) continue;

    double spacing = point_spacing(i, j, reach, layers_.front());
    double radius = kernel_radius(spacing, layers_.front().size(), side * side);
    LocalFit fit = fit_locally(points_of(layers_.front()), {radius, rule_.noise_m, step_m}, scratch_);
    // A fit that explains its layer needs no other slope; one that may stand at a step needs the step's.
    const bool simple =
        fit.loss <= kExplained && layers_.front().size() * 2 > count && off_centre(layers_.front()) <= 0.5 * spacing;
    const Layer* layer = &layers_.front();
    if (!simple) {
      split_along_best_slope({fit.slope_u_m, fit.slope_v_m}, total_spacing_m);
      if (layers_.empty()) continue;
      spacing = point_spacing(i, j, reach, layers_.front());
      layer = &layer_at_node(spacing);
      radius = kernel_radius(spacing, layer->size(), side * side);
      fit = fit_locally(points_of(*layer), {radius, rule_.noise_m, step_m}, scratch_);
    }
    const bool whole = surrounds(points_of(*layer), surround_radius(spacing), 0.5 * spacing);
    // A line between few points may be chance: the back, taken for the low side of a step.
    const bool chance = layer != &layers_.front() && sides_[0].size() + sides_[1].size() < kSureOfLine;
    if (!last && reach < 3 && chance) continue;
    if (!last && 1.5 * spacing > reach + 0.5 && (!whole || layers_.front().size() < kSafe)) continue;
    if (!last && reach < 3 && layers_.front().size() < kSafe && layers_.size() > 1) continue;
    if (!whole || !std::isfinite(fit.height_m) || fit.support < kLeastFit) return {};
    return {true, fit.height_m, fit.slope_u_m / step_m, fit.slope_v_m / step_m};
  }
  return {};
}

}  // namespace sparsha::pipeline
