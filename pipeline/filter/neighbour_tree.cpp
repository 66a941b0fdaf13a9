#include "pipeline/filter/neighbour_tree.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace sparsha::pipeline {
namespace {

constexpr float kFar = std::numeric_limits<float>::infinity();
constexpr std::size_t kSubtree = 1 << 15;  // points of a part that one thread builds

}  // namespace

NeighbourTree::Box NeighbourTree::bounds(std::span<const Point> points) {
  Box box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  for (const Point& p : points) {
    box.low[0] = std::min(box.low[0], p.x);
    box.low[1] = std::min(box.low[1], p.y);
    box.low[2] = std::min(box.low[2], p.z);
    box.high[0] = std::max(box.high[0], p.x);
    box.high[1] = std::max(box.high[1], p.y);
    box.high[2] = std::max(box.high[2], p.z);
  }
  return box;
}

/// Parts the points across the box's longest side at the median of a few; at the very middle when that is lopsided.
std::size_t NeighbourTree::split(std::span<Point> points, const Box& box) {
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    if (box.high[k] - box.low[k] > box.high[axis] - box.low[axis]) axis = k;
  }
  const auto coordinate = [axis](const Point& p) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; };
  constexpr std::size_t kSample = 31;
  const std::size_t n = points.size();
  if (n > 4 * kSample) {
    std::array<float, kSample> sample{};
    for (std::size_t i = 0; i < kSample; ++i) sample[i] = coordinate(points[(2 * i + 1) * n / (2 * kSample)]);
    std::nth_element(sample.begin(), sample.begin() + kSample / 2, sample.end());
    const float pivot = sample[kSample / 2];
    const auto middle =
        std::partition(points.begin(), points.end(), [&](const Point& p) { return coordinate(p) < pivot; });
    const auto below = static_cast<std::size_t>(middle - points.begin());
    if (below > n / 8 && below < n - n / 8) return below;
  }
  // Leaves fill better when small parts are cut at multiples of their size.
  std::size_t half = n / 2;
  if (n <= 8 * kLeaf) half = (n + 2 * kLeaf - 1) / (2 * kLeaf) * kLeaf;
  half = std::min(half, n - 1);
  std::nth_element(points.begin(), points.begin() + static_cast<std::ptrdiff_t>(half), points.end(),
                   [&](const Point& a, const Point& b) { return coordinate(a) < coordinate(b); });
  return half;
}

/// Splits nodes until none has more than `least` points; nodes[0] and its range are given.
void NeighbourTree::build(std::vector<Node>& nodes, std::span<Point> points, std::size_t least,
                          const Progress& progress) {
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    const std::size_t first = nodes[i].first;
    const std::size_t count = nodes[i].count;
    if (count >= kSubtree) progress.throw_if_cancelled();
    const std::span<Point> part = points.subspan(first, count);
    nodes[i].box = bounds(part);
    if (count <= least) continue;
    const std::size_t below = split(part, nodes[i].box);
    nodes[i].left = static_cast<std::uint32_t>(nodes.size());
    nodes[i].right = nodes[i].left + 1;
    Node child;
    child.first = static_cast<std::uint32_t>(first);
    child.count = static_cast<std::uint32_t>(below);
    nodes.push_back(child);
    child.first = static_cast<std::uint32_t>(first + below);
    child.count = static_cast<std::uint32_t>(count - below);
    nodes.push_back(child);
  }
}

NeighbourTree::NeighbourTree(const float* xyz1, std::size_t count, const Context& context) : size_(count) {
  if (count == 0) return;
  std::vector<Point> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    points[i] = {xyz1[4 * i], xyz1[4 * i + 1], xyz1[4 * i + 2], static_cast<std::uint32_t>(i)};
  }
  Node root;
  root.count = static_cast<std::uint32_t>(count);
  nodes_.push_back(root);
  build(nodes_, points, kSubtree, context.progress);
  std::vector<std::size_t> tops;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (nodes_[i].left == 0) tops.push_back(i);
  }
  std::vector<std::vector<Node>> parts(tops.size());
  context.pool.for_ranges(tops.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t t = begin; t < end; ++t) {
      parts[t].push_back(nodes_[tops[t]]);
      build(parts[t], points, kLeaf, context.progress);
    }
  });
  for (std::size_t t = 0; t < tops.size(); ++t) {
    // The part's root takes its top's place; the rest is appended, so child numbers move.
    const auto shift = static_cast<std::uint32_t>(nodes_.size() - 1);
    for (Node& node : parts[t]) {
      if (node.left != 0) {
        node.left += shift;
        node.right += shift;
      }
    }
    nodes_[tops[t]] = parts[t].front();
    nodes_.insert(nodes_.end(), parts[t].begin() + 1, parts[t].end());
    parts[t] = {};
  }
  context.progress.throw_if_cancelled();
  make_leaves(points);
}

