// Rows between corners for the even-odd rule (Preparata & Shamos 1985, slabs), a tree of boxes for distances.
#include "scene/area/polygon.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <utility>

namespace sparsha::scene {
namespace {

constexpr std::uint32_t kFew = 8;       // edges that are looked through one by one
constexpr std::uint32_t kLeaf = 4;      // edges
constexpr double kSameCrossing = 1e-9;  // of the polygon's size: edges that meet in a corner do not cross

double squared_to_box(const std::array<double, 4>& box, double x, double y) noexcept {
  const double dx = std::max({box[0] - x, 0.0, x - box[2]});
  const double dy = std::max({box[1] - y, 0.0, y - box[3]});
  return dx * dx + dy * dy;
}

}  // namespace

double signed_area_m2(const std::vector<std::array<double, 2>>& corners_m) {
  double area_m2 = 0.0;
  // Relative to the first corner: coordinates may be millions of metres.
  for (std::size_t i = 2; i < corners_m.size(); ++i) {
    const auto& a = corners_m[i - 1];
    const auto& b = corners_m[i];
    const auto& o = corners_m[0];
    area_m2 += 0.5 * ((a[0] - o[0]) * (b[1] - o[1]) - (b[0] - o[0]) * (a[1] - o[1]));
  }
  return area_m2;
}

double Polygon::crossing_m(const Edge& edge, double y_m) noexcept {
  return (edge.bx - edge.ax) * (y_m - edge.ay) / (edge.by - edge.ay) + edge.ax;
}

Polygon::Polygon(std::vector<std::array<double, 2>> corners_m) : corners_m_(std::move(corners_m)) {
  if (corners_m_.size() < 3) return;
  bounds_m_ = {corners_m_[0][0], corners_m_[0][1], corners_m_[0][0], corners_m_[0][1]};
  for (std::size_t i = 0, j = corners_m_.size() - 1; i < corners_m_.size(); j = i++) {
    const auto& a = corners_m_[i];
    const auto& b = corners_m_[j];
    bounds_m_ = {std::min(bounds_m_[0], a[0]), std::min(bounds_m_[1], a[1]), std::max(bounds_m_[2], a[0]),
                 std::max(bounds_m_[3], a[1])};
    if (a == b) continue;
    const double squared_m2 = (b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]);
    edges_.push_back({a[0], a[1], b[0], b[1], squared_m2 > 0.0 ? 1.0 / squared_m2 : 0.0});
    heights_m_.push_back(a[1]);
    heights_m_.push_back(b[1]);
  }
  leave_out_pairs();
  if (edges_.empty()) return;
  make_rows();
  make_tree();
  find_deepest();
}

// There and back, as to a hole and out of it: on both sides of such edges is the same, and they are no border.
void Polygon::leave_out_pairs() {
  std::map<std::array<double, 4>, int> times;
  const auto key = [](const Edge& edge) {
    const bool forwards = std::array{edge.ax, edge.ay} < std::array{edge.bx, edge.by};
    return forwards ? std::array{edge.ax, edge.ay, edge.bx, edge.by} : std::array{edge.bx, edge.by, edge.ax, edge.ay};
  };
  for (const Edge& edge : edges_) ++times[key(edge)];
  std::erase_if(edges_, [&](const Edge& edge) {
    int& left = times[key(edge)];
    if (left % 2 == 1) return std::exchange(left, 0) == 0;  // one of them stays
    return true;
  });
}

void Polygon::make_rows() {
  std::sort(heights_m_.begin(), heights_m_.end());
  heights_m_.erase(std::unique(heights_m_.begin(), heights_m_.end()), heights_m_.end());
  const double same_m = kSameCrossing * std::max(bounds_m_[2] - bounds_m_[0], bounds_m_[3] - bounds_m_[1]);
  std::vector<std::pair<double, std::uint32_t>> found;
  for (std::size_t row = 0; row + 1 < heights_m_.size(); ++row) {
    const double low_m = heights_m_[row];
    const double high_m = heights_m_[row + 1];
    found.clear();
    for (std::uint32_t e = 0; e < edges_.size(); ++e) {
      const Edge& edge = edges_[e];
      if (std::min(edge.ay, edge.by) <= low_m && std::max(edge.ay, edge.by) >= high_m)
        found.emplace_back(crossing_m(edge, low_m + 0.5 * (high_m - low_m)), e);
    }
    std::sort(found.begin(), found.end());
    Row made{static_cast<std::uint32_t>(row_edges_.size()), static_cast<std::uint32_t>(found.size()), true};
    for (std::size_t k = 0; k < found.size(); ++k) {
      row_edges_.push_back(found[k].second);
      if (k == 0) continue;
      const Edge& left = edges_[found[k - 1].second];
      const Edge& right = edges_[found[k].second];
      made.sorted = made.sorted && crossing_m(left, low_m) <= crossing_m(right, low_m) + same_m &&
                    crossing_m(left, high_m) <= crossing_m(right, high_m) + same_m;
    }
    if (!made.sorted && made.count > kFew) put_in_order(made, low_m, high_m);
    rows_.push_back(made);
  }
}

