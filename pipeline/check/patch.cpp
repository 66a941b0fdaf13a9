// For fixed u the patch is a straight line in v, so the distance has one variable left: its stationary points are the
// roots of a quintic. Where the distance is convex there is one root; elsewhere all are isolated. Edges are straight.
#include "pipeline/check/patch.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sparsha::pipeline {
namespace {

constexpr int kDegree = 5;
constexpr int kMaxSteps = 60;
constexpr double kTolerance = 1e-13;  // of u, in cells

using Polynomial = std::array<double, kDegree + 1>;

double evaluate(const Polynomial& p, int degree, double u) {
  double value = p[static_cast<std::size_t>(degree)];
  for (int k = degree - 1; k >= 0; --k) value = value * u + p[static_cast<std::size_t>(k)];
  return value;
}

Polynomial derivative(const Polynomial& p, int degree) {
  Polynomial result{};
  for (int k = 1; k <= degree; ++k) result[static_cast<std::size_t>(k - 1)] = k * p[static_cast<std::size_t>(k)];
  return result;
}

/// Root of p in [low, high], whose ends have opposite signs: Newton, with bisection where it would leave the bracket.
double bracketed_root(const Polynomial& p, const Polynomial& slope, int degree, double low, double high) {
  const bool rising = evaluate(p, degree, high) > 0;
  double u = (low + high) / 2;
  for (int step = 0; step < kMaxSteps && high - low > kTolerance; ++step) {
    const double value = evaluate(p, degree, u);
    if (value == 0) return u;
    ((value > 0) == rising ? high : low) = u;
    const double gradient = evaluate(slope, degree - 1, u);
    const double next = u - value / gradient;
    const bool inside = next > low && next < high;
    if (inside && std::abs(next - u) < kTolerance) return next;
    u = inside ? next : (low + high) / 2;
  }
  return u;
}

/// All roots in [0, 1]: between consecutive roots of its derivative a polynomial is monotone.
int roots_in_unit(const Polynomial& p, int degree, std::array<double, kDegree>& roots) {
  if (degree == 0) return 0;
  const Polynomial slope = derivative(p, degree);
  std::array<double, kDegree> turns{};
  const int turn_count = roots_in_unit(slope, degree - 1, turns);
  int count = 0;
  double low = 0;
  for (int k = 0; k <= turn_count; ++k) {
    const double high = k < turn_count ? turns[static_cast<std::size_t>(k)] : 1.0;
    const double at_low = evaluate(p, degree, low), at_high = evaluate(p, degree, high);
    if ((at_low <= 0 && at_high > 0) || (at_low >= 0 && at_high < 0))
      roots[static_cast<std::size_t>(count++)] = bracketed_root(p, slope, degree, low, high);
    low = high;
  }
  return count;
}

class Search {
 public:
  Search(const Patch& patch, double x, double y, double z)
      : x_(x),
        y_(y),
        z_(z),
        base_(patch.z00),
        slope_u_(patch.z10 - patch.z00),
        slope_v_(patch.z01 - patch.z00),
        twist_((patch.z11 - patch.z10) - (patch.z01 - patch.z00)) {
    const double residual =
        std::max({std::abs(patch.z00 - z), std::abs(patch.z10 - z), std::abs(patch.z01 - z), std::abs(patch.z11 - z)});
    convex_ = residual * std::abs(twist_) < 1;
  }

  PatchPoint run() {
    const bool inside = convex_ ? only_root() : all_roots();
    if (!(convex_ && inside)) edges();
    const double dz_du = slope_u_ + twist_ * best_.v, dz_dv = slope_v_ + twist_ * best_.u;
    best_.side = (z_ - height(best_.u, best_.v)) - dz_du * (x_ - best_.u) - dz_dv * (y_ - best_.v);
    return best_;
  }

 private:
  [[nodiscard]] double height(double u, double v) const { return base_ + slope_u_ * u + (slope_v_ + twist_ * u) * v; }

  void offer(double u, double v) {
    const double dx = x_ - u, dy = y_ - v, dz = z_ - height(u, v);
    const double squared = dx * dx + dy * dy + dz * dz;
    if (squared < best_.squared_distance) best_ = {u, v, squared, 0};
  }

  /// The v of the line at u nearest to the point, not clamped.
  [[nodiscard]] double line_v(double u) const {
    const double s = slope_v_ + twist_ * u;
    return (y_ + s * (z_ - base_ - slope_u_ * u)) / (1 + s * s);
  }

  /// Half the derivative of the squared distance to the line at u, times (1 + s^2)^2:
  /// (u - x)(1 + s^2)^2 + N (n1 (1 + s^2) - N s twist), s = slope_v + twist u, N = n0 + n1 u.
  [[nodiscard]] Polynomial quintic() const {
    const double b = slope_v_, c = twist_;
    const double n0 = z_ - base_ - b * y_, n1 = -(slope_u_ + c * y_);
    const std::array<double, 3> q = {1 + b * b, 2 * b * c, c * c};  // 1 + s^2
    const std::array<double, 5> qq = {q[0] * q[0], 2 * q[0] * q[1], 2 * q[0] * q[2] + q[1] * q[1], 2 * q[1] * q[2],
                                      q[2] * q[2]};
    // n1 q - N s c, then times N
    const std::array<double, 3> m = {n1 * q[0] - n0 * b * c, n1 * q[1] - c * (n0 * c + n1 * b), n1 * q[2] - n1 * c * c};
    Polynomial p{};
    for (std::size_t k = 0; k < qq.size(); ++k) {
      p[k] -= x_ * qq[k];
      p[k + 1] += qq[k];
    }
    for (std::size_t k = 0; k < m.size(); ++k) {
      p[k] += n0 * m[k];
      p[k + 1] += n1 * m[k];
    }
    return p;
  }