void NeighbourTree::make_leaves(std::span<const Point> points) {
  // Leaves lie in memory in the order of their points, so that neighbours in space are neighbours in memory.
  std::vector<std::uint32_t> order;
  for (std::size_t i = 0; i < nodes_.size(); ++i) {
    if (nodes_[i].left == 0) order.push_back(static_cast<std::uint32_t>(i));
  }
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return nodes_[a].first < nodes_[b].first; });
  leaves_.resize(order.size());
  for (std::size_t l = 0; l < order.size(); ++l) {
    Node& node = nodes_[order[l]];
    Leaf& leaf = leaves_[l];
    leaf.x.fill(kFar);
    leaf.y.fill(kFar);
    leaf.z.fill(kFar);
    leaf.index.fill(0);
    leaf.node = order[l];
    leaf.count = node.count;
    for (std::size_t i = 0; i < node.count; ++i) {
      const Point& p = points[node.first + i];
      leaf.x[i] = p.x;
      leaf.y[i] = p.y;
      leaf.z[i] = p.z;
      leaf.index[i] = p.index;
    }
    node.first = static_cast<std::uint32_t>(l);
  }
}

/// The nearest squared distances so far of each point of one leaf, ascending, itself included.
struct NeighbourTree::Search {
  std::size_t wanted;  ///< a point's neighbours and itself
  std::size_t stride;  ///< of rows: a guard of four, then `wanted` rounded up to four
  std::vector<float> best;
  std::vector<std::pair<float, std::uint32_t>> stack;

  explicit Search(std::size_t k) : wanted(k), stride(4 + (k + 3) / 4 * 4), best(kLeaf * stride) {}

  [[nodiscard]] float* row(std::size_t query) { return best.data() + query * stride + 4; }
  [[nodiscard]] float worst(std::size_t query) { return row(query)[wanted - 1]; }
  void clear() {
    std::fill(best.begin(), best.end(), kFar);
    for (std::size_t q = 0; q < kLeaf; ++q) row(q)[-1] = -kFar;
  }

  /// Puts one leaf's points into a query's row.
  void look(const Leaf& leaf, float x, float y, float z, std::size_t query) {
    alignas(16) std::array<float, kLeaf> squared;
    float* const nearest = row(query);
    unsigned nearer = squared_distances(leaf, x, y, z, nearest[wanted - 1], squared);
    for (; nearer != 0; nearer &= nearer - 1) {
      insert(nearest, squared[static_cast<std::size_t>(std::countr_zero(nearer))]);
    }
  }

  /// Each place takes the middle one of what it has, what is below it and the new distance: no branch to mispredict.
  void insert(float* nearest, float d) const {
#if defined(__SSE2__)
    const __m128 value = _mm_set1_ps(d);
    for (std::size_t i = stride - 4; i > 0; i -= 4) {
      const __m128 below = _mm_loadu_ps(nearest + i - 5);
      _mm_storeu_ps(nearest + i - 4, _mm_min_ps(_mm_loadu_ps(nearest + i - 4), _mm_max_ps(below, value)));
    }
#else
    for (std::size_t i = stride - 4; i > 0; --i) nearest[i - 1] = std::min(nearest[i - 1], std::max(nearest[i - 2], d));
#endif
  }