// Rows are low where there are many corners, so that most edges hardly move within one; the others are apart.
void Polygon::put_in_order(Row& row, double low_m, double high_m) {
  const auto begin = row_edges_.begin() + row.first;
  const auto half_m = [&](std::uint32_t e) {
    return 0.5 * std::abs(crossing_m(edges_[e], high_m) - crossing_m(edges_[e], low_m));
  };
  // Those that move the farthest, otherwise in the order that they have.
  std::stable_sort(begin, begin + row.count, [&](std::uint32_t a, std::uint32_t b) { return half_m(a) > half_m(b); });
  row.loose = kFew;
  row.reach_m = half_m(row_edges_[row.first + kFew]);
  const double middle_m = low_m + 0.5 * (high_m - low_m);
  std::stable_sort(begin + kFew, begin + row.count, [&](std::uint32_t a, std::uint32_t b) {
    return crossing_m(edges_[a], middle_m) < crossing_m(edges_[b], middle_m);
  });
  constexpr double kRounding = 1e-9;
  row.reach_m += kRounding * (bounds_m_[2] - bounds_m_[0]);
}

bool Polygon::holds_among(const Row& row, double x_m, double y_m, double middle_m) const noexcept {
  const auto begin = row_edges_.begin() + row.first;
  const auto end = begin + row.count;
  const auto left_of = [&](std::uint32_t e, double limit_m) { return crossing_m(edges_[e], middle_m) < limit_m; };
  const auto near = std::lower_bound(begin + row.loose, end, x_m - row.reach_m, left_of);
  const auto beyond = std::lower_bound(near, end, x_m + row.reach_m, left_of);
  bool inside = (end - beyond) % 2 == 1;
  const auto count = [&](auto first, auto last) {
    for (; first != last; ++first) inside = inside != (x_m < crossing_m(edges_[*first], y_m));
  };
  count(begin, begin + row.loose);
  count(near, beyond);
  return inside;
}

// Long edges are cut: the boxes of many would all be one upon the other.
void Polygon::make_tree() {
  constexpr double kLongest = 1.0 / 16.0;  // of the polygon's longer side
  const double longest_m = kLongest * std::max(bounds_m_[2] - bounds_m_[0], bounds_m_[3] - bounds_m_[1]);
  std::vector<Piece> pieces;
  for (std::uint32_t e = 0; e < edges_.size(); ++e) {
    const Edge& edge = edges_[e];
    const double length_m = std::hypot(edge.bx - edge.ax, edge.by - edge.ay);
    const int count = edges_.size() > 2 * kFew ? std::max(1, static_cast<int>(std::ceil(length_m / longest_m))) : 1;
    const auto at = [&](int k) {
      const double share = static_cast<double>(k) / count;
      return std::array{edge.ax + share * (edge.bx - edge.ax), edge.ay + share * (edge.by - edge.ay)};
    };
    for (int k = 0; k < count; ++k) {
      const auto a = at(k);
      const auto b = k + 1 < count ? at(k + 1) : std::array{edge.bx, edge.by};
      pieces.push_back({{std::min(a[0], b[0]), std::min(a[1], b[1]), std::max(a[0], b[0]), std::max(a[1], b[1])}, e});
    }
  }
  make_nodes(pieces, 0, static_cast<std::uint32_t>(pieces.size()));
  for (const Piece& piece : pieces) node_edges_.push_back(piece.edge);
}

std::uint32_t Polygon::make_nodes(std::vector<Piece>& pieces, std::uint32_t first, std::uint32_t count) {
  const auto index = static_cast<std::uint32_t>(nodes_.size());
  constexpr double kFar = std::numeric_limits<double>::infinity();
  Node node{{kFar, kFar, -kFar, -kFar}, first, 0, 0};
  for (std::uint32_t k = first; k < first + count; ++k) {
    const std::array<double, 4>& box = pieces[k].box_m;
    node.box_m = {std::min(node.box_m[0], box[0]), std::min(node.box_m[1], box[1]), std::max(node.box_m[2], box[2]),
                  std::max(node.box_m[3], box[3])};
  }
  nodes_.push_back(node);
  if (count <= kLeaf) {
    nodes_[index].count = count;
    return index;
  }
  const std::size_t axis = node.box_m[2] - node.box_m[0] >= node.box_m[3] - node.box_m[1] ? 0 : 1;
  const auto begin = pieces.begin() + first;
  const auto middle = [axis](const Piece& piece) { return piece.box_m[axis] + piece.box_m[axis + 2]; };
  std::nth_element(begin, begin + count / 2, begin + count, [&](const Piece& a, const Piece& b) {
    return std::pair(middle(a), a.edge) < std::pair(middle(b), b.edge);
  });
  make_nodes(pieces, first, count / 2);
  const std::uint32_t right = make_nodes(pieces, first + count / 2, count - count / 2);
  nodes_[index].right = right;
  return index;
}

