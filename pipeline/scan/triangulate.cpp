// Ears are cut as of Meisters 1975; corners of equal place, as of Eberly 2002, do not block each other.
#include "pipeline/scan/triangulate.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <queue>

#include <Eigen/Geometry>

namespace sparsha::pipeline {
namespace {

/// Corners looked at for one polygon, those that need arithmetic counted kArithmetic times: about a second.
constexpr std::uint64_t kMostTests = 600'000'000;
constexpr std::uint64_t kArithmetic = 16;

struct Corner {
  std::uint32_t index;
  double u, v;  ///< in the polygon's plane, counter-clockwise
};

/// Twice the signed area of a, b, c.
double turn(const Corner& a, const Corner& b, const Corner& c) {
  return (b.u - a.u) * (c.v - a.v) - (b.v - a.v) * (c.u - a.u);
}

bool goes_back(const Corner& a, const Corner& b, const Corner& c) {
  return (b.u - a.u) * (c.u - b.u) + (b.v - a.v) * (c.v - b.v) < 0.0;
}

bool contains(const Corner& a, const Corner& b, const Corner& c, const Corner& p) {
  return turn(a, b, p) >= 0.0 && turn(b, c, p) >= 0.0 && turn(c, a, p) >= 0.0;
}

bool same_place(const Corner& a, const Corner& b) { return a.u == b.u && a.v == b.v; }

/// Corners along the two axes across which the polygon's area vector (Newell 1972) is largest.
std::vector<Corner> flatten(std::span<const std::uint32_t> corners, std::span<const Eigen::Vector3d> points) {
  const Eigen::Vector3d& base = points[corners[0]];
  Eigen::Vector3d area = Eigen::Vector3d::Zero();
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const Eigen::Vector3d a = points[corners[i]] - base;
    const Eigen::Vector3d b = points[corners[(i + 1) % corners.size()]] - base;
    area += a.cross(b);
  }
  int axis = 0;
  area.cwiseAbs().maxCoeff(&axis);
  const int first = (axis + 1) % 3;
  const int second = (axis + 2) % 3;
  const double sign = area[axis] < 0.0 ? -1.0 : 1.0;
  std::vector<Corner> flat;
  flat.reserve(corners.size());
  for (const std::uint32_t corner : corners) {
    const Eigen::Vector3d p = points[corner] - base;
    flat.push_back({corner, sign * p[first], p[second]});
  }
  return flat;
}

/// A slit has no turn at its end, but goes back there.
bool is_convex(const std::vector<Corner>& flat) {
  const std::size_t n = flat.size();
  for (std::size_t i = 0; i < n; ++i) {
    const Corner& b = flat[(i + 1) % n];
    const Corner& c = flat[(i + 2) % n];
    const double t = turn(flat[i], b, c);
    if (t < 0.0 || (t == 0.0 && goes_back(flat[i], b, c))) return false;
  }
  return true;
}

/// Cuts the first ear of an outline until a triangle is left. Only the two corners beside a cut can become ears by it,
/// and only reflex or straight corners can block one.
class EarCutter {
 public:
  explicit EarCutter(const std::vector<Corner>& outline) : corners_(outline), states_(outline.size()) {
    const std::size_t n = outline.size();
    for (std::size_t i = 0; i < n; ++i) states_[i].beside = {(i + n - 1) % n, (i + 1) % n};
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return outline[a].u < outline[b].u; });
    across_.reserve(n);
    for (std::size_t rank = 0; rank < n; ++rank) {
      across_.push_back({outline[order[rank]]});
      states_[order[rank]].rank = rank;
    }
    for (std::size_t i = 0; i < n; ++i) look_at_turn(i);
    look_for_ears();
  }

  /// False when it takes too long; then only some of the triangles are there.
  bool cut(std::vector<std::array<std::uint32_t, 3>>& triangles) {
    for (std::size_t left = corners_.size(); left > 3; --left) {
      if (tests_ > kMostTests) return false;
      const std::size_t b = next_ear();
      const auto [a, c] = states_[b].beside;
      add(a, b, c, triangles);
      states_[b].is_there = false;
      blocks(b) = false;
      states_[a].beside[1] = c;
      states_[c].beside[0] = a;
      look_at_turn(a);
      look_at_turn(c);
      look_at_ear(a);
      look_at_ear(c);
    }
    std::size_t first = 0;
    while (!states_[first].is_there) ++first;
    const std::size_t second = states_[first].beside[1];
    add(first, second, states_[second].beside[1], triangles);
    return true;
  }

  /// After cut(): whether the triangles' areas add up to the polygon's, but for a thousandth and rounding.
  [[nodiscard]] bool fits() const {
    constexpr double kShare = 1e-3;
    constexpr double kRounding = 1e-9;
    const auto [low, high] = std::minmax_element(corners_.begin(), corners_.end(),
                                                 [](const Corner& a, const Corner& b) { return a.v < b.v; });
    const double longest = std::max(high->v - low->v, across_.back().corner.u - across_.front().corner.u);
    return covered_ - enclosed_ <= kShare * covered_ + kRounding * longest * longest;
  }

 private:
  struct State {
    std::array<std::size_t, 2> beside{};  ///< the corners before and behind it that are not cut
    std::size_t rank = 0;                 ///< in across_
    bool is_there = true;
    double area = 0.0;  ///< twice that of the triangle with those beside it
  };
  struct Blocker {
    Corner corner;
    bool blocks = false;  ///< not cut, and reflex or straight
  };

  bool& blocks(std::size_t i) { return across_[states_[i].rank].blocks; }

  void add(std::size_t a, std::size_t b, std::size_t c, std::vector<std::array<std::uint32_t, 3>>& triangles) {
    triangles.push_back({corners_[a].index, corners_[b].index, corners_[c].index});
    const double t = turn(corners_[a], corners_[b], corners_[c]);
    covered_ += std::abs(t);
    enclosed_ += t;
  }

  void look_at_turn(std::size_t b) {
    State& state = states_[b];
    const double t = turn(corners_[state.beside[0]], corners_[b], corners_[state.beside[1]]);
    state.area = std::abs(t);
    blocks(b) = !(t > 0.0);
  }

  bool is_ear(std::size_t i) {
    if (blocks(i)) return false;
    tests_ += kArithmetic;
    const Corner& a = corners_[states_[i].beside[0]];
    const Corner& b = corners_[i];
    const Corner& c = corners_[states_[i].beside[1]];
    const auto [left, right] = std::minmax({a.u, b.u, c.u});
    const auto [low, high] = std::minmax({a.v, b.v, c.v});
    auto at = std::lower_bound(across_.begin(), across_.end(), left,
                               [](const Blocker& p, double u) { return p.corner.u < u; });
    for (; at != across_.end() && at->corner.u <= right; ++at) {
      ++tests_;
      const Corner& p = at->corner;
      if (!at->blocks || p.v < low || p.v > high) continue;
      tests_ += kArithmetic;
      if (!same_place(p, a) && !same_place(p, b) && !same_place(p, c) && contains(a, b, c, p)) return false;
    }
    return true;
  }
  void look_at_ear(std::size_t i) {
    if (is_ear(i)) ears_.push(i);
  }
  void look_for_ears() {
    for (std::size_t i = 0; i < states_.size() && tests_ <= kMostTests; ++i) {
      if (states_[i].is_there) look_at_ear(i);
    }
  }

  /// Of the triangles that corners make with those beside them, the one with the least area.
  std::size_t least() {
    tests_ += states_.size();
    std::size_t best = states_.size();
    for (std::size_t i = 0; i < states_.size(); ++i) {
      if (states_[i].is_there && (best == states_.size() || states_[i].area < states_[best].area)) best = i;
    }
    return best;
  }

  /// Of those found so far; they stay ears unless the outline crosses itself.
  std::optional<std::size_t> found_ear() {
    while (!ears_.empty()) {
      const std::size_t i = ears_.top();
      ears_.pop();
      if (states_[i].is_there && is_ear(i)) return i;
    }
    return std::nullopt;
  }

  /// Where there is none, the ends of slits and corners on straight sides are left, which hold no area, or the outline
  /// crosses itself, if only by rounding: any cut keeps it closed.
  std::size_t next_ear() {
    std::optional<std::size_t> ear = found_ear();
    if (!ear) {
      // Tests that fail in no order are slow; only outlines that cross themselves need many here.
      constexpr std::uint64_t kAgain = 4;
      const std::uint64_t before = tests_;
      look_for_ears();
      tests_ += (kAgain - 1) * (tests_ - before);
      ear = found_ear();
    }
    return ear ? *ear : least();
  }

  const std::vector<Corner>& corners_;
  std::vector<State> states_;
  std::vector<Blocker> across_;  ///< all corners by u
  std::priority_queue<std::size_t, std::vector<std::size_t>, std::greater<>> ears_;
  std::uint64_t tests_ = 0;
  double covered_ = 0.0, enclosed_ = 0.0;  ///< twice the area of the triangles, and with signs of the polygon
};

}  // namespace

void triangulate_as_fan(std::span<const std::uint32_t> corners, std::vector<std::array<std::uint32_t, 3>>& triangles) {
  for (std::size_t i = 2; i < corners.size(); ++i) triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

bool triangulate(std::span<const std::uint32_t> corners, std::span<const Eigen::Vector3d> points,
                 std::vector<std::array<std::uint32_t, 3>>& triangles) {
  if (corners.size() > 3) {
    const std::vector<Corner> outline = flatten(corners, points);
    if (!is_convex(outline)) {
      const std::size_t before = triangles.size();
      if (outline.size() <= kMostCornersCut) {
        EarCutter cutter(outline);
        if (cutter.cut(triangles)) return cutter.fits();
      }
      triangles.resize(before);
      triangulate_as_fan(corners, triangles);
      return false;
    }
  }
  triangulate_as_fan(corners, triangles);
  return true;
}

}  // namespace sparsha::pipeline
