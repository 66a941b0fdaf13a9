#include "scene/ground/fingertip.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include "base/error.h"
#include "base/threads/progress.h"
#include "scene/ground/ball_on_cell.h"

namespace sparsha::scene {
namespace {

using ball::Cell;
using ball::Climb;
using ball::kFar;
using ball::kFine;
using ball::kRounding;

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
};

/// A ball touches a node, an edge or the inside of a cell. Of small balls nodes are looked at from the ball's side;
/// those that a large ball may touch, edges and cells know by their slopes from which nodes they are touched, mostly
/// from none and from one.
class Dilation {
 public:
  Dilation(std::vector<float>& height, int nx, int ny, double spacing, double radius, const Progress* progress)
      : progress_(progress), height_(height), nx_(nx), ny_(ny), unit_(spacing), radius_(radius / spacing) {
    const double per_unit = 1.0 / spacing;
    low_.reserve(height.size());
    for (const float z : height) low_.push_back(static_cast<double>(z) * per_unit);
    best_ = low_;
    for (double& best : best_) best += radius_;
    // No node is farther from another one.
    reach_ = static_cast<int>(std::min(std::floor(radius_), std::max(nx, ny) - 1.0));
    for (int d = 0; d <= reach_; ++d) {
      chord_.push_back(std::sqrt(std::max(0.0, radius_ * radius_ - static_cast<double>(d) * d)));
      steep_.push_back(d > 0 ? d / chord_.back() : 0.0);
    }
    const auto widest = [&](int d) {
      int width = 0;
      while (width < reach_ && radius_ * radius_ - square(width + 1) - square(d) >= 0.0) ++width;
      return width;
    };
    for (int d = 0; d <= reach_; ++d) widths_.push_back(widest(d));
    for (int dj = 0; dj <= reach_; ++dj)
      for (int di = 0; di <= reach_; ++di)
        caps_.push_back(std::sqrt(std::max(0.0, radius_ * radius_ - square(di) - square(dj))));
  }

  void run() {
    if (reach_ <= kFewRows)
      take_all_nodes();
    else
      take_tops();
    const Axis rows{1, nx_, nx_, ny_};
    for_rows(ny_, [&](int j) {
      for (int i = 0; i + 1 < nx_; ++i) take_edge(rows, i, j);
    });
    const Axis columns{nx_, 1, ny_, nx_};
    for_rows(ny_ - 1, [&](int j) {
      for (int i = 0; i < nx_; ++i) take_edge(columns, j, i);
    });
    for_rows(ny_ - 1, [&](int j) {
      for (int i = 0; i + 1 < nx_; ++i) take_cell(i, j);
    });
    for (std::size_t node = 0; node < low_.size(); ++node)
      height_[node] = static_cast<float>((best_[node] - radius_) * unit_);
  }

 private:
  static double square(int nodes) { return static_cast<double>(nodes) * nodes; }
  template <typename Row>
  void for_rows(int count, const Row& row) const {
    for (int j = 0; j < count; ++j) {
      if (progress_ != nullptr && progress_->cancelled()) throw Cancelled();
      row(j);
    }
  }
  [[nodiscard]] std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(i);
  }
  static void raise(double& best, double value) { best = std::max(best, value); }

  void take_all_nodes() {
    for (int dj = -reach_; dj <= reach_; ++dj)
      for (int di = -reach_; di <= reach_; ++di)
        if (di != 0 || dj != 0) take_nodes(di, dj);
  }

  void take_nodes(int di, int dj) {
    const double squared = radius_ * radius_ - square(di) - square(dj);
    if (squared < 0.0) return;
    const double cap = std::sqrt(squared);
    const int end = std::min(nx_, nx_ - di);
    for (int j = std::max(0, -dj); j < std::min(ny_, ny_ - dj); ++j) {
      double* best = best_.data() + index(0, j);
      const double* other = low_.data() + index(0, j + dj);
      for (int i = std::max(0, -di); i < end; ++i) best[i] = std::max(best[i], other[i + di] + cap);
    }
  }

  /// Of all nodes under a ball the highest with its cap is no lower than its neighbours with theirs: the cap's fall
  /// from it to the next node is at least the ground's rise. A fall over one cell is the cap's slope somewhere in it,
  /// so that only offsets count that lie within a cell of those where the cap is as steep as the ground on the node's
  /// two sides. The rest has a higher neighbour by more than rounding, and the result is that of all nodes to the last
  /// bit.
  void take_tops() {
    double greatest = radius_;
    for (const double z : low_) greatest = std::max(greatest, std::abs(z));
    const double play = 8.0 * std::numeric_limits<double>::epsilon() * greatest;
    for_rows(ny_, [&](int j) {
      for (int i = 0; i < nx_; ++i) take_top(i, j, play);
    });
  }

