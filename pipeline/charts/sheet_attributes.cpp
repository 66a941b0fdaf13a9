// Two passes over the points: how far each is from its nearest sheet, then the sums of the nodes that it belongs to.
#include "pipeline/charts/sheet_attributes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "base/numbers/colour_sum.h"
#include "pipeline/projection/intensity_scale.h"

namespace sparsha::pipeline {
namespace {

constexpr double kWeightOne = 256.0;
constexpr std::size_t kPoints = 65536;  // of a piece

/// Where a measured node is.
struct NodeOfSheet {
  std::uint32_t sheet = 0;
  std::uint32_t node = 0;
};

/// The measured nodes of all sheets of a side, by their place in its lattice.
class SideNodes {
 public:
  SideNodes(const scene::Charts& charts, scene::Side side) : charts_(&charts), axes_(scene::SideAxes::of(side)) {
    std::vector<std::uint32_t> sheets;
    int end_u = std::numeric_limits<int>::min(), end_v = end_u;
    first_u_ = first_v_ = std::numeric_limits<int>::max();
    for (std::size_t s = 0; s < charts.sheets.size(); ++s) {
      const scene::Sheet& sheet = charts.sheets[s];
      if (sheet.side != side) continue;
      sheets.push_back(static_cast<std::uint32_t>(s));
      first_u_ = std::min(first_u_, sheet.first_u);
      first_v_ = std::min(first_v_, sheet.first_v);
      end_u = std::max(end_u, sheet.first_u + sheet.nx);
      end_v = std::max(end_v, sheet.first_v + sheet.ny);
    }
    if (sheets.empty()) return;
    nx_ = end_u - first_u_;
    ny_ = end_v - first_v_;
    begins_.assign(static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_) + 1, 0);
    each_node(sheets, [&](std::size_t place, const NodeOfSheet& /*node*/) { ++begins_[place + 1]; });
    for (std::size_t k = 1; k < begins_.size(); ++k) begins_[k] += begins_[k - 1];
    nodes_.resize(begins_.back());
    std::vector<std::uint32_t> next(begins_.begin(), begins_.end() - 1);
    each_node(sheets, [&](std::size_t place, const NodeOfSheet& node) { nodes_[next[place]++] = node; });
  }

  [[nodiscard]] const std::vector<NodeOfSheet>& nodes() const { return nodes_; }

  /// Calls use(number in nodes(), distance from its tangent plane in metres, bilinear weight) for the nodes at the
  /// corners of the cell of a place, metres from the charts' origin.
  template <class Use>
  void about(const Eigen::Vector3d& place_m, const Use& use) const {
    if (nodes_.empty()) return;
    const double spacing_m = charts_->spacing_m;
    const Eigen::Vector3d p = axes_.to_chart(place_m);
    const double u = p.x() / spacing_m - first_u_, v = p.y() / spacing_m - first_v_;
    if (!(u > -1.0 && v > -1.0 && u < nx_ && v < ny_)) return;
    const int i = static_cast<int>(std::floor(u)), j = static_cast<int>(std::floor(v));
    for (int b = std::max(0, j); b <= std::min(ny_ - 1, j + 1); ++b)
      for (int a = std::max(0, i); a <= std::min(nx_ - 1, i + 1); ++a) {
        const std::size_t place = index(a, b);
        for (std::uint32_t k = begins_[place]; k < begins_[place + 1]; ++k) {
          const scene::Sheet& sheet = charts_->sheets[nodes_[k].sheet];
          const std::size_t node = nodes_[k].node;
          const double su = sheet.slope_u[node], sv = sheet.slope_v[node];
          const double above_m = p.z() - sheet.height_m[node] - spacing_m * (su * (u - a) + sv * (v - b));
          const double near = std::max(0.0, 1.0 - std::abs(u - a)) * std::max(0.0, 1.0 - std::abs(v - b));
          use(k, std::abs(above_m) / std::sqrt(1.0 + su * su + sv * sv), near);
        }
      }
  }

 private:
  [[nodiscard]] std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(i);
  }
  template <class Use>
  void each_node(const std::vector<std::uint32_t>& sheets, const Use& use) const {
    for (const std::uint32_t s : sheets) {
      const scene::Sheet& sheet = charts_->sheets[s];
      for (int j = 0; j < sheet.ny; ++j)
        for (int i = 0; i < sheet.nx; ++i)
          if (sheet.measured(sheet.index(i, j)))
            use(index(sheet.first_u - first_u_ + i, sheet.first_v - first_v_ + j),
                {s, static_cast<std::uint32_t>(sheet.index(i, j))});
    }
  }

