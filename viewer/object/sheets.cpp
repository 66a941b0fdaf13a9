// Sheets are compared where they overlap, by an index of blocks for each side.
#include "viewer/object/sheets.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <utility>

#include "base/numbers/colour_sum.h"

namespace sparsha::viewer {
namespace {

constexpr int kRings = 3;             // nodes beyond the border that a continuation may reach
constexpr int kPad = kRings + 1;      // around a sheet's own nodes
constexpr double kSame = 0.6;         // sheets nearer than this along the normal are the same surface
constexpr double kSameCosine = 0.82;  // if their normals are within 35 degrees
constexpr double kMargin = 0.06;      // of facing: by so much another sheet must face the surface better
constexpr int kBlock = 16;            // nodes along a block of the index
constexpr float kNone = std::numeric_limits<float>::quiet_NaN();

using Node = DrawnSheet::Node;

/// A sheet's surface at a place, chart frame of its side.
struct Found {
  double height = 0.0;
  std::size_t node = 0;  ///< the nearest of the cell's four
};

/// Nothing outside the sheet's cells; `continued`: cells of continued nodes count as well.
std::optional<Found> surface_at(const DrawnSheet& sheet, double u, double v, bool continued) {
  const double x = u - sheet.first_u, y = v - sheet.first_v;
  if (!(x >= 0.0 && y >= 0.0 && x < sheet.nx - 1 && y < sheet.ny - 1)) return std::nullopt;
  const int i = static_cast<int>(x), j = static_cast<int>(y);
  const std::size_t k = sheet.index(i, j), up = k + static_cast<std::size_t>(sheet.nx);
  if (sheet.cell[k] == 0) {
    if (!continued) return std::nullopt;
    const std::array<std::size_t, 4> corners{k, k + 1, up, up + 1};
    const bool whole = std::ranges::all_of(corners, [&](std::size_t c) { return std::isfinite(sheet.height[c]); });
    const bool step = std::ranges::all_of(corners, [&](std::size_t c) { return sheet.node[c] == Node::measured; });
    if (!whole || step) return std::nullopt;
  }
  const double s = x - i, t = y - j;
  const auto h = [&](std::size_t c) { return static_cast<double>(sheet.height[c]); };
  Found found;
  found.height = (1 - t) * ((1 - s) * h(k) + s * h(k + 1)) + t * ((1 - s) * h(up) + s * h(up + 1));
  found.node = (t < 0.5 ? k : up) + (s < 0.5 ? 0 : 1);
  return found;
}

/// Which sheets of a side come near a place.
class SideIndex {
 public:
  void add(const DrawnSheet& sheet, std::uint32_t number) {
    for (int b = block(sheet.first_v); b <= block(sheet.first_v + sheet.ny); ++b)
      for (int a = block(sheet.first_u); a <= block(sheet.first_u + sheet.nx); ++a) {
        bool any = false;
        const int i0 = std::max(a * kBlock - sheet.first_u, 0), j0 = std::max(b * kBlock - sheet.first_v, 0);
        const int i1 = std::min((a + 1) * kBlock - sheet.first_u, sheet.nx - 1);
        const int j1 = std::min((b + 1) * kBlock - sheet.first_v, sheet.ny - 1);
        for (int j = j0; j <= j1 && !any; ++j)
          for (int i = i0; i <= i1 && !any; ++i) any = std::isfinite(sheet.height[sheet.index(i, j)]);
        if (any) sheets_[key(a, b)].push_back(number);
      }
  }
  [[nodiscard]] const std::vector<std::uint32_t>& near(double u, double v) const {
    static const std::vector<std::uint32_t> kEmpty;
    const auto found =
        sheets_.find(key(block(static_cast<int>(std::floor(u))), block(static_cast<int>(std::floor(v)))));
    return found == sheets_.end() ? kEmpty : found->second;
  }

 private:
  static int block(int node) { return node >= 0 ? node / kBlock : -((kBlock - 1 - node) / kBlock); }
  static std::uint64_t key(int a, int b) {
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32U | static_cast<std::uint32_t>(b);
  }
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> sheets_;
};

class Drawing {
 public:
  Drawing(const scene::Charts& charts, ThreadPool& pool) : pool_(pool) {
    sheets_.resize(charts.sheets.size());
    each([&](std::size_t s) { sheets_[s] = padded(charts.sheets[s], charts.spacing_m); });
    for (std::size_t s = 0; s < sheets_.size(); ++s)
      index_[static_cast<std::size_t>(sheets_[s].side)].add(sheets_[s], static_cast<std::uint32_t>(s));
  }

