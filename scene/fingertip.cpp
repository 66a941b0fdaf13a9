#include "scene/fingertip.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace sparsha::pipeline {
namespace {

/// One cell in cells: f = z + a s + b t + c s t.
struct Cell {
  double z, a, b, c;
};

/// The ball over one cell. Its centre stands over a node that lies (x, y) before the cell's first node.
class Climb {
 public:
  Climb(const Cell& cell, double radius, double x, double y) noexcept
      : cell_(cell), squared_(radius * radius), x_(x), y_(y) {}

  /// The largest f + sqrt(radius^2 - |d|^2) uphill of (s, t). For a fixed t that is a closed form in s and the other
  /// way round; both in turn climb to the top.
  [[nodiscard]] double from(double s, double t) const noexcept {
    constexpr int kTurns = 60;
    constexpr double kStill = 1e-8;  // cells
    double best = value(s, t);
    for (int k = 0; k < kTurns; ++k) {
      s = top(cell_.a + cell_.c * t, y_ + t, x_);
      t = top(cell_.b + cell_.c * s, x_ + s, y_);
      const double here = value(s, t);
      if (!(here > best + kStill)) return std::max(best, here);
      best = here;
    }
    return best;
  }

 private:
  /// Where a slope is highest under the ball at the distance `across`.
  [[nodiscard]] double top(double slope, double across, double begin) const noexcept {
    const double chord = std::max(0.0, squared_ - across * across);
    return std::clamp(slope * std::sqrt(chord / (1.0 + slope * slope)) - begin, 0.0, 1.0);
  }
  [[nodiscard]] double value(double s, double t) const noexcept {
    const double squared = squared_ - (x_ + s) * (x_ + s) - (y_ + t) * (y_ + t);
    return cell_.z + s * cell_.a + t * (cell_.b + s * cell_.c) + (squared > 0.0 ? std::sqrt(squared) : -1e300);
  }

  const Cell& cell_;
  double squared_;
  double x_;
  double y_;
};

[[nodiscard]] int floor_of(double x) noexcept {
  const int whole = static_cast<int>(x);
  return whole - (x < whole ? 1 : 0);
}

/// The nodes from which a ball touches what lies between `begin` and `begin` + 1 at an offset of `low` to `high`.
struct Nodes {
  int first, last;
  Nodes(int begin, double low, double high, int count) noexcept
      : first(std::max(0, begin - floor_of(high + kRounding))),
        last(std::min(count - 1, begin + floor_of(1.0 - low + kRounding))) {}

 private:
  static constexpr double kRounding = 1e-9;
};

/// A ball touches a node, an edge or the inside of a cell. Nodes are looked at from the ball's side; edges and cells
/// know by their slope from which nodes they are touched, mostly one each.
class Dilation {
 public:
  Dilation(std::vector<float>& height, int nx, int ny, double spacing, double radius)
      : height_(height), nx_(nx), ny_(ny), unit_(spacing), radius_(radius / spacing) {
    const double per_unit = 1.0 / spacing;
    low_.reserve(height.size());
    for (const float z : height) low_.push_back(static_cast<double>(z) * per_unit);
    best_ = low_;
    for (double& best : best_) best += radius_;
    reach_ = static_cast<int>(std::floor(radius_));
    for (int d = 0; d <= reach_; ++d)
      chord_.push_back(std::sqrt(std::max(0.0, radius_ * radius_ - static_cast<double>(d) * d)));
  }

  void run() {
    for (int dj = -reach_; dj <= reach_; ++dj)
      for (int di = -reach_; di <= reach_; ++di)
        if (di != 0 || dj != 0) take_nodes(di, dj);
    for (int j = 0; j < ny_; ++j)
      for (int i = 0; i < nx_; ++i) {
        if (i + 1 < nx_) take_edge(i, low_[index(i + 1, j)] - low_[index(i, j)], 1, nx_, j, ny_, nx_);
        if (j + 1 < ny_) take_edge(j, low_[index(i, j + 1)] - low_[index(i, j)], nx_, ny_, i, nx_, 1);
      }
    for (int j = 0; j + 1 < ny_; ++j)
      for (int i = 0; i + 1 < nx_; ++i) take_cell(i, j);
    for (std::size_t node = 0; node < low_.size(); ++node)
      height_[node] = static_cast<float>((best_[node] - radius_) * unit_);
  }

 private:
  [[nodiscard]] std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(i);
  }
  static void raise(double& best, double value) { best = std::max(best, value); }

  void take_nodes(int di, int dj) {
    const double squared = radius_ * radius_ - static_cast<double>(di * di + dj * dj);
    if (!(squared > 0.0)) return;
    const double cap = std::sqrt(squared);
    const int end = std::min(nx_, nx_ - di);
    for (int j = std::max(0, -dj); j < std::min(ny_, ny_ - dj); ++j) {
      double* best = best_.data() + index(0, j);
      const double* other = low_.data() + index(0, j + dj);
      for (int i = std::max(0, -di); i < end; ++i) best[i] = std::max(best[i], other[i + di] + cap);
    }
  }

