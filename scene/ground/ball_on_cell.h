// The highest place of a ball's centre over one bilinear cell. Lengths in cells.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

namespace sparsha::scene::ball {

inline constexpr double kRounding = 1e-9;
inline constexpr double kFar = 1e300;
inline constexpr double kFine = 1e-10;  // what is higher by less is not looked for

/// f = z + a s + b t + c s t.
struct Cell {
  double z, a, b, c;
};

/// The ball over one cell. Its centre stands over a node that lies (x, y) before the cell's first node.
class Climb {
 public:
  Climb(const Cell& cell, double radius, double x, double y) noexcept
      : cell_(cell), radius_(radius), squared_(radius * radius), x_(x), y_(y) {}

  /// The largest f + sqrt(radius^2 - |d|^2) inside the cell where that is a concave function of the place, or something
  /// lower where it is on the edges t = 0 and t = 1. For a fixed t the best s is a closed form, and the other way
  /// round.
  [[nodiscard]] double only_top() const noexcept {
    const double low = best_t(best_s(0.0));
    if (!(low > 0.0)) return -kFar;
    const double high = best_t(best_s(1.0));
    if (!(high < 1.0)) return -kFar;
    const double t = 0.5 * (low + high);
    return from(best_s(t), t);
  }

  /// The largest inside the cell, or `best` where there is nothing higher. A ball over a saddle that is sharper than
  /// itself may have a top on each side: each quarter of the cell is looked at that may be touched.
  [[nodiscard]] double highest_top(double best) const noexcept {
    for (const double t : {0.25, 0.75})
      for (const double s : {0.25, 0.75}) best = std::max(best, top_of_part(s, t, 0.5, best));
    return best;
  }

  [[nodiscard]] double value(double s, double t) const noexcept {
    const double squared = squared_ - (x_ + s) * (x_ + s) - (y_ + t) * (y_ + t);
    return height(s, t) + (squared > 0.0 ? std::sqrt(squared) : -kFar);
  }

 private:
  /// Inside a part of the cell about (s, t), if it may be higher than `best`. No place of it is farther than a quarter
  /// of its twist from the plane of the middle's slopes, and the offset of the contact changes no faster with the
  /// slopes than by the radius.
  [[nodiscard]] double top_of_part(double s, double t, double size, double best) const noexcept {
    const double a = cell_.a + cell_.c * t;
    const double b = cell_.b + cell_.c * s;
    const double length = std::sqrt(1.0 + a * a + b * b);
    const double twist = std::abs(cell_.c) * size;
    const double plane = height(s, t) - a * (x_ + s) - b * (y_ + t) + radius_ * length;
    if (!(plane + 0.25 * twist * size > best + kFine)) return -kFar;
    const double half = 0.5 * size;
    const double spread = half + 0.5 * std::numbers::sqrt2 * radius_ * twist + kRounding;
    const double cap = radius_ / length;
    const double at_s = cap * a - x_;
    const double at_t = cap * b - y_;
    if (std::abs(at_s - s) > spread || std::abs(at_t - t) > spread) return -kFar;
    return from(std::clamp(at_s, s - half, s + half), std::clamp(at_t, t - half, t + half));
  }

  /// Uphill, by Newton steps where they lead higher inside the cell, else along s and t in turn.
  [[nodiscard]] double from(double s, double t) const noexcept {
    constexpr int kTurns = 60;
    constexpr double kStill = 1e-9;  // cells
    double dx = x_ + s;
    double dy = y_ + t;
    double cap = std::sqrt(std::max(0.0, squared_ - dx * dx - dy * dy));
    double here = height(s, t) + (cap > 0.0 ? cap : -kFar);
    for (int k = 0; k < kTurns; ++k) {
      // Gradient, Hessian and step times cap, -cap^3 and the determinant / cap^2.
      const double squared = cap * cap;
      const double gs = cap * (cell_.a + cell_.c * t) - dx;
      const double gt = cap * (cell_.b + cell_.c * s) - dy;
      const double hss = squared + dx * dx;
      const double htt = squared + dy * dy;
      const double hst = cell_.c * squared * cap - dx * dy;
      const double determinant = hss * htt - hst * hst;
      if (determinant > 0.0) {
        const double share = squared / determinant;
        const double ds = share * (hst * gt + htt * gs);
        const double dt = share * (hst * gs + hss * gt);
        const double next_s = s + ds;
        const double next_t = t + dt;
        if (next_s >= 0.0 && next_s <= 1.0 && next_t >= 0.0 && next_t <= 1.0) {
          if (gs * ds + gt * dt < kStill * cap) return here;
          const double next_dx = x_ + next_s;
          const double next_dy = y_ + next_t;
          const double next_squared = squared_ - next_dx * next_dx - next_dy * next_dy;
          const double next_cap = std::sqrt(std::max(0.0, next_squared));
          const double next = height(next_s, next_t) + next_cap;
          if (next_cap > 0.0 && next > here) {
            s = next_s, t = next_t, dx = next_dx, dy = next_dy, cap = next_cap, here = next;
            continue;
          }
        }
      }
      s = best_s(t);
      t = best_t(s);
      dx = x_ + s;
      dy = y_ + t;
      cap = std::sqrt(std::max(0.0, squared_ - dx * dx - dy * dy));
      const double next = height(s, t) + (cap > 0.0 ? cap : -kFar);
      if (!(next > here + kStill)) return std::max(here, next);
      here = next;
    }
    return here;
  }

  [[nodiscard]] double height(double s, double t) const noexcept {
    return cell_.z + s * cell_.a + t * (cell_.b + s * cell_.c);
  }
  [[nodiscard]] double best_s(double t) const noexcept { return highest(cell_.a + cell_.c * t, y_ + t, x_); }
  [[nodiscard]] double best_t(double s) const noexcept { return highest(cell_.b + cell_.c * s, x_ + s, y_); }

  /// Where a slope is highest under the ball at the distance `across`.
  [[nodiscard]] double highest(double slope, double across, double begin) const noexcept {
    const double chord = std::max(0.0, squared_ - across * across);
    return std::clamp(slope * std::sqrt(chord / (1.0 + slope * slope)) - begin, 0.0, 1.0);
  }

  const Cell& cell_;
  double radius_;
  double squared_;
  double x_;
  double y_;
};

}  // namespace sparsha::scene::ball