  /// Sines of the slopes before and behind a node: where the cap is as steep, in shares of its width.
  struct Sines {
    double from, to;
    Sines(const double* node, std::ptrdiff_t step, bool first, bool last, double play)
        : from(last ? -1.0 : sine(node[step] - node[0] - play)), to(first ? 1.0 : sine(node[0] - node[-step] + play)) {}
    [[nodiscard]] static double sine(double slope) { return slope / std::sqrt(1.0 + slope * slope); }
    [[nodiscard]] double most() const { return std::max(std::abs(from), std::abs(to)); }
  };

  void take_top(int i, int j, double play) {
    const double* node = low_.data() + index(i, j);
    const Sines x(node, 1, i == 0, i + 1 == nx_, play);
    const Sines y(node, nx_, j == 0, j + 1 == ny_, play);
    const double widest = x.most() * radius_ + 1.0 + kRounding;
    const double narrow = std::sqrt(std::max(0.0, radius_ * radius_ - widest * widest));
    const auto row_of = [&](double sine, double outwards) { return sine * (sine * outwards > 0.0 ? radius_ : narrow); };
    const int first = std::max(-reach_, -floor_of(1.0 + kRounding - row_of(y.from, -1.0)));
    const int last = std::min(reach_, floor_of(row_of(y.to, 1.0) + 1.0 + kRounding));
    for (int dj = std::max(first, j - ny_ + 1); dj <= std::min(last, j); ++dj) {
      const auto row = static_cast<std::size_t>(std::abs(dj));
      const int from = std::max(-widths_[row], -floor_of(1.0 + kRounding - x.from * chord_[row]));
      const int to = std::min(widths_[row], floor_of(x.to * chord_[row] + 1.0 + kRounding));
      double* best = best_.data() + index(0, j - dj);
      const double* caps = caps_.data() + row * static_cast<std::size_t>(reach_ + 1);
      for (int di = std::max(from, i - nx_ + 1); di <= std::min(to, i); ++di)
        raise(best[i - di], node[0] + caps[std::abs(di)]);
    }
  }

  /// Steps from node to node along an edge and across it, and how many nodes there are.
  struct Axis {
    std::ptrdiff_t step, across;
    int count, rows;
  };

  /// The edge from node `at` of the row `row` on. The ball rests on it only where its slope across the edge, y /
  /// chord times the edge's length at a distance of y rows, lies between the slopes of the cells on both sides;
  /// elsewhere one of the cells is higher. There the highest place is chord slope / length from below the centre, and
  /// the centre's height a closed form.
  void take_edge(const Axis& axis, int at, int row) {
    const double* low = low_.data() + at * axis.step + row * axis.across;
    const double slope = low[axis.step] - low[0];
    double least = -kFar;
    double most = kFar;
    if (row + 1 < axis.rows) least = std::min(low[axis.across] - low[0], low[axis.across + axis.step] - low[axis.step]);
    if (row > 0) most = std::max(low[0] - low[-axis.across], low[axis.step] - low[axis.step - axis.across]);
    if (least > 0.0 ? least - play(least) > most : most < 0.0 && most + play(most) < least) return;  // a groove
    double length = 0.0;
    const auto rest = [&](int d, double steep) {
      const int other = row - d;
      if (other < 0 || other >= axis.rows) return;
      if (length == 0.0) length = std::sqrt(1.0 + slope * slope);
      const double across = steep * length;
      if (across - play(across) > most || across + play(across) < least) return;
      const double chord = chord_[static_cast<std::size_t>(std::abs(d))];
      const double offset = chord * slope / length;
      double* best = best_.data() + other * axis.across;
      for (Nodes nodes(at, offset, offset, axis.count); nodes.first <= nodes.last; ++nodes.first)
        raise(best[nodes.first * axis.step], low[0] + slope * (nodes.first - at) + chord * length);
    };
    if (least <= play(0.0) && most >= -play(0.0)) rest(0, 0.0);
    for (int d = 1; d <= reach_; ++d) {
      const double steep = steep_[static_cast<std::size_t>(d)];
      const bool up = steep - play(steep) <= most;
      const bool down = play(steep) - steep >= least;
      if (!up && !down) break;
      if (up) rest(d, steep);
      if (down) rest(-d, -steep);
    }
  }
  /// What rounding may make of a slope.
  [[nodiscard]] static double play(double slope) noexcept { return 1e-7 * (1.0 + std::abs(slope)); }

