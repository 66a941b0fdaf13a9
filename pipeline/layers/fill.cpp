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

class Filler {
 public:
  Filler(const scene::DepthGrid& grid, double radius, double step_m)
      : grid_(grid), step_m_(step_m), reach_(static_cast<int>(2 * radius) + kRimWidth), rim_(0, 0) {
    for (int k = 0; k < kRays; ++k) {
      const double angle = 2 * std::numbers::pi * k / kRays;
      directions_[static_cast<std::size_t>(k)] = {std::cos(angle), std::sin(angle)};
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
  [[nodiscard]] bool inside(int i, int j) const {
    return i >= 0 && j >= 0 && i < grid_.lattice.nx && j < grid_.lattice.ny;
  }

  /// First measured node along each ray: the border of the gap as this node sees it.
  void border(int i, int j, std::vector<Hit>& hits) const {
    hits.clear();
    for (const auto& [cosine, sine] : directions_) {
      for (int t = 1; t <= reach_; ++t) {
        const int di = static_cast<int>(std::lround(t * cosine)), dj = static_cast<int>(std::lround(t * sine));
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
    const double fade = 1.0 / ((reach_ + 1.0) * (reach_ + 1.0));
    const int i0 = std::max(0, i - reach_), i1 = std::min(grid_.lattice.nx - 1, i + reach_);
    const int j0 = std::max(0, j - reach_), j1 = std::min(grid_.lattice.ny - 1, j + reach_);
    for (int y = j0; y <= j1; ++y) {
      const std::uint64_t* words = rim_.row(y);
      for (int k = i0 >> 6; k <= i1 >> 6; ++k) {
        for (std::uint64_t word = words[k]; word != 0; word &= word - 1) {
          const int x = k * 64 + std::countr_zero(word);
          if (x < i0 || x > i1) continue;
          const double dx = x - i, dy = y - j, squared = dx * dx + dy * dy;
          const double taper = 1 - squared * fade;
          const double z = grid_.height_m[grid_.lattice.index(x, y)];
          if (taper > 0 && side.holds(dx, dy, z)) support.push_back({dx, dy, z, taper * taper / squared});
        }
      }
    }
  }

  const scene::DepthGrid& grid_;
  double step_m_;
  int reach_;
  NodeSet rim_;
  std::array<std::array<double, 2>, kRays> directions_{};
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
  const NodeSet inside = intersection(closed, outline_nodes(grid, config.max_gap_m, pool));
  NodeSet gaps = intersection(inside, nodes_of(grid, scene::NodeState::unknown));
  if (gaps.count() == 0) return;

  Filler filler(grid, diameter / 2, step_m);
  filler.set_rim(intersection(dilate_by_disc(gaps, kRimWidth, pool), measured));
  std::vector<float> height(grid.height_m);
  pool.for_ranges(static_cast<std::size_t>(grid.lattice.ny), kRowsPerPiece, [&](std::size_t begin, std::size_t end) {
    Filler::Scratch scratch;
    for (int j = static_cast<int>(begin); j < static_cast<int>(end); ++j)
      for (int i = 0; i < grid.lattice.nx; ++i)
        if (gaps.contains(i, j)) height[grid.lattice.index(i, j)] = static_cast<float>(filler.height(i, j, scratch));
  });
  for (int j = 0; j < grid.lattice.ny; ++j)
    for (int i = 0; i < grid.lattice.nx; ++i) {
      const std::size_t n = grid.lattice.index(i, j);
      if (gaps.contains(i, j) && !std::isnan(height[n])) grid.state[n] = scene::NodeState::filled;
    }
  grid.height_m = std::move(height);
}

}  // namespace sparsha::pipeline
