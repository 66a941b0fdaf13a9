#include "scene/ground/contours.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

namespace sparsha::scene {
namespace {

constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

/// The edges of a lattice, what crosses them and how cells join the crossings.
class Net {
 public:
  Net(int nx, int ny, const Crossing& crossing) : nx_(nx), ny_(ny), links_(2 * count(), {kNone, kNone}) {
    at_.reserve(2 * count());
    for (const bool up : {false, true})
      for (int j = 0; j < ny; ++j)
        for (int i = 0; i < nx; ++i) {
          const bool inside = up ? j + 1 < ny : i + 1 < nx;
          at_.push_back(inside ? crossing(i, j, up) : std::numeric_limits<double>::quiet_NaN());
        }
    for (int j = 0; j + 1 < ny; ++j)
      for (int i = 0; i + 1 < nx; ++i) join(i, j);
  }

  [[nodiscard]] std::vector<Contour> lines() {
    std::vector<Contour> found;
    seen_.assign(at_.size(), false);
    for (const bool open : {true, false})
      for (std::size_t edge = 0; edge < at_.size(); ++edge) {
        const bool linked = links_[edge][0] != kNone;
        const bool end = linked && links_[edge][1] == kNone;
        if (linked && !seen_[edge] && (end || !open)) found.push_back(follow(edge));
      }
    return found;
  }

 private:
  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_); }
  [[nodiscard]] std::size_t edge(int i, int j, bool up) const {
    return (up ? count() : 0) + static_cast<std::size_t>(j) * static_cast<std::size_t>(nx_) +
           static_cast<std::size_t>(i);
  }
  [[nodiscard]] bool crossed(std::size_t edge) const { return !std::isnan(at_[edge]); }

  void link(std::size_t a, std::size_t b) {
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)})
      links_[from][links_[from][0] == kNone ? 0 : 1] = to;
  }

  void join(int i, int j) {
    const std::array<std::size_t, 4> edges{edge(i, j, false), edge(i, j, true), edge(i + 1, j, true),
                                           edge(i, j + 1, false)};  // bottom, left, right, top
    std::array<std::size_t, 4> found{};
    std::size_t crossings = 0;
    for (const std::size_t e : edges)
      if (crossed(e)) found[crossings++] = e;
    if (crossings >= 2) link(found[0], found[1]);
    if (crossings == 4) link(found[2], found[3]);
  }

  [[nodiscard]] Eigen::Vector2d place(std::size_t edge) const {
    const bool up = edge >= count();
    const std::size_t node = up ? edge - count() : edge;
    const Eigen::Vector2d from(static_cast<double>(node % static_cast<std::size_t>(nx_)),
                               static_cast<double>(node / static_cast<std::size_t>(nx_)));
    return from + at_[edge] * (up ? Eigen::Vector2d::UnitY() : Eigen::Vector2d::UnitX());
  }

  Contour follow(std::size_t first) {
    Contour line;
    std::size_t last = kNone;
    std::size_t here = first;
    while (here != kNone && !seen_[here]) {
      seen_[here] = true;
      line.points.push_back(place(here));
      const std::size_t next = links_[here][0] != last ? links_[here][0] : links_[here][1];
      last = std::exchange(here, next);
    }
    if (here == first && line.points.size() > 2) line.points.push_back(line.points.front());
    return line;
  }

  int nx_;
  int ny_;
  std::vector<double> at_;
  std::vector<std::array<std::size_t, 2>> links_;
  std::vector<bool> seen_;
};

double distance_to(const Eigen::Vector2d& point, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d way = b - a;
  const double squared = way.squaredNorm();
  const double share = squared > 0.0 ? std::clamp((point - a).dot(way) / squared, 0.0, 1.0) : 0.0;
  return (point - a - share * way).norm();
}

}  // namespace

double zero_between(double a, double b) {
  if ((a > 0.0) == (b > 0.0) || a == b) return std::numeric_limits<double>::quiet_NaN();
  return std::clamp(a / (a - b), 0.0, 1.0);
}

double Contour::length() const {
  double sum = 0.0;
  for (std::size_t k = 1; k < points.size(); ++k) sum += (points[k] - points[k - 1]).norm();
  return sum;
}

std::vector<Contour> trace_contours(int nx, int ny, const Crossing& crossing) { return Net(nx, ny, crossing).lines(); }

void smooth(Contour& contour, int passes) {
  std::vector<Eigen::Vector2d>& points = contour.points;
  const std::size_t count = points.size();
  if (count < 3) return;
  const bool closed = contour.closed();
  for (int pass = 0; pass < passes; ++pass) {
    const std::vector<Eigen::Vector2d> before = points;
    for (std::size_t k = 1; k + 1 < count; ++k)
      points[k] = 0.25 * before[k - 1] + 0.5 * before[k] + 0.25 * before[k + 1];
    if (!closed) continue;
    points.front() = 0.25 * before[count - 2] + 0.5 * before[0] + 0.25 * before[1];
    points.back() = points.front();
  }
}

void simplify(Contour& contour, double tolerance) {
  std::vector<Eigen::Vector2d>& points = contour.points;
  if (points.size() < 3) return;
  std::vector<bool> kept(points.size(), false);
  kept.front() = kept.back() = true;
  std::vector<std::pair<std::size_t, std::size_t>> runs;
  if (contour.closed()) {
    kept[points.size() / 2] = true;
    runs = {{0, points.size() / 2}, {points.size() / 2, points.size() - 1}};
  } else {
    runs = {{0, points.size() - 1}};
  }
  while (!runs.empty()) {
    const auto [from, to] = runs.back();
    runs.pop_back();
    double most = tolerance;
    std::size_t farthest = from;
    for (std::size_t k = from + 1; k < to; ++k)
      if (const double off = distance_to(points[k], points[from], points[to]); off > most) {
        most = off;
        farthest = k;
      }
    if (farthest == from) continue;
    kept[farthest] = true;
    runs.emplace_back(from, farthest);
    runs.emplace_back(farthest, to);
  }
  std::vector<Eigen::Vector2d> left;
  for (std::size_t k = 0; k < points.size(); ++k)
    if (kept[k]) left.push_back(points[k]);
  points = std::move(left);
}

}  // namespace sparsha::scene