  const scene::Charts* charts_;
  scene::SideAxes axes_;
  int first_u_ = 0, first_v_ = 0, nx_ = 0, ny_ = 0;
  std::vector<std::uint32_t> begins_;  // of the nodes at a place of the lattice, and their end
  std::vector<NodeOfSheet> nodes_;
};

/// Points in the charts' frame.
class Places {
 public:
  Places(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const Eigen::Vector3d& origin_m)
      : xyz1_(cloud.xyz1()),
        turn_(scan_to_grid.topLeftCorner<3, 3>()),
        shift_m_(turn_ * cloud.origin_m + scan_to_grid.topRightCorner<3, 1>() - origin_m) {}

  [[nodiscard]] Eigen::Vector3d operator()(std::size_t k) const {
    return turn_ * Eigen::Map<const Eigen::Vector3f>(xyz1_ + 4 * k).cast<double>() + shift_m_;
  }

 private:
  const float* xyz1_;
  Eigen::Matrix3d turn_;
  Eigen::Vector3d shift_m_;
};

struct IntensitySum {
  std::int64_t value = 0;
  std::int64_t weight = 0;
};

/// Calls mean(neighbours) for each measured node without points that misses a value, where some of its eight neighbours
/// in the sheet have one, and again for as many rounds. `has_points`: of nodes.
template <class Value, class Misses, class Mean>
void fill_between(const scene::Sheet& sheet, const std::vector<bool>& has_points, std::vector<Value>& values,
                  int rounds, const Misses& misses, const Mean& mean) {
  std::vector<std::size_t> missing;
  for (std::size_t node = 0; node < sheet.count(); ++node)
    if (sheet.measured(node) && !has_points[node] && misses(values[node])) missing.push_back(node);
  std::vector<std::pair<std::size_t, Value>> found;
  for (int round = 0; round < rounds && !missing.empty(); ++round) {
    found.clear();
    for (const std::size_t node : missing) {
      const int i = static_cast<int>(node % static_cast<std::size_t>(sheet.nx));
      const int j = static_cast<int>(node / static_cast<std::size_t>(sheet.nx));
      std::array<Value, 8> about{};
      std::size_t count = 0;
      for (int b = std::max(0, j - 1); b <= std::min(sheet.ny - 1, j + 1); ++b)
        for (int a = std::max(0, i - 1); a <= std::min(sheet.nx - 1, i + 1); ++a)
          if (!misses(values[sheet.index(a, b)])) about[count++] = values[sheet.index(a, b)];
      if (count > 0) found.emplace_back(node, mean(about, count));
    }
    if (found.empty()) return;
    for (const auto& [node, value] : found) values[node] = value;
    std::erase_if(missing, [&](std::size_t node) { return !misses(values[node]); });
  }
}

class Attributes {
 public:
  Attributes(scene::Charts& charts, const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const AttributeRule& rule,
             const Context& context)
      : charts_(charts),
        cloud_(cloud),
        places_(cloud, scan_to_grid, charts.origin_m),
        rule_(rule),
        pool_(context.pool),
        colour_(rule.colour && !cloud.rgba.empty()),
        intensity_(rule.intensity && !cloud.intensity.empty()),
        scale_(intensity_ ? largest_magnitude(cloud.intensity.data(), cloud.size()) : 0.0F) {}