void Polygon::find_deepest() {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  constexpr std::size_t kManyRows = 100;
  const std::vector<double> shares = rows_.size() > kManyRows ? std::vector{0.5} : std::vector{0.25, 0.5, 0.75};
  std::vector<double> crossings;
  double depth_m = 0.0;
  for (std::size_t row = 0; row < rows_.size(); ++row)
    for (const double share : shares) {
      const double y_m = heights_m_[row] + share * (heights_m_[row + 1] - heights_m_[row]);
      crossings.clear();
      for (std::uint32_t k = 0; k < rows_[row].count; ++k)
        crossings.push_back(crossing_m(edges_[row_edges_[rows_[row].first + k]], y_m));
      std::sort(crossings.begin(), crossings.end());
      double widest_m = 0.0;
      double x_m = 0.0;
      for (std::size_t k = 0; k + 1 < crossings.size(); k += 2)
        if (crossings[k + 1] - crossings[k] > widest_m) {
          widest_m = crossings[k + 1] - crossings[k];
          x_m = crossings[k] + 0.5 * widest_m;
        }
      if (!(widest_m > 0.0) || !holds(x_m, y_m)) continue;
      const double here_m = to_border_m(x_m, y_m, kFar);
      if (deepest_m_ && !(here_m > depth_m)) continue;
      depth_m = here_m;
      deepest_m_ = {x_m, y_m};
    }
}

bool Polygon::holds(double x_m, double y_m) const noexcept {
  if (rows_.empty() || !(x_m >= bounds_m_[0] && x_m <= bounds_m_[2])) return false;
  if (!(y_m >= heights_m_.front() && y_m < heights_m_.back())) return false;
  const auto above = std::upper_bound(heights_m_.begin(), heights_m_.end(), y_m);
  const Row& row = rows_[static_cast<std::size_t>(above - heights_m_.begin()) - 1];
  if (row.loose > 0) {
    const double low_m = *(above - 1);
    return holds_among(row, x_m, y_m, low_m + 0.5 * (*above - low_m));
  }
  const auto crosses_right = [&](std::uint32_t k) { return x_m < crossing_m(edges_[row_edges_[row.first + k]], y_m); };
  if (row.count > kFew && row.sorted) {
    std::uint32_t first = 0;
    std::uint32_t last = row.count;
    while (first < last) {
      const std::uint32_t middle = (first + last) / 2;
      if (crosses_right(middle))
        last = middle;
      else
        first = middle + 1;
    }
    return (row.count - first) % 2 == 1;
  }
  bool inside = false;
  for (std::uint32_t k = 0; k < row.count; ++k) inside = inside != crosses_right(k);
  return inside;
}

double Polygon::to_border_m(double x_m, double y_m, double farthest_m) const noexcept {
  const double limit_m2 = farthest_m * farthest_m;
  double nearest_m2 = limit_m2;
  constexpr std::size_t kDeepest = 64;  // a tree of 2^32 edges is half as deep
  std::array<std::uint32_t, kDeepest> waiting{};
  std::size_t count = nodes_.empty() ? 0 : 1;
  while (count > 0) {
    const std::uint32_t index = waiting[--count];
    const Node& node = nodes_[index];
    if (!(squared_to_box(node.box_m, x_m, y_m) < nearest_m2)) continue;
    if (node.count == 0) {
      const std::uint32_t left = index + 1;
      const bool left_first =
          squared_to_box(nodes_[left].box_m, x_m, y_m) <= squared_to_box(nodes_[node.right].box_m, x_m, y_m);
      waiting[count++] = left_first ? node.right : left;
      waiting[count++] = left_first ? left : node.right;
      continue;
    }
    for (std::uint32_t k = node.first; k < node.first + node.count; ++k) {
      const Edge& edge = edges_[node_edges_[k]];
      const double along_x = edge.bx - edge.ax;
      const double along_y = edge.by - edge.ay;
      const double share =
          std::clamp(((x_m - edge.ax) * along_x + (y_m - edge.ay) * along_y) * edge.inverse_per_m2, 0.0, 1.0);
      const double dx = x_m - edge.ax - share * along_x;
      const double dy = y_m - edge.ay - share * along_y;
      nearest_m2 = std::min(nearest_m2, dx * dx + dy * dy);
    }
  }
  return nearest_m2 < limit_m2 ? std::sqrt(nearest_m2) : farthest_m;
}

}  // namespace sparsha::scene