  /// The edge from `at` on along its axis, in the row (or column) `row` of `rows`. At a distance of d rows its highest
  /// place is chord slope / sqrt(1 + slope^2) from below the centre, and the centre's height a closed form.
  void take_edge(int at, double slope, int step, int count, int row, int rows, int row_step) {
    const double length = std::sqrt(1.0 + slope * slope);
    const double z = low_[static_cast<std::size_t>(at) * static_cast<std::size_t>(step) +
                          static_cast<std::size_t>(row) * static_cast<std::size_t>(row_step)];
    for (int d = -reach_; d <= reach_; ++d) {
      const int other = row + d;
      if (other < 0 || other >= rows) continue;
      const double chord = chord_[static_cast<std::size_t>(std::abs(d))];
      const double offset = chord * slope / length;
      for (Nodes nodes(at, offset, offset, count); nodes.first <= nodes.last; ++nodes.first)
        raise(best_[static_cast<std::size_t>(nodes.first) * static_cast<std::size_t>(step) +
                    static_cast<std::size_t>(other) * static_cast<std::size_t>(row_step)],
              z + slope * (nodes.first - at) + chord * length);
    }
  }

  void take_cell(int i, int j) {
    const double* low = low_.data() + index(i, j);
    const double* high = low + nx_;
    const Cell cell{low[0], low[1] - low[0], high[0] - low[0], (high[1] - high[0]) - (low[1] - low[0])};
    // The plane of the middle's slopes, from which the patch is never farther than a quarter of its twist.
    const double a = cell.a + 0.5 * cell.c;
    const double b = cell.b + 0.5 * cell.c;
    const double length = std::sqrt(1.0 + a * a + b * b);
    // The offset of the contact changes no faster with the slopes than by the radius.
    const double at_x = radius_ * a / length;
    const double at_y = radius_ * b / length;
    const double play = 0.5 * std::numbers::sqrt2 * radius_ * std::abs(cell.c);
    const Nodes columns(i, at_x - play, at_x + play, nx_);
    const Nodes rows(j, at_y - play, at_y + play, ny_);
    const double level = cell.z - 0.25 * cell.c;
    for (int nj = rows.first; nj <= rows.last; ++nj)
      for (int ni = columns.first; ni <= columns.last; ++ni) {
        const double bound = level + a * (ni - i) + b * (nj - j) + radius_ * length + 0.25 * std::abs(cell.c);
        double& best = best_[index(ni, nj)];
        if (bound > best + kFine) raise(best, top_of(cell, i - ni, j - nj, at_x, at_y));
      }
  }

  /// The patch's own top, where its normal points at the ball's centre: little twist, few steps. A top beyond the cell
  /// is none; the edges have it.
  [[nodiscard]] double flat_top(const Cell& cell, double x, double y, double at_x, double at_y) const {
    constexpr int kSteps = 16;
    double s = at_x - x;
    double t = at_y - y;
    double cap = radius_;  // of the centre over the contact
    for (int k = 0; k < kSteps; ++k) {
      const double a = cell.a + cell.c * t;
      const double b = cell.b + cell.c * s;
      cap = radius_ / std::sqrt(1.0 + a * a + b * b);
      const double s_before = s;
      const double t_before = t;
      s = cap * a - x;
      t = cap * b - y;
      if (std::abs(s - s_before) + std::abs(t - t_before) < kNear) break;
    }
    if (!(s >= 0.0 && s <= 1.0 && t >= 0.0 && t <= 1.0)) return -1e300;
    return cell.z + s * cell.a + t * (cell.b + s * cell.c) + cap;
  }

  /// From the place where the middle's plane is touched; a saddle sharper than the ball may have a top on each side.
  [[nodiscard]] double top_of(const Cell& cell, double x, double y, double at_x, double at_y) const {
    const double sharpness = std::abs(cell.c) * radius_;
    if (sharpness <= kFlat) return flat_top(cell, x, y, at_x, at_y);
    const Climb climb(cell, radius_, x, y);
    double top = climb.from(std::clamp(at_x - x, 0.0, 1.0), std::clamp(at_y - y, 0.0, 1.0));
    if (sharpness < 1.0) return top;  // concave: there is one top
    for (const auto& [s, t] : {std::array{0.0, 0.0}, std::array{1.0, 0.0}, std::array{0.0, 1.0}, std::array{1.0, 1.0}})
      top = std::max(top, climb.from(s, t));
    return top;
  }

  static constexpr double kFine = 1e-10;  // cells
  static constexpr double kNear = 3e-4;   // of a top, whose height then is right to the square of it
  static constexpr double kFlat = 0.5;

  std::vector<float>& height_;
  int nx_;
  int ny_;
  double unit_;
  double radius_;  // cells
  int reach_;
  std::vector<double> chord_;  // half the ball's width at so many rows from its middle
  std::vector<double> low_;
  std::vector<double> best_;
};

}  // namespace

void touch_with_ball(std::vector<float>& height, int nx, int ny, double spacing, double radius) {
  if (nx < 2 || ny < 2 || !(spacing > 0.0) || !(radius > 0.0)) return;
  Dilation(height, nx, ny, spacing, radius).run();
}

}  // namespace sparsha::pipeline
