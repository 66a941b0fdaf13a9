// Cells in which all points are within tolerance are joined where a pair of their points is (Galler & Fischer 1964).
#include "pipeline/filter/clusters.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <tuple>

#include "pipeline/filter/cells.h"

namespace sparsha::pipeline {
namespace {

using Point = CellOrder::Point;

class Forest {
 public:
  explicit Forest(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }

  [[nodiscard]] std::uint32_t root(std::uint32_t n) {
    while (parent_[n] != n) {
      parent_[n] = parent_[parent_[n]];
      n = parent_[n];
    }
    return n;
  }
  void join(std::uint32_t a, std::uint32_t b) { parent_[std::max(root(a), root(b))] = std::min(root(a), root(b)); }

 private:
  std::vector<std::uint32_t> parent_;
};

struct Box {
  Point low, high;
};

Box box_of(std::span<const Point> points) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  Box box{{kInfinity, kInfinity, kInfinity, 0}, {-kInfinity, -kInfinity, -kInfinity, 0}};
  for (const Point& p : points) {
    box.low = {std::min(box.low.x, p.x), std::min(box.low.y, p.y), std::min(box.low.z, p.z), 0};
    box.high = {std::max(box.high.x, p.x), std::max(box.high.y, p.y), std::max(box.high.z, p.z), 0};
  }
  return box;
}

/// Of the nearest places of two boxes; rounding is monotone, so no pair of their points is judged nearer.
float nearest(const Box& a, const Box& b) {
  const auto gap = [](float a_low, float a_high, float b_low, float b_high) {
    return std::max({0.0F, a_low - b_high, b_low - a_high});
  };
  const float dx = gap(a.low.x, a.high.x, b.low.x, b.high.x);
  const float dy = gap(a.low.y, a.high.y, b.low.y, b.high.y);
  const float dz = gap(a.low.z, a.high.z, b.low.z, b.high.z);
  return (dx * dx + dy * dy) + dz * dz;
}

/// True when a pair is closer than `limit` (squared). Halves the larger set until boxes are apart or sets are small, so
/// that two dense cells just out of reach cost no more than their points.
bool any_pair_within(std::vector<Point>& a, std::size_t a0, std::size_t a1, std::vector<Point>& b, std::size_t b0,
                     std::size_t b1, float limit) {
  constexpr std::size_t kFew = 64;
  const std::span<Point> left(a.data() + a0, a1 - a0);
  const std::span<Point> right(b.data() + b0, b1 - b0);
  if (left.size() * right.size() <= kFew) {
    return std::any_of(left.begin(), left.end(), [&](const Point& p) {
      return std::any_of(right.begin(), right.end(), [&](const Point& q) { return squared_distance(p, q) < limit; });
    });
  }
  const Box left_box = box_of(left);
  const Box right_box = box_of(right);
  if (!(nearest(left_box, right_box) < limit)) return false;
  if (right.size() > left.size()) return any_pair_within(b, b0, b1, a, a0, a1, limit);
  const auto middle = left.begin() + static_cast<std::ptrdiff_t>(left.size() / 2);
  const float width_x = left_box.high.x - left_box.low.x;
  const float width_y = left_box.high.y - left_box.low.y;
  const float width_z = left_box.high.z - left_box.low.z;
  const auto by = [&](float Point::*axis) {
    std::nth_element(left.begin(), middle, left.end(),
                     [axis](const Point& p, const Point& q) { return p.*axis < q.*axis; });
  };
  by(width_x >= width_y && width_x >= width_z ? &Point::x : width_y >= width_z ? &Point::y : &Point::z);
  const std::size_t half = a0 + left.size() / 2;
  return any_pair_within(a, a0, half, b, b0, b1, limit) || any_pair_within(a, half, a1, b, b0, b1, limit);
}

bool cells_touch(std::span<const Point> a, std::span<const Point> b, float limit) {
  constexpr std::size_t kBrute = 256;
  if (a.size() * b.size() <= kBrute) {
    for (const Point& p : a)
      for (const Point& q : b)
        if (squared_distance(p, q) < limit) return true;
    return false;
  }
  std::vector<Point> left(a.begin(), a.end());
  std::vector<Point> right(b.begin(), b.end());
  return any_pair_within(left, 0, left.size(), right, 0, right.size(), limit);
}

/// Numbers of clusters in the order in which points first show them.
std::vector<std::uint32_t> numbered(const std::vector<std::uint32_t>& root_of_point, std::size_t roots) {
  constexpr std::uint32_t kNone = ~std::uint32_t{0};
  std::vector<std::uint32_t> number(roots, kNone);
  std::vector<std::uint32_t> label(root_of_point.size());
  std::uint32_t next = 0;
  for (std::size_t i = 0; i < label.size(); ++i) {
    std::uint32_t& n = number[root_of_point[i]];
    if (n == kNone) n = next++;
    label[i] = n;
  }
  return label;
}

/// The same clusters, those joined that a triangle has corners in.
std::vector<std::uint32_t> joined_by_faces(const Cloud& cloud, std::vector<std::uint32_t> label) {
  if (cloud.faces.empty() || label.empty()) return label;
  const std::size_t clusters = std::size_t{*std::max_element(label.begin(), label.end())} + 1;
  Forest forest(clusters);
  for (const auto& [a, b, c] : cloud.faces) {
    forest.join(label[a], label[b]);
    forest.join(label[a], label[c]);
  }
  for (std::uint32_t& cluster : label) cluster = forest.root(cluster);
  return numbered(label, clusters);
}

bool less(const float* a, const float* b) { return std::lexicographical_compare(a, a + 3, b, b + 3); }

struct Cluster {
  std::uint64_t points = 0;
  std::size_t smallest = 0;  ///< its smallest point by x, y, z
};

std::vector<Cluster> summed(const Cloud& cloud, const std::vector<std::uint32_t>& label) {
  std::vector<Cluster> clusters(std::size_t{*std::max_element(label.begin(), label.end())} + 1);
  for (std::size_t i = 0; i < label.size(); ++i) {
    Cluster& cluster = clusters[label[i]];
    if (cluster.points++ == 0 || less(cloud.xyz1() + 4 * i, cloud.xyz1() + 4 * cluster.smallest)) cluster.smallest = i;
  }
  return clusters;
}

/// The point nearest to a place of the scan frame, and how far it is.
std::pair<std::size_t, double> nearest_point(const Cloud& cloud, const Eigen::Vector3d& place_m) {
  std::size_t best = 0;
  double least = std::numeric_limits<double>::infinity();
  const Eigen::Vector3d place = place_m - cloud.origin_m;
  for (std::size_t i = 0; i < cloud.size(); ++i) {
    const float* const p = cloud.xyz1() + 4 * i;
    const double away = (Eigen::Map<const Eigen::Vector3f>(p).cast<double>() - place).squaredNorm();
    if (away < least || (away == least && less(p, cloud.xyz1() + 4 * best))) {
      least = away;
      best = i;
    }
  }
  return {best, std::sqrt(least)};
}

}  // namespace