  /// Distances of a leaf's points; bit i of the result: point i is nearer than `worst`. The scalar code and the one
  /// with SSE2, which every x86-64 has, agree bit for bit.
  static unsigned squared_distances(const Leaf& leaf, float x, float y, float z, float worst,
                                    std::array<float, kLeaf>& squared) {
    unsigned nearer = 0;
#if defined(__SSE2__)
    const __m128 qx = _mm_set1_ps(x);
    const __m128 qy = _mm_set1_ps(y);
    const __m128 qz = _mm_set1_ps(z);
    const __m128 limit = _mm_set1_ps(worst);
    for (std::size_t i = 0; i < kLeaf; i += 4) {
      const __m128 dx = _mm_sub_ps(_mm_loadu_ps(leaf.x.data() + i), qx);
      const __m128 dy = _mm_sub_ps(_mm_loadu_ps(leaf.y.data() + i), qy);
      const __m128 dz = _mm_sub_ps(_mm_loadu_ps(leaf.z.data() + i), qz);
      const __m128 sum = _mm_add_ps(_mm_add_ps(_mm_mul_ps(dx, dx), _mm_mul_ps(dy, dy)), _mm_mul_ps(dz, dz));
      _mm_store_ps(squared.data() + i, sum);
      nearer |= static_cast<unsigned>(_mm_movemask_ps(_mm_cmplt_ps(sum, limit))) << i;
    }
#else
    for (std::size_t i = 0; i < kLeaf; ++i) {
      const float dx = leaf.x[i] - x;
      const float dy = leaf.y[i] - y;
      const float dz = leaf.z[i] - z;
      squared[i] = (dx * dx + dy * dy) + dz * dz;
      nearer |= (squared[i] < worst ? 1U : 0U) << i;
    }
#endif
    return nearer;
  }
};

void NeighbourTree::search_leaf(const Leaf& leaf, Search& search) const {
  const Box& home = nodes_[leaf.node].box;
  search.clear();
  for (std::size_t q = 0; q < leaf.count; ++q) search.look(leaf, leaf.x[q], leaf.y[q], leaf.z[q], q);
  const auto widest = [&] {
    float most = 0.0F;
    for (std::size_t q = 0; q < leaf.count; ++q) most = std::max(most, search.worst(q));
    return most;
  };
  float reach = widest();
  // Rounding is monotone, so a box is never judged farther than a point in it.
  const auto gap = [&](const Box& box) {
    float sum = 0.0F;
    for (std::size_t k = 0; k < 3; ++k) {
      const float d = std::max({0.0F, box.low[k] - home.high[k], home.low[k] - box.high[k]});
      sum += d * d;
    }
    return sum;
  };
  search.stack.clear();
  search.stack.emplace_back(0.0F, 0U);
  while (!search.stack.empty()) {
    const auto [distance, number] = search.stack.back();
    search.stack.pop_back();
    if (!(distance < reach)) continue;
    const Node& node = nodes_[number];
    if (node.left != 0) {
      const float left = gap(nodes_[node.left].box);
      const float right = gap(nodes_[node.right].box);
      const bool left_first = left <= right;
      search.stack.emplace_back(left_first ? right : left, left_first ? node.right : node.left);
      search.stack.emplace_back(left_first ? left : right, left_first ? node.left : node.right);
      continue;
    }
    if (number == leaf.node) continue;
    const Leaf& other = leaves_[node.first];
    for (std::size_t q = 0; q < leaf.count; ++q) {
      const float dx = std::max({0.0F, node.box.low[0] - leaf.x[q], leaf.x[q] - node.box.high[0]});
      const float dy = std::max({0.0F, node.box.low[1] - leaf.y[q], leaf.y[q] - node.box.high[1]});
      const float dz = std::max({0.0F, node.box.low[2] - leaf.z[q], leaf.z[q] - node.box.high[2]});
      if ((dx * dx + dy * dy) + dz * dz < search.worst(q)) search.look(other, leaf.x[q], leaf.y[q], leaf.z[q], q);
    }
    reach = widest();
  }
}

std::vector<float> NeighbourTree::mean_distances(int neighbours, const Context& context) const {
  std::vector<float> mean(size_, 0.0F);
  const std::size_t k = std::min(static_cast<std::size_t>(neighbours), size_ > 0 ? size_ - 1 : 0);
  if (k == 0) return mean;
  constexpr std::size_t kGrain = 64;
  context.pool.for_ranges(leaves_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    context.progress.throw_if_cancelled();
    Search search(k + 1);
    for (std::size_t l = begin; l < end; ++l) {
      const Leaf& leaf = leaves_[l];
      search_leaf(leaf, search);
      for (std::size_t q = 0; q < leaf.count; ++q) {
        const float* const row = search.row(q);
        double sum = 0.0;
        for (std::size_t i = 1; i <= k; ++i) sum += std::sqrt(static_cast<double>(row[i]));
        mean[leaf.index[q]] = static_cast<float>(sum / static_cast<double>(k));
      }
    }
  });
  return mean;
}

}  // namespace sparsha::pipeline
