// Gaps inside the closing of the measured nodes get the height of a distance-weighted plane through the measured nodes
// around them; where those lie on two sides of a step, the lower side wins, since it is the one that a scanner's shadow
// hides.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>

#include "pipeline/layers/closing.h"
#include "pipeline/layers/layers.h"

namespace sparsha::pipeline {
namespace {

constexpr int kRays = 16;              // directions in which a gap's border is looked for
constexpr int kRimWidth = 3;           // measured nodes this near to a gap (in spacings) support its planes
constexpr int kTangentReach = 2;       // spacings about a border node that its tangent plane is fitted to
constexpr std::size_t kLeastHits = 2;  // of the border, to make a side of a step
constexpr double kMinSpread = 0.15;    // spacings^2; a narrower support says nothing of the slope across it
constexpr std::size_t kRowsPerPiece = 8;

/// A measured node seen from the gap node: offset in spacings, height relative to z0.
struct Support {
  double dx, dy, z, weight;
};

/// z = height + slope_x dx + slope_y dy; dx = dy = 0 is the gap node.
struct Plane {
  double height = 0, slope_x = 0, slope_y = 0;
  [[nodiscard]] double at(double dx, double dy) const { return height + slope_x * dx + slope_y * dy; }
};

/// Weighted least squares about the centroid. Along directions in which the support is narrower than kMinSpread the
/// slope is drawn towards 0, so that a one-sided or collinear rim is continued level and not by its noise.
Plane fit_plane(const std::vector<Support>& support) {
  double w = 0, x = 0, y = 0, z = 0;
  for (const Support& s : support) {
    w += s.weight;
    x += s.weight * s.dx;
    y += s.weight * s.dy;
    z += s.weight * s.z;
  }
  x /= w;
  y /= w;
  z /= w;
  double xx = 0, xy = 0, yy = 0, xz = 0, yz = 0;
  for (const Support& s : support) {
    const double dx = s.dx - x, dy = s.dy - y, dz = s.z - z, weight = s.weight / w;
    xx += weight * dx * dx;
    xy += weight * dx * dy;
    yy += weight * dy * dy;
    xz += weight * dx * dz;
    yz += weight * dy * dz;
  }
  const double half_trace = (xx + yy) / 2;
  const double smallest = half_trace - std::sqrt((xx - yy) * (xx - yy) / 4 + xy * xy);
  const double ridge = std::max(0.0, kMinSpread - smallest);
  xx += ridge;
  yy += ridge;
  const double determinant = xx * yy - xy * xy;
  Plane plane;
  plane.slope_x = (yy * xz - xy * yz) / determinant;
  plane.slope_y = (xx * yz - xy * xz) / determinant;
  plane.height = z - plane.slope_x * x - plane.slope_y * y;
  return plane;
}

/// What a node of the gap's border says: its offset, its height, and the height and slope of its own tangent plane at
/// the gap node.
struct Hit {
  int dx, dy;
  double z;
  Plane tangent;
};

/// Heights within `tolerance` of a plane; everything when there is no step.
struct Side {
  Plane plane;
  double tolerance = std::numeric_limits<double>::infinity();
  [[nodiscard]] bool holds(double dx, double dy, double z) const { return std::abs(z - plane.at(dx, dy)) <= tolerance; }
};

/// Weights 1/distance^2, less the farther and 0 from `reach` + 1 spacings on, by the offset in rows and columns. Gaps
/// of many nodes ask for each of them many times.
class FadingWeights {
 public:
  explicit FadingWeights(int reach) : reach_(reach), fade_(1.0 / ((reach + 1.0) * (reach + 1.0))) {
    const auto side = static_cast<std::size_t>(reach) + 1;
    if (side > kMostKept) return;
    kept_.resize(side * side);
    for (int dy = 0; dy <= reach; ++dy)
      for (int dx = 0; dx <= reach; ++dx)
        kept_[static_cast<std::size_t>(dy) * side + static_cast<std::size_t>(dx)] = weight(dx, dy);
  }

  /// Of nodes `dy` >= 0 rows away.
  class Row {
   public:
    Row(const FadingWeights& all, int dy)
        : all_(all), dy_(dy), reach_(static_cast<int>(std::sqrt(std::max(0.0, 1 / all.fade_ - 1.0 * dy * dy))) + 2) {
      while (reach_ >= 0 && !(all.taper(reach_, dy) > 0)) --reach_;
      reach_ = std::min(reach_, all.reach_);
      if (!all.kept_.empty())
        kept_ = all.kept_.data() + static_cast<std::size_t>(dy) * (static_cast<std::size_t>(all.reach_) + 1);
    }
    /// The last column with a weight.
    [[nodiscard]] int reach() const { return reach_; }
    /// `dx` columns away, 0 to reach().
    [[nodiscard]] double at(int dx) const { return kept_ != nullptr ? kept_[dx] : all_.weight(dx, dy_); }