  void take_cell(int i, int j) {
    const double* low = low_.data() + index(i, j);
    const double* high = low + nx_;
    const Cell cell{low[0], low[1] - low[0], high[0] - low[0], (high[1] - high[0]) - (low[1] - low[0])};
    // The plane of the middle's slopes, from which the patch is never farther than a quarter of its twist.
    const double a = cell.a + 0.5 * cell.c;
    const double b = cell.b + 0.5 * cell.c;
    const double length = std::sqrt(1.0 + a * a + b * b);
    // The offset of the contact changes no faster with the slopes than by the radius.
    const double cap = radius_ / length;
    const double at_x = cap * a;
    const double at_y = cap * b;
    const double spread = 0.5 * std::numbers::sqrt2 * radius_ * std::abs(cell.c);
    const Nodes columns(i, at_x - spread, at_x + spread, nx_);
    const Nodes rows(j, at_y - spread, at_y + spread, ny_);
    const double level = cell.z - 0.25 * cell.c + radius_ * length + 0.25 * std::abs(cell.c);
    const double highest = std::max(std::max(low[0], low[1]), std::max(high[0], high[1]));
    const double sharpness = std::abs(cell.c) * radius_;
    for (int nj = rows.first; nj <= rows.last; ++nj) {
      const int row_gap = nj <= j ? j - nj : nj - j - 1;
      if (row_gap > reach_) continue;
      const double* caps = caps_.data() + row_gap * (reach_ + 1);
      for (int ni = columns.first; ni <= columns.last; ++ni) {
        double& best = best_[index(ni, nj)];
        if (!(level + a * (ni - i) + b * (nj - j) > best + kFine)) continue;
        const int gap = ni <= i ? i - ni : ni - i - 1;
        if (gap > reach_ || !(highest + caps[gap] > best + kFine)) continue;
        raise(best, sharpness <= kFlat ? flat_top(cell, i - ni, j - nj, at_x, at_y)
                    : sharpness < 1.0  ? Climb(cell, radius_, i - ni, j - nj).only_top()
                                       : Climb(cell, radius_, i - ni, j - nj).highest_top(best));
      }
    }
  }

  /// The patch's own top, where its normal points at the ball's centre, by Newton steps. A top beyond the cell is none;
  /// its neighbours or their edge have it.
  [[nodiscard]] double flat_top(const Cell& cell, double x, double y, double at_x, double at_y) const {
    constexpr int kSteps = 16;
    double s = at_x - x;
    double t = at_y - y;
    for (int k = 0; k < kSteps; ++k) {
      const double a = cell.a + cell.c * t;
      const double b = cell.b + cell.c * s;
      const double squares = 1.0 + a * a + b * b;
      const double cap = radius_ / std::sqrt(squares);  // of the centre over the contact
      const double off_s = cap * a - x - s;
      const double off_t = cap * b - y - t;
      const double twist = cap * cell.c / squares;
      const double same = 1.0 + twist * a * b;
      const double ts = twist * (squares - a * a);
      const double st = twist * (squares - b * b);
      const double inverse = 1.0 / (same * same - ts * st);
      const double step_s = (same * off_s + ts * off_t) * inverse;
      const double step_t = (same * off_t + st * off_s) * inverse;
      s += step_s;
      t += step_t;
      const double step = std::abs(step_s) + std::abs(step_t);
      const double inside_s = std::clamp(s, 0.0, 1.0);
      const double inside_t = std::clamp(t, 0.0, 1.0);
      const double outside = std::abs(s - inside_s) + std::abs(t - inside_t);
      if (outside > kBeside + step) break;
      if (step < kNear) return Climb(cell, radius_, x, y).value(inside_s, inside_t);
    }
    return -kFar;
  }

  static constexpr double kNear = 3e-3;    // the last Newton step to a top, which then is right to the square of it
  static constexpr double kBeside = 1e-4;  // of the cell, where a top that was found so well may belong to it
  static constexpr double kFlat = 0.5;
  static constexpr int kFewRows = 5;  // of a ball so small that looking at all nodes under it takes less time

  const Progress* progress_;
  std::vector<float>& height_;
  int nx_;
  int ny_;
  double unit_;
  double radius_;  // cells
  int reach_;
  std::vector<double> chord_;  // half the ball's width at so many rows from its middle
  std::vector<double> steep_;  // and the ball's slope across its edge there
  std::vector<double> caps_;   // and its height over its edge at so many rows and columns
  std::vector<int> widths_;    // nodes on each side of its middle at so many rows
  std::vector<double> low_;
  std::vector<double> best_;
};

}  // namespace

void touch_with_ball(std::vector<float>& height, int nx, int ny, double spacing, double radius,
                     const Progress* progress) {
  if (nx < 2 || ny < 2 || !(spacing > 0.0) || !(radius > 0.0)) return;
  Dilation(height, nx, ny, spacing, radius, progress).run();
}

}  // namespace sparsha::scene