  std::vector<DrawnSheet> run() {
    // Cells are changed last: until then all sheets are asked for what they measured.
    std::vector<std::vector<std::uint8_t>> cells(sheets_.size());
    each([&](std::size_t s) { cells[s] = owned(s); });
    std::vector<Met> met(sheets_.size());
    each([&](std::size_t s) { met[s] = meetings(s); });
    each([&](std::size_t s) {
      DrawnSheet& sheet = sheets_[s];
      sheet.cell = std::move(cells[s]);
      sheet.node = std::move(met[s].node);
      sheet.moved = std::move(met[s].moved);
      add_continued_cells(sheet);
    });
    return std::move(sheets_);
  }

 private:
  struct Met {
    std::vector<Node> node;
    std::vector<Eigen::Vector3f> moved;
  };

  template <typename Use>
  void each(const Use& use) {
    pool_.for_ranges(sheets_.size(), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t s = begin; s < end; ++s) use(s);
    });
  }

  static DrawnSheet padded(const scene::Sheet& source, double spacing_m) {
    DrawnSheet sheet;
    sheet.side = source.side;
    sheet.axes = scene::SideAxes::of(source.side);
    sheet.first_u = source.first_u - kPad;
    sheet.first_v = source.first_v - kPad;
    sheet.nx = source.nx + 2 * kPad;
    sheet.ny = source.ny + 2 * kPad;
    const std::size_t count = static_cast<std::size_t>(sheet.nx) * static_cast<std::size_t>(sheet.ny);
    sheet.node.assign(count, Node::none);
    sheet.cell.assign(count, 0);
    sheet.height.assign(count, kNone);
    sheet.slope_u.assign(count, kNone);
    sheet.slope_v.assign(count, kNone);
    if (!source.texture_m.empty()) sheet.texture_m.assign(count, kNone);
    if (!source.curvature_per_m.empty()) sheet.bend_per_m.assign(count, kNone);
    if (!source.colour_rgba.empty()) sheet.colour_rgba.assign(count, 0);
    if (!source.intensity.empty()) sheet.intensity.assign(count, kNone);
    if (!source.error_m.empty()) sheet.error_m.assign(count, kNone);
    const double scale = 1.0 / spacing_m;
    for (int j = 0; j < source.ny; ++j)
      for (int i = 0; i < source.nx; ++i) {
        const std::size_t from = source.index(i, j), to = sheet.index(i + kPad, j + kPad);
        if (!source.measured(from)) continue;
        sheet.node[to] = Node::measured;
        sheet.cell[to] = (source.mask[from] & scene::Sheet::kCell) != 0 ? 1 : 0;
        sheet.height[to] = static_cast<float>(scale * static_cast<double>(source.height_m[from]));
        sheet.slope_u[to] = source.slope_u[from];
        sheet.slope_v[to] = source.slope_v[from];
        if (!source.texture_m.empty()) sheet.texture_m[to] = source.texture_m[from];
        if (!source.curvature_per_m.empty()) sheet.bend_per_m[to] = source.curvature_per_m[from];
        if (!source.colour_rgba.empty()) sheet.colour_rgba[to] = source.colour_rgba[from];
        if (!source.intensity.empty()) sheet.intensity[to] = source.intensity[from];
        if (!source.error_m.empty()) sheet.error_m[to] = source.error_m[from];
      }
    for (int ring = 0; ring < kRings; ++ring) add_ring(sheet);
    return sheet;
  }