   private:
    const FadingWeights& all_;
    const double* kept_ = nullptr;
    int dy_, reach_;
  };
  [[nodiscard]] Row row(int dy) const { return {*this, dy}; }

 private:
  static constexpr std::size_t kMostKept = 700;  // nodes a side

  [[nodiscard]] static double squared(double dx, double dy) { return dx * dx + dy * dy; }
  [[nodiscard]] double taper(double dx, double dy) const { return 1 - squared(dx, dy) * fade_; }
  [[nodiscard]] double weight(double dx, double dy) const {
    const double fading = taper(dx, dy);
    return fading * fading / squared(dx, dy);
  }

  int reach_;
  double fade_;
  std::vector<double> kept_;
};

class Filler {
 public:
  Filler(const scene::DepthGrid& grid, double radius, double step_m)
      : grid_(grid), step_m_(step_m), reach_(static_cast<int>(2 * radius) + kRimWidth), weights_(reach_), rim_(0, 0) {
    const int longest = std::min(reach_, grid.lattice.nx + grid.lattice.ny);  // farther on a ray is outside
    for (int k = 0; k < kRays; ++k) {
      const double angle = 2 * std::numbers::pi * k / kRays;
      const double cosine = std::cos(angle), sine = std::sin(angle);
      std::vector<Step>& ray = rays_[static_cast<std::size_t>(k)];
      for (int t = 1; t <= longest; ++t)
        ray.push_back({static_cast<int>(std::lround(t * cosine)), static_cast<int>(std::lround(t * sine))});
    }
  }

  void set_rim(NodeSet rim) { rim_ = std::move(rim); }

  struct Scratch {
    std::vector<Hit> hits;
    std::vector<Support> support;
  };

  /// Height of gap node (i, j), or NaN when nothing supports one.
  [[nodiscard]] double height(int i, int j, Scratch& scratch) const {
    border(i, j, scratch.hits);
    const Side side = lower_side(i, j, scratch);
    gather(i, j, side, scratch.support);
    if (scratch.support.empty()) return std::numeric_limits<double>::quiet_NaN();
    return fit_plane(scratch.support).height;
  }

 private:
  struct Step {
    int di, dj;
  };

  [[nodiscard]] bool inside(int i, int j) const {
    return i >= 0 && j >= 0 && i < grid_.lattice.nx && j < grid_.lattice.ny;
  }

  /// First measured node along each ray: the border of the gap as this node sees it.
  void border(int i, int j, std::vector<Hit>& hits) const {
    hits.clear();
    for (const std::vector<Step>& ray : rays_) {
      for (const auto& [di, dj] : ray) {
        if (!inside(i + di, j + dj)) break;
        const std::size_t n = grid_.lattice.index(i + di, j + dj);
        if (grid_.state[n] != scene::NodeState::measured) continue;
        hits.push_back({di, dj, grid_.height_m[n], {}});
        break;
      }
    }
  }

  /// Tangent plane of the measured surface at a hit, carried on to the gap node.
  [[nodiscard]] Plane tangent(int i, int j, const Hit& hit, std::vector<Support>& support) const {
    support.clear();
    for (int dy = -kTangentReach; dy <= kTangentReach; ++dy)
      for (int dx = -kTangentReach; dx <= kTangentReach; ++dx) {
        const int x = i + hit.dx + dx, y = j + hit.dy + dy;
        if (!inside(x, y)) continue;
        const std::size_t n = grid_.lattice.index(x, y);
        if (grid_.state[n] != scene::NodeState::measured) continue;
        const double z = grid_.height_m[n], far = std::max(1.0, std::hypot(dx, dy));
        if (std::abs(z - hit.z) > step_m_ * far) continue;  // beyond a step of the measured surface itself
        support.push_back({static_cast<double>(hit.dx + dx), static_cast<double>(hit.dy + dy), z, 1});
      }
    return fit_plane(support);
  }