std::vector<std::uint32_t> euclidean_clusters(const Cloud& cloud, double tolerance_m, const Context& context) {
  const CellOrder order(cloud, tolerance_m, context);
  const auto limit = static_cast<float>(tolerance_m * tolerance_m);
  Forest forest(order.cells());
  CellOrder::Sweep sweep(order);
  for (std::size_t cell = 0; cell < order.cells(); ++cell) {
    if ((cell & 0xFFF) == 0) context.progress.throw_if_cancelled();
    for (const CellOrder::Range& range : sweep.near(cell)) {
      // Each pair once, from its later cell.
      for (std::size_t other = range.first; other < std::min(range.last, cell); ++other) {
        const auto a = static_cast<std::uint32_t>(cell);
        const auto b = static_cast<std::uint32_t>(other);
        if (forest.root(a) == forest.root(b)) continue;
        if (cells_touch(order.points(cell), order.points(other), limit)) forest.join(a, b);
      }
    }
  }
  std::vector<std::uint32_t> root(cloud.size());
  for (std::size_t cell = 0; cell < order.cells(); ++cell) {
    const std::uint32_t r = forest.root(static_cast<std::uint32_t>(cell));
    for (const Point& p : order.points(cell)) root[p.index] = r;
  }
  return numbered(root, order.cells());
}

KeptCluster choose_cluster(const Cloud& cloud, const scene::KeepConfig& config, const Context& context) {
  const std::vector<std::uint32_t> label =
      joined_by_faces(cloud, config.method == scene::KeepConfig::Method::pcl
                                 ? euclidean_clusters_by_pcl(cloud, config.tolerance_m, context.progress)
                                 : euclidean_clusters(cloud, config.tolerance_m, context));
  const std::vector<Cluster> clusters = summed(cloud, label);
  KeptCluster kept;
  std::size_t chosen = 0;
  if (config.nearest_to_m) {
    const auto [point, away_m] = nearest_point(cloud, *config.nearest_to_m);
    chosen = label[point];
    kept.away_m = away_m;
  } else {
    for (std::size_t c = 1; c < clusters.size(); ++c) {
      const Cluster& best = clusters[chosen];
      if (clusters[c].points < best.points) continue;
      if (clusters[c].points > best.points ||
          less(cloud.xyz1() + 4 * clusters[c].smallest, cloud.xyz1() + 4 * best.smallest)) {
        chosen = c;
      }
    }
  }
  kept.points = clusters[chosen].points;
  kept.clusters = clusters.size();
  for (std::size_t c = 0; c < clusters.size(); ++c) {
    if (clusters[c].points <= 2) kept.alone += clusters[c].points;
    if (c != chosen) kept.next = std::max(kept.next, clusters[c].points);
  }
  kept.keep.resize(label.size());
  for (std::size_t i = 0; i < label.size(); ++i) kept.keep[i] = label[i] == chosen ? 1 : 0;
  return kept;
}

}  // namespace sparsha::pipeline