  /// Calls use(value) for a node and the eight about it.
  template <typename Value, typename Use>
  static void about(const DrawnSheet& sheet, const std::vector<Value>& values, std::size_t node, const Use& use) {
    const auto nx = static_cast<std::ptrdiff_t>(sheet.nx);
    for (std::ptrdiff_t b = -1; b <= 1; ++b)
      for (std::ptrdiff_t a = -1; a <= 1; ++a)
        use(values[static_cast<std::size_t>(static_cast<std::ptrdiff_t>(node) + b * nx + a)]);
  }
  /// Of the nodes about a node that have a value.
  static float mean_about(const DrawnSheet& sheet, const std::vector<float>& values, std::size_t node) {
    float sum = 0.0F, count = 0.0F;
    about(sheet, values, node, [&](float value) {
      if (!std::isfinite(value)) return;
      sum += value;
      count += 1.0F;
    });
    return count > 0.0F ? sum / count : kNone;
  }
  static std::uint32_t colour_about(const DrawnSheet& sheet, std::size_t node) {
    ColourSum sum;
    about(sheet, sheet.colour_rgba, node, [&](std::uint32_t rgba) { sum.add(rgba); });
    return sum.mean();
  }

  /// One more node on every border, as the nodes beside it predict; none where they disagree.
  static void add_ring(DrawnSheet& sheet) {
    constexpr float kAgree = 2.0F;
    struct New {
      std::size_t node;
      float height, slope_u, slope_v;
    };
    std::vector<New> added;
    for (int j = 1; j + 1 < sheet.ny; ++j)
      for (int i = 1; i + 1 < sheet.nx; ++i) {
        const std::size_t k = sheet.index(i, j);
        if (std::isfinite(sheet.height[k])) continue;
        float height = 0.0F, su = 0.0F, sv = 0.0F, weight = 0.0F, low = 1e30F, high = -1e30F;
        for (int b = -1; b <= 1; ++b)
          for (int a = -1; a <= 1; ++a) {
            const std::size_t n = sheet.index(i + a, j + b);
            if (!std::isfinite(sheet.height[n])) continue;
            const float predicted =
                sheet.height[n] - static_cast<float>(a) * sheet.slope_u[n] - static_cast<float>(b) * sheet.slope_v[n];
            const float w = a != 0 && b != 0 ? 0.5F : 1.0F;
            height += w * predicted;
            su += w * sheet.slope_u[n];
            sv += w * sheet.slope_v[n];
            weight += w;
            low = std::min(low, predicted);
            high = std::max(high, predicted);
          }
        if (weight > 0.0F && high - low < kAgree) added.push_back({k, height / weight, su / weight, sv / weight});
      }
    for (const New& n : added) {
      for (std::vector<float>* values : {&sheet.texture_m, &sheet.bend_per_m, &sheet.intensity, &sheet.error_m})
        if (!values->empty()) (*values)[n.node] = mean_about(sheet, *values, n.node);
      if (!sheet.colour_rgba.empty()) sheet.colour_rgba[n.node] = colour_about(sheet, n.node);
      sheet.node[n.node] = Node::continued;
      sheet.height[n.node] = n.height;
      sheet.slope_u[n.node] = n.slope_u;
      sheet.slope_v[n.node] = n.slope_v;
    }
  }

  /// Calls use(other sheet's number, its chart frame place) for each sheet but `s` that is near a place.
  template <typename Use>
  void others(std::size_t s, const Eigen::Vector3d& place, const Use& use) const {
    for (std::size_t side = 0; side < scene::kSides; ++side) {
      const Eigen::Vector3d there = scene::SideAxes::of(static_cast<scene::Side>(side)).to_chart(place);
      for (const std::uint32_t other : index_[side].near(there.x(), there.y()))
        if (other != s) use(other, there);
    }
  }

  /// True where `other` has measured the same surface at a place.
  [[nodiscard]] bool has(std::uint32_t other, const Eigen::Vector3d& there, const Eigen::Vector3d& normal) const {
    const DrawnSheet& sheet = sheets_[other];
    const auto found = surface_at(sheet, there.x(), there.y(), false);
    if (!found) return false;
    const double facing = sheet.axes.sign * normal[sheet.axes.w];
    return std::abs(there.z() - found->height) * std::max(facing, 0.0) < kSame &&
           sheet.normal(found->node).dot(normal) > kSameCosine;
  }