  /// The lower side of a step through the border, or everything when there is none. Two sides of a slope may lie as far
  /// apart as those of a step, so their tangent planes are compared, at the gap node.
  [[nodiscard]] Side lower_side(int i, int j, Scratch& scratch) const {
    std::vector<Hit>& hits = scratch.hits;
    if (!(step_m_ > 0) || hits.size() < 2 * kLeastHits) return {};
    const auto [low, high] =
        std::minmax_element(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) { return a.z < b.z; });
    if (high->z - low->z <= step_m_) return {};
    for (Hit& hit : hits) hit.tangent = tangent(i, j, hit, scratch.support);
    std::sort(hits.begin(), hits.end(), [](const Hit& a, const Hit& b) { return a.tangent.height < b.tangent.height; });
    for (std::size_t k = kLeastHits; k < hits.size(); ++k) {
      const double gap = hits[k].tangent.height - hits[k - 1].tangent.height;
      if (gap <= step_m_) continue;
      Side side;
      for (std::size_t n = 0; n < k; ++n) {
        side.plane.height += hits[n].tangent.height / static_cast<double>(k);
        side.plane.slope_x += hits[n].tangent.slope_x / static_cast<double>(k);
        side.plane.slope_y += hits[n].tangent.slope_y / static_cast<double>(k);
      }
      side.tolerance = gap / 2;
      return side;
    }
    return {};
  }

  /// Measured nodes of the rim within reach whose heights belong to `side`, weighted by 1/distance^2 and fading to 0.
  void gather(int i, int j, const Side& side, std::vector<Support>& support) const {
    support.clear();
    const bool all = std::isinf(side.tolerance);
    const int j0 = std::max(0, j - reach_), j1 = std::min(grid_.lattice.ny - 1, j + reach_);
    for (int y = j0; y <= j1; ++y) {
      const FadingWeights::Row weights = weights_.row(std::abs(y - j));
      const int i0 = std::max(0, i - weights.reach()), i1 = std::min(grid_.lattice.nx - 1, i + weights.reach());
      const float* const heights = grid_.height_m.data() + grid_.lattice.index(0, y);
      const double dy = y - j;
      rim_.for_each_in_row(y, i0, i1 + 1, [&](int x) {
        const double dx = x - i, z = heights[x];
        if (all || side.holds(dx, dy, z)) support.push_back({dx, dy, z, weights.at(std::abs(x - i))});
      });
    }
  }

  const scene::DepthGrid& grid_;
  double step_m_;
  int reach_;
  FadingWeights weights_;
  NodeSet rim_;
  std::array<std::vector<Step>, kRays> rays_;  // of each the nodes from the gap node outwards
};

NodeSet intersection(const NodeSet& a, const NodeSet& b) {
  NodeSet result = a;
  for (int j = 0; j < a.ny(); ++j)
    for (std::size_t k = 0; k < a.words_per_row(); ++k) result.row(j)[k] &= b.row(j)[k];
  return result;
}

}  // namespace

void fill_gaps(scene::DepthGrid& grid, const scene::FillConfig& config, double step_m, ThreadPool& pool) {
  const double diameter =
      std::min(config.max_gap_m / grid.lattice.spacing_m, 2.0 * (grid.lattice.nx + grid.lattice.ny));
  const NodeSet measured = nodes_of(grid, scene::NodeState::measured);
  // A small disc closes what a larger one may not (its own pixels differ), hence the explicit intersection.
  const NodeSet closed = close_by_disc(measured, diameter, pool);
  const bool closes_outline = diameter == outline_diameter(grid.lattice, config.max_gap_m);
  const NodeSet outline = closes_outline ? fill_holes(closed) : outline_nodes(grid, config.max_gap_m, pool);
  const NodeSet gaps = intersection(intersection(closed, outline), nodes_of(grid, scene::NodeState::unknown));
  if (gaps.count() == 0) return;

  Filler filler(grid, diameter / 2, step_m);
  filler.set_rim(intersection(dilate_by_disc(gaps, kRimWidth, pool), measured));
  // Heights of measured nodes decide, so that those of the gaps may be written beside them.
  pool.for_ranges(static_cast<std::size_t>(grid.lattice.ny), kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
    Filler::Scratch scratch;
    for (int j = static_cast<int>(begin); j < static_cast<int>(end); ++j)
      gaps.for_each_in_row(j, 0, grid.lattice.nx, [&](int i) {
        grid.height_m[grid.lattice.index(i, j)] = static_cast<float>(filler.height(i, j, scratch));
      });
  });
  for (int j = 0; j < grid.lattice.ny; ++j)
    gaps.for_each_in_row(j, 0, grid.lattice.nx, [&](int i) {
      const std::size_t n = grid.lattice.index(i, j);
      if (!std::isnan(grid.height_m[n])) grid.state[n] = scene::NodeState::filled;
    });
}

}  // namespace sparsha::pipeline