  bool offer_interior(double u) {
    const double v = line_v(u);
    if (v < 0 || v > 1) return false;
    offer(u, v);
    return true;
  }

  bool only_root() {
    const Polynomial p = quintic();
    if (!(p[0] < 0) || !(evaluate(p, kDegree, 1.0) > 0)) return false;
    return offer_interior(bracketed_root(p, derivative(p, kDegree), kDegree, 0, 1));
  }

  bool all_roots() {
    std::array<double, kDegree> roots{};
    const int count = roots_in_unit(quintic(), kDegree, roots);
    bool found = false;
    for (int k = 0; k < count; ++k) found = offer_interior(roots[static_cast<std::size_t>(k)]) || found;
    return found;
  }

  void edges() {
    for (const double v : {0.0, 1.0}) {
      const double s = slope_u_ + twist_ * v;
      offer(std::clamp((x_ + s * (z_ - base_ - slope_v_ * v)) / (1 + s * s), 0.0, 1.0), v);
    }
    for (const double u : {0.0, 1.0}) offer(u, std::clamp(line_v(u), 0.0, 1.0));
  }

  double x_, y_, z_;
  double base_, slope_u_, slope_v_, twist_;
  bool convex_ = false;
  PatchPoint best_{0, 0, std::numeric_limits<double>::infinity(), 0};
};

}  // namespace

PatchPoint closest_on_patch(const Patch& patch, double x, double y, double z) noexcept {
  return Search(patch, x, y, z).run();
}

PatchPoint closest_on_patch_by_search(const Patch& p, double x, double y, double z) noexcept {
  constexpr int kParts = 64, kTurns = 40, kPolish = 4;
  constexpr double kGolden = 0.6180339887498949;
  const auto height = [&](double u, double v) {
    return (p.z00 * (1 - u) + p.z10 * u) * (1 - v) + (p.z01 * (1 - u) + p.z11 * u) * v;
  };
  const auto squared = [&](double u, double v) {
    const double dx = x - u, dy = y - v, dz = z - height(u, v);
    return dx * dx + dy * dy + dz * dz;
  };
  // Along one parameter the patch is the straight line from `low` to `high`.
  const auto along = [&](double place, double low, double high) {
    const double s = high - low;
    return std::clamp((place + s * (z - low)) / (1 + s * s), 0.0, 1.0);
  };
  const auto best_v = [&](double u) { return along(y, height(u, 0), height(u, 1)); };
  const auto of = [&](double u) { return squared(u, best_v(u)); };
  // Going along u and v in turns would creep where both slopes are steep: the best places of lines are compared
  // instead, about each of those that are better than the lines beside them.
  PatchPoint best{0, 0, std::numeric_limits<double>::infinity(), 0};
  const auto offer = [&](double u, double v) {
    if (squared(u, v) < best.squared_distance) best = {u, v, squared(u, v), 0};
  };
  std::array<double, kParts + 1> line;
  for (int k = 0; k <= kParts; ++k) line[static_cast<std::size_t>(k)] = of(static_cast<double>(k) / kParts);
  for (int k = 0; k <= kParts; ++k) {
    const auto at = static_cast<std::size_t>(k);
    if ((k > 0 && line[at - 1] < line[at]) || (k < kParts && line[at + 1] < line[at])) continue;
    double low = std::max(k - 1, 0) / static_cast<double>(kParts);
    double high = std::min(k + 1, kParts) / static_cast<double>(kParts);
    for (int turn = 0; turn < kTurns; ++turn) {
      const double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
      const bool lower = of(a) <= of(b);
      (lower ? high : low) = lower ? b : a;
    }
    offer((low + high) / 2, best_v((low + high) / 2));
  }
  offer(0, best_v(0));
  offer(1, best_v(1));
  // Values of a function tell the place of its minimum to half their digits; its derivatives tell the rest.
  const double twist = (p.z11 - p.z10) - (p.z01 - p.z00);
  for (int turn = 0; turn < kPolish; ++turn) {
    const double dz = height(best.u, best.v) - z;
    const double su = height(1, best.v) - height(0, best.v), sv = height(best.u, 1) - height(best.u, 0);
    const double gu = best.u - x + dz * su, gv = best.v - y + dz * sv;
    const double uu = 1 + su * su, vv = 1 + sv * sv, uv = su * sv + dz * twist;
    const double determinant = uu * vv - uv * uv;
    if (determinant > 0) {
      offer(std::clamp(best.u - (vv * gu - uv * gv) / determinant, 0.0, 1.0),
            std::clamp(best.v - (uu * gv - uv * gu) / determinant, 0.0, 1.0));
    }
    offer(along(x, height(0, best.v), height(1, best.v)), best.v);
    offer(best.u, best_v(best.u));
  }
  const double slope_u = height(1, best.v) - height(0, best.v), slope_v = height(best.u, 1) - height(best.u, 0);
  best.side = (z - height(best.u, best.v)) - slope_u * (x - best.u) - slope_v * (y - best.v);
  return best;
}

}  // namespace sparsha::pipeline