  /// Cells of sheet `s`, 2 where they are drawn.
  [[nodiscard]] std::vector<std::uint8_t> owned(std::size_t s) const {
    const DrawnSheet& sheet = sheets_[s];
    std::vector<std::uint8_t> cell = sheet.cell;
    std::array<std::uint32_t, 8> rivals{};
    for (int j = 0; j + 1 < sheet.ny; ++j)
      for (int i = 0; i + 1 < sheet.nx; ++i) {
        const std::size_t k = sheet.index(i, j);
        if (cell[k] == 0) continue;
        cell[k] = 2;
        const std::array<std::array<int, 2>, 4> corners{{{i, j}, {i + 1, j}, {i, j + 1}, {i + 1, j + 1}}};
        Eigen::Vector3d middle = Eigen::Vector3d::Zero(), mean = Eigen::Vector3d::Zero();
        for (const auto& c : corners) {
          middle += 0.25 * sheet.place(c[0], c[1]);
          mean += sheet.normal(sheet.index(c[0], c[1]));
        }
        mean.normalize();
        std::size_t count = 0;
        others(s, middle, [&](std::uint32_t other, const Eigen::Vector3d& there) {
          const scene::SideAxes& axes = sheets_[other].axes;
          const bool better = axes.sign * mean[axes.w] > sheet.axes.sign * mean[sheet.axes.w] + kMargin;
          if (better && count < rivals.size() && has(other, there, mean)) rivals[count++] = other;
        });
        const auto has_all = [&](std::uint32_t other) {
          const scene::SideAxes& axes = sheets_[other].axes;
          return std::ranges::all_of(corners, [&](const std::array<int, 2>& c) {
            const Eigen::Vector3d normal = sheet.normal(sheet.index(c[0], c[1]));
            return axes.sign * normal[axes.w] > sheet.axes.sign * normal[sheet.axes.w] + kMargin &&
                   has(other, axes.to_chart(sheet.place(c[0], c[1])), normal);
          });
        };
        if (std::any_of(rivals.begin(), rivals.begin() + static_cast<std::ptrdiff_t>(count), has_all)) cell[k] = 1;
      }
    return cell;
  }

  /// The share of the way between two places at which it comes to another sheet; nothing where it does not.
  [[nodiscard]] std::optional<double> meets(std::size_t s, const Eigen::Vector3d& from,
                                            const Eigen::Vector3d& to) const {
    constexpr double kMost = 3.5;  // spacings along the other sheet's side that either end may be away from it
    std::optional<double> first;
    others(s, 0.5 * (from + to), [&](std::uint32_t other, const Eigen::Vector3d&) {
      const DrawnSheet& sheet = sheets_[other];
      const Eigen::Vector3d a = sheet.axes.to_chart(from), b = sheet.axes.to_chart(to);
      const auto at_a = surface_at(sheet, a.x(), a.y(), true), at_b = surface_at(sheet, b.x(), b.y(), true);
      if (!at_a || !at_b) return;
      const double over_a = a.z() - at_a->height, over_b = b.z() - at_b->height;
      if ((over_a > 0.0) == (over_b > 0.0) || std::abs(over_a) > kMost || std::abs(over_b) > kMost) return;
      const double share = over_a / (over_a - over_b);
      if (!first || share < *first) first = share;
    });
    return first;
  }

  /// True where another sheet goes on over the border: nothing need be continued there.
  [[nodiscard]] bool goes_on(std::size_t s, int i, int j) const {
    const DrawnSheet& sheet = sheets_[s];
    const Eigen::Vector3d place = sheet.place(i, j), normal = sheet.normal(sheet.index(i, j));
    bool any = false;
    others(s, place,
           [&](std::uint32_t other, const Eigen::Vector3d& there) { any = any || has(other, there, normal); });
    return any;
  }

