// Nodes lie in cells of a hashed lattice in space; the nearest is found ring by ring.
#include "pipeline/check/charts_check.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <iterator>
#include <limits>
#include <vector>

#include <Eigen/Geometry>

#include "base/numbers/hash.h"
#include "pipeline/check/statistics.h"

namespace sparsha::pipeline {
namespace {

using Eigen::Vector3d;

constexpr std::uint64_t kMostNodes = 200000;
constexpr double kSameWay = 0.86602540378;  // cosine of 30 degrees
constexpr double kNearSpacings = 1.5;       // nodes of another side that show the same place

struct Node {
  Eigen::Vector3f place_m;  // relative to the charts' origin
  Eigen::Vector3f normal;
  scene::Side side;
};

class Nodes {
 public:
  explicit Nodes(const scene::Charts& charts) : per_m_(1.0 / charts.spacing_m) {
    nodes_.reserve(charts.measured_nodes());
    for (const scene::Sheet& sheet : charts.sheets) {
      for (int j = 0; j < sheet.ny; ++j) {
        for (int i = 0; i < sheet.nx; ++i) {
          if (!sheet.measured(sheet.index(i, j))) continue;
          nodes_.push_back({charts.place_m(sheet, i, j).cast<float>(), scene::Charts::normal(sheet, i, j).cast<float>(),
                            sheet.side});
        }
      }
    }
    // Cells chain their nodes in a table of twice as many places.
    table_.assign(std::bit_ceil(2 * nodes_.size() + 1), kNone);
    next_.resize(nodes_.size());
    for (std::uint32_t n = 0; n < nodes_.size(); ++n) {
      std::uint32_t& first = table_[slot(cell_of(nodes_[n].place_m.cast<double>()))];
      next_[n] = first;
      first = n;
    }
  }

  [[nodiscard]] const std::vector<Node>& all() const { return nodes_; }

  /// The nearest node within `reach` cells that `counts`; null when there is none.
  template <typename Counts>
  [[nodiscard]] const Node* nearest(const Vector3d& place_m, double reach, const Counts& counts) const {
    const std::array<std::int64_t, 3> middle = cell_of(place_m);
    const double side_m = 1.0 / per_m_;
    const Node* best = nullptr;
    double least2 = reach * reach * side_m * side_m;
    const auto rings = static_cast<std::int64_t>(std::ceil(reach));
    for (std::int64_t ring = 0; ring <= rings; ++ring) {
      if (best != nullptr && std::sqrt(least2) < static_cast<double>(ring - 1) * side_m) break;
      for (std::int64_t a = -ring; a <= ring; ++a) {
        for (std::int64_t b = -ring; b <= ring; ++b) {
          const bool inner = std::max(std::abs(a), std::abs(b)) < ring;
          for (std::int64_t c = -ring; c <= ring; c += inner ? 2 * std::max<std::int64_t>(1, ring) : 1) {
            for (std::uint32_t n = table_[slot({middle[0] + a, middle[1] + b, middle[2] + c})]; n != kNone;
                 n = next_[n]) {
              const double here = (nodes_[n].place_m.cast<double>() - place_m).squaredNorm();
              // Nodes that are equally near: the first, whatever the table's order.
              if (here > least2 || (best != nullptr && here == least2 && &nodes_[n] >= best)) continue;
              if (!counts(nodes_[n])) continue;
              least2 = here;
              best = &nodes_[n];
            }
          }
        }
      }
    }
    return best;
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffU;

  [[nodiscard]] std::array<std::int64_t, 3> cell_of(const Vector3d& place_m) const {
    constexpr double kMost = 1e15;  // cells; what is farther away is near nothing
    std::array<std::int64_t, 3> cell{};
    for (int axis = 0; axis < 3; ++axis) {
      cell[static_cast<std::size_t>(axis)] =
          static_cast<std::int64_t>(std::clamp(std::floor(place_m[axis] * per_m_), -kMost, kMost));
    }
    return cell;
  }
  [[nodiscard]] std::size_t slot(const std::array<std::int64_t, 3>& cell) const {
    return hash_cell(cell) & (table_.size() - 1);
  }

  double per_m_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> table_, next_;
};

std::uint64_t key_of(const float* xyz) {
  return hash_words(std::array<std::uint64_t, 3>{std::bit_cast<std::uint32_t>(xyz[0]),
                                                 std::bit_cast<std::uint32_t>(xyz[1]),
                                                 std::bit_cast<std::uint32_t>(xyz[2])});
}

std::vector<float> known_of(const std::vector<float>& values) {
  std::vector<float> known;
  std::copy_if(values.begin(), values.end(), std::back_inserter(known), [](float v) { return std::isfinite(v); });
  return known;
}

constexpr float kNothing = std::numeric_limits<float>::quiet_NaN();

}  // namespace

ChartCheck check_charts(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const scene::Charts& charts,
                        const scene::CheckConfig& config, const Context& context) {
  const Nodes nodes(charts);
  ChartCheck result;
  result.points = cloud.size();
  const float* xyz = cloud.xyz1();
  const std::vector<std::uint64_t> sample = choose_sample(
      cloud.size(), static_cast<std::uint64_t>(std::max<std::int64_t>(0, config.samples)), [&](const auto& offer) {
        for (std::size_t k = 0; k < cloud.size(); ++k) offer(mix_bits(key_of(xyz + 4 * k)), k);
      });
  result.sampled = sample.size();
  std::vector<float> distance_m(sample.size(), kNothing);
  context.pool.for_ranges(sample.size(), 1024, [&](std::size_t begin, std::size_t end) {
    context.progress.throw_if_cancelled();
    for (std::size_t s = begin; s < end; ++s) {
      const float* p = xyz + 4 * static_cast<std::size_t>(sample[s]);
      const Vector3d scan_m = cloud.origin_m + Eigen::Map<const Eigen::Vector3f>(p).cast<double>();
      const Vector3d place_m = (scan_to_grid * scan_m.homogeneous()).head<3>() - charts.origin_m;
      const Node* nearest = nodes.nearest(place_m, ChartCheck::kFarSpacings, [](const Node&) { return true; });
      if (nearest == nullptr) continue;
      distance_m[s] = nearest->normal.dot((place_m - nearest->place_m.cast<double>()).cast<float>());
    }
  });
  const std::vector<float> near_m = known_of(distance_m);
  result.far = sample.size() - near_m.size();
  result.cloud_to_surface = statistics_of(near_m, cloud.size());

  const std::size_t step = nodes.all().size() / kMostNodes + 1;
  result.nodes = (nodes.all().size() + step - 1) / step;
  std::vector<float> apart_m(result.nodes, kNothing);
  context.pool.for_ranges(result.nodes, 1024, [&](std::size_t begin, std::size_t end) {
    context.progress.throw_if_cancelled();
    for (std::size_t n = begin; n < end; ++n) {
      const Node& node = nodes.all()[n * step];
      const Node* other = nodes.nearest(node.place_m.cast<double>(), kNearSpacings, [&](const Node& o) {
        return o.side != node.side && o.normal.dot(node.normal) >= static_cast<float>(kSameWay);
      });
      if (other == nullptr) continue;
      // Along the mean normal, so that a bend between the two counts for neither.
      apart_m[n] = (node.normal + other->normal).normalized().dot(node.place_m - other->place_m);
    }
  });
  const std::vector<float> agreement_m = known_of(apart_m);
  result.nodes_alone = result.nodes - agreement_m.size();
  result.agreement = statistics_of(agreement_m, result.nodes);
  return result;
}

}  // namespace sparsha::pipeline