  void add() {
    if (!colour_ && !intensity_) return;
    for (scene::Sheet& sheet : charts_.sheets) {
      has_points_.emplace_back(sheet.count(), false);
      if (colour_) sheet.colour_rgba.assign(sheet.count(), kNoColour);
      if (intensity_) sheet.intensity.assign(sheet.count(), kNoIntensity);
    }
    std::vector<SideNodes> sides;
    for (std::size_t side = 0; side < scene::kSides; ++side)
      sides.emplace_back(charts_, static_cast<scene::Side>(side));
    const std::vector<float> least_m = distances(sides);
    constexpr std::size_t kInTurn = 3;  // sides of a thread, so that no more than two have their sums at once
    pool_.for_ranges(scene::kSides, kInTurn, [&](std::size_t begin, std::size_t end) {
      for (std::size_t side = begin; side < end; ++side) add(sides[side], least_m);
    });
    sides.clear();
    pool_.for_ranges(charts_.sheets.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s) fill(charts_.sheets[s], has_points_[s]);
    });
  }

 private:
  /// Of each point from the nearest tangent plane of a node about it.
  [[nodiscard]] std::vector<float> distances(const std::vector<SideNodes>& sides) const {
    std::vector<float> least_m(cloud_.size(), std::numeric_limits<float>::infinity());
    pool_.for_ranges(cloud_.size(), kPoints, [&](std::size_t begin, std::size_t end) {
      for (const SideNodes& side : sides)
        for (std::size_t k = begin; k < end; ++k)
          side.about(places_(k), [&](std::uint32_t /*node*/, double distance_m, double /*near*/) {
            least_m[k] = std::min(least_m[k], static_cast<float>(distance_m));
          });
    });
    return least_m;
  }

  void add(const SideNodes& side, const std::vector<float>& least_m) {
    constexpr double kNoises = 4.0;
    const double most_m = std::max(charts_.spacing_m, rule_.point_spacing_m) + kNoises * rule_.noise_m;
    const double margin_m = 0.5 * rule_.point_spacing_m;
    std::vector<ColourSum> colours(colour_ ? side.nodes().size() : 0);
    std::vector<IntensitySum> intensities(intensity_ ? side.nodes().size() : 0);
    for (std::size_t k = 0; k < cloud_.size(); ++k) {
      if (!(static_cast<double>(least_m[k]) <= most_m)) continue;
      const std::optional<std::int64_t> value = intensity_ ? scale_.of(cloud_.intensity[k]) : std::nullopt;
      side.about(places_(k), [&](std::uint32_t node, double distance_m, double near) {
        if (distance_m > static_cast<double>(least_m[k]) + margin_m) return;
        has_points_[side.nodes()[node].sheet][side.nodes()[node].node] = true;
        const std::int64_t weight = std::lround(near * kWeightOne) + 1;
        if (colour_) colours[node].add(cloud_.rgba[k], weight);
        if (!value) return;
        intensities[node].value += weight * *value;
        intensities[node].weight += weight;
      });
    }
    for (std::size_t n = 0; n < side.nodes().size(); ++n) {
      const auto [s, node] = side.nodes()[n];
      if (colour_) charts_.sheets[s].colour_rgba[node] = colours[n].mean();
      if (intensity_ && intensities[n].weight > 0)
        charts_.sheets[s].intensity[node] =
            scale_.back(static_cast<double>(intensities[n].value) / static_cast<double>(intensities[n].weight));
    }
  }

  void fill(scene::Sheet& sheet, const std::vector<bool>& has_points) const {
    constexpr double kReach = 2.0;  // point spacings
    constexpr double kMost = 16.0;
    const int rounds =
        static_cast<int>(std::clamp(std::ceil(kReach * rule_.point_spacing_m / charts_.spacing_m), 1.0, kMost));
    if (colour_)
      fill_between(
          sheet, has_points, sheet.colour_rgba, rounds, [](std::uint32_t rgba) { return rgba == kNoColour; },
          [](const std::array<std::uint32_t, 8>& about, std::size_t count) {
            ColourSum sum;
            for (std::size_t k = 0; k < count; ++k) sum.add(about[k]);
            return sum.mean();
          });
    if (intensity_)
      fill_between(
          sheet, has_points, sheet.intensity, rounds, [](float value) { return std::isnan(value); },
          [](const std::array<float, 8>& about, std::size_t count) {
            float sum = 0.0F;
            for (std::size_t k = 0; k < count; ++k) sum += about[k];
            return sum / static_cast<float>(count);
          });
  }

  scene::Charts& charts_;
  const Cloud& cloud_;
  Places places_;
  AttributeRule rule_;
  ThreadPool& pool_;
  bool colour_, intensity_;
  IntensityScale scale_;
  std::vector<std::vector<bool>> has_points_;  // of each sheet's nodes; those of one side are written by one thread
};

}  // namespace

void add_attributes(scene::Charts& charts, const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid,
                    const AttributeRule& rule, const Context& context) {
  Attributes(charts, cloud, scan_to_grid, rule, context).add();
}

}  // namespace sparsha::pipeline