  [[nodiscard]] Met meetings(std::size_t s) const {
    const DrawnSheet& sheet = sheets_[s];
    const std::size_t count = sheet.node.size();
    std::vector<Node> node(count, Node::none);
    std::unordered_map<std::size_t, Eigen::Vector3f> moved;
    std::unordered_map<std::size_t, std::size_t> parents;
    for (std::size_t k = 0; k < count; ++k)
      if (sheet.node[k] == Node::measured) node[k] = Node::measured;
    for (int ring = 0; ring < kRings; ++ring) {
      std::vector<std::pair<std::size_t, Node>> news;
      for (int j = 1; j + 1 < sheet.ny; ++j)
        for (int i = 1; i + 1 < sheet.nx; ++i) {
          const std::size_t k = sheet.index(i, j);
          if (node[k] != Node::none || sheet.node[k] != Node::continued) continue;
          std::optional<std::array<int, 2>> parent;
          int nearest = 3;
          for (int b = -1; b <= 1; ++b)
            for (int a = -1; a <= 1; ++a) {
              const std::size_t n = sheet.index(i + a, j + b);
              const bool from_there = node[n] == Node::continued || (ring == 0 && node[n] == Node::measured);
              if (!from_there || a * a + b * b >= nearest) continue;
              if (node[n] == Node::measured && goes_on(s, i + a, j + b)) continue;
              nearest = a * a + b * b;
              parent = {i + a, j + b};
            }
          if (!parent) continue;
          parents[k] = sheet.index((*parent)[0], (*parent)[1]);
          const Eigen::Vector3d from = sheet.place((*parent)[0], (*parent)[1]), to = sheet.place(i, j);
          if (const auto share = meets(s, from, to)) {
            moved[k] = (from + *share * (to - from)).cast<float>();
            news.emplace_back(k, Node::met);
          } else {
            news.emplace_back(k, Node::continued);
          }
        }
      for (const auto& [k, kind] : news) node[k] = kind;
    }
    // What leads to no other sheet is not drawn.
    std::vector<std::uint8_t> leads(count, 0);
    for (const auto& [k, place] : moved)
      for (std::size_t from = parents[k]; node[from] == Node::continued && leads[from] == 0; from = parents[from])
        leads[from] = 1;
    for (std::size_t k = 0; k < count; ++k)
      if (node[k] == Node::continued && leads[k] == 0) node[k] = Node::none;
    close_holes(sheet, node);
    Met met;
    for (std::size_t k = 0; k < count; ++k)
      if (node[k] == Node::met) met.moved.push_back(moved[k]);
    met.node = std::move(node);
    return met;
  }

  /// Nodes in holes of few nodes around which the sheet has been measured.
  static void close_holes(const DrawnSheet& sheet, std::vector<Node>& node) {
    constexpr std::size_t kMost = 9;
    std::vector<std::uint8_t> seen(node.size(), 0);
    std::vector<std::size_t> hole;
    for (std::size_t start = 0; start < node.size(); ++start) {
      if (seen[start] != 0 || sheet.node[start] == Node::measured || !std::isfinite(sheet.height[start])) continue;
      hole.assign(1, start);
      seen[start] = 1;
      bool whole = true;
      for (std::size_t n = 0; n < hole.size(); ++n) {
        const int i = static_cast<int>(hole[n] % static_cast<std::size_t>(sheet.nx));
        const int j = static_cast<int>(hole[n] / static_cast<std::size_t>(sheet.nx));
        whole = whole && std::isfinite(sheet.height[hole[n]]);
        for (int b = std::max(j - 1, 0); b <= std::min(j + 1, sheet.ny - 1); ++b)
          for (int a = std::max(i - 1, 0); a <= std::min(i + 1, sheet.nx - 1); ++a) {
            const std::size_t k = sheet.index(a, b);
            if (seen[k] != 0 || sheet.node[k] == Node::measured) continue;
            seen[k] = 1;
            hole.push_back(k);
          }
      }
      if (!whole || hole.size() > kMost) continue;
      for (const std::size_t k : hole) node[k] = Node::closed;
    }
  }

  /// Cells between what was measured and what the continuation has met, and those of closed holes.
  static void add_continued_cells(DrawnSheet& sheet) {
    for (int j = 0; j + 1 < sheet.ny; ++j)
      for (int i = 0; i + 1 < sheet.nx; ++i) {
        const std::size_t k = sheet.index(i, j), up = k + static_cast<std::size_t>(sheet.nx);
        if (sheet.cell[k] != 0) continue;
        bool whole = true, all_measured = true;
        for (const std::size_t c : {k, k + 1, up, up + 1}) {
          whole = whole && sheet.node[c] != Node::none;
          all_measured = all_measured && sheet.node[c] == Node::measured;
        }
        if (whole && !all_measured) sheet.cell[k] = 3;
      }
  }

  ThreadPool& pool_;
  std::vector<DrawnSheet> sheets_;
  std::array<SideIndex, scene::kSides> index_;
};

}  // namespace

std::vector<DrawnSheet> drawn_sheets(const scene::Charts& charts, ThreadPool& pool) {
  return Drawing(charts, pool).run();
}

}  // namespace sparsha::viewer
