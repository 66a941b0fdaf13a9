// The exact active-set proxy solver: descends D = |hip - p|^2 / 2 over z >= f(x, y) from where the proxy was, so that
// it ends in the local minimum a finger would find. One class a surface type; friction is a template parameter because
// frictionless solving needs no coefficients at all.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "haptics/proxy/bicubic_descent.h"
#include "haptics/proxy/descent.h"
#include "haptics/proxy/fast_path.h"
#include "haptics/proxy/place.h"
#include "haptics/proxy/ray_march.h"
#include "haptics/proxy/smooth_path.h"
#include "haptics/proxy/tangent_cone.h"
#include "haptics/proxy/touching_cells.h"

namespace sparsha::haptics {

template <class Surface, bool kFriction>
class ExactSolver {
 public:
  ExactSolver(const Surface& surface, const CellVector& hip, const SolverOptions& options) noexcept
      : surface_(surface),
        hip_(hip),
        tolerance_(options.tolerance_cells),
        limit_(options.segment_limit),
        flies_(options.flies) {}

  /// Puts `p` on the surface or into the air, where the state's contact no longer holds, and moves it to rest.
  void settle_and_solve(CellPoint& p, bool& contact, bool& sticking) noexcept {
    settle_on(surface_.patch(p.i, p.j), p, contact);
    course_.sticking = kFriction && contact && sticking;
    course_.may_stick_again = kFriction && contact && !sticking;
    solve(p, contact, true);
    sticking = course_.sticking;
  }
  /// Goes on where the fast path has handed over.
  void go_on(CellPoint& p, bool& contact, bool& sticking, const SolverState& course) noexcept {
    course_ = course;
    solve(p, contact, false);
    sticking = course_.sticking;
  }

  [[nodiscard]] int segments() const noexcept { return course_.segments; }
  [[nodiscard]] bool unfinished() const noexcept { return unfinished_; }
  [[nodiscard]] const RestPlace& place() const noexcept { return place_; }

 private:
  using Patch = typename Surface::Patch;

  /// A cell from which a step is taken.
  struct Piece {
    CellPoint point;
    Patch patch;
    Pull pull{0.0, 0.0, {}};
    TangentProjection tangent;
    Freedom s = Freedom::both;
    Freedom t = Freedom::both;
  };

  /// Moves `p`, feasible, to rest. `may_take_fast_path`: the fast path has not just handed over.
  void solve(CellPoint& p, bool& contact, bool may_take_fast_path) noexcept {
    bool landed = false;
    CellPoint from = p;
    while (course_.segments < limit_) {
      if (!contact) {
        if (!flies_) break;
        if (!fly(p, contact)) return;
        landed = contact;
        course_.sticking = kFriction && contact;
        course_.may_stick_again = false;
        continue;
      }
      // Where the proxy has just landed, creases decide whether it leaves again; a smooth surface has none.
      if (may_take_fast_path && !(landed && Surface::kHasFastPath) && rests_on_fast_path(p, from)) return;
      may_take_fast_path = true;
      from = p;
      const CellVector w = hip_ - p;
      const double threshold = rest_tolerance(tolerance_, w);
      if (is_inside_cell(surface_, p)) {
        const auto patch = surface_.patch(p.i, p.j);
        const Pull pull(patch.slope_s(p.s, p.t), patch.slope_t(p.s, p.t), w);
        if (!landed && leaves(pull, w)) {
          take_off(contact);
          continue;
        }
        const double tangent = std::sqrt(pull.squared_tangent() / pull.area);
        if (holds(pull, tangent, p, threshold)) return;
        const Piece piece{
            p, patch, pull, project_on_quadrant(pull, Freedom::both, Freedom::both), Freedom::both, Freedom::both};
        if (advance(piece, w, threshold, p)) return;
      } else {
        const TouchingCells touching = touching_cells(surface_, p);
        Piece piece;
        const OnEdge found = look_on_edge(touching, w, threshold, !landed, p, piece);
        if (found == OnEdge::rests) return;
        if (found == OnEdge::leaves) {
          take_off(contact);
          continue;
        }
        from = piece.point;
        if (advance(piece, w, threshold, p)) return;
      }
      landed = false;
      ++course_.segments;
    }
    unfinished_ = true;
  }

  /// Takes the fast path where it is open, inside a cell or across the edge that a step `from` this cell has led to;
  /// true when the proxy then rests.
  [[nodiscard]] bool rests_on_fast_path(CellPoint& p, const CellPoint& from) noexcept {
    if constexpr (Surface::kHasFastPath) {
      Pair inward = both(0.0);
      const bool on_s = p.s == 0.0 || p.s == 1.0;
      const bool on_t = p.t == 0.0 || p.t == 1.0;
      if (on_s && on_t) return false;
      if (on_s || on_t) {
        if (on_s ? p.s == from.s : p.t == from.t) return false;
        const bool up = (on_s ? p.s : p.t) == 1.0;
        const int i = p.i + (on_s ? (up ? 1 : -1) : 0);
        const int j = p.j + (on_s ? 0 : (up ? 1 : -1));
        if (!surface_.is_inner(i, j)) return false;
        const double way = up ? 1.0 : -1.0;
        p.i = i;
        p.j = j;
        (on_s ? p.s : p.t) = up ? 0.0 : 1.0;
        inward = on_s ? Pair{way, 0.0} : Pair{0.0, way};
      } else if (!surface_.is_inner(p.i, p.j) || !is_strictly_inside(p)) {
        return false;
      }
      const BilinearPatch patch = surface_.patch_inside(p.i, p.j);
      p.z = patch.height(p.s, p.t);
      FastPath<kFriction> path(surface_, hip_, tolerance_, p, patch, inward, course_);
      return path.follow(limit_, place_) == FastPathEnd::rest;
    } else {
      if (!surface_.is_deep(p.i, p.j)) return false;
      SmoothPath<kFriction, Surface::kBasis> path(surface_, hip_, tolerance_, p, course_);
      return path.follow(limit_, place_);
    }
  }

  /// Lifts a point that is below the surface onto it; drops the contact of one that is above.
  static void settle_on(const Patch& patch, CellPoint& p, bool& contact) noexcept {
    constexpr double kSame = 64.0 * std::numeric_limits<double>::epsilon();
    const double floor = patch.height(p.s, p.t);
    contact = p.z < floor || (contact && p.z <= floor + kSame * (1.0 + std::abs(floor)));
    if (contact) p.z = floor;
  }

  /// Free flight; true when there is more to do.
  bool fly(CellPoint& p, bool& contact) noexcept {
    if (p.z >= surface_.highest() && hip_.z >= surface_.highest()) {
      p = locate(surface_, hip_);
      return false;
    }
    switch (march_to_hand(surface_, hip_, p, leaving_, course_.segments, limit_)) {
      case MarchEnd::hand:
        return false;
      case MarchEnd::limit:
        unfinished_ = true;
        return false;
      case MarchEnd::surface:
        leaving_ = false;
        contact = true;
        return true;
    }
    return false;
  }

  void take_off(bool& contact) noexcept {
    contact = false;
    course_.sticking = false;
    leaving_ = true;
  }

  /// Does w rise faster than the patch, by more than rounding?
  [[nodiscard]] static bool leaves(const Pull& pull, const CellVector& w) noexcept {
    constexpr double kRounding = 4.0 * std::numeric_limits<double>::epsilon();
    return pull.normal > 0.0 &&
           pull.normal > kRounding * (std::abs(w.z) + std::abs(pull.fs * w.x) + std::abs(pull.ft * w.y));
  }

  [[nodiscard]] double mu(const CellPoint& p, bool sticking) const noexcept {
    if constexpr (!kFriction) return 0.0;
    return sticking ? surface_.mu_static(p.i, p.j, p.s, p.t) : surface_.mu_dynamic(p.i, p.j, p.s, p.t);
  }

  /// Two-state friction inside a cell: true when the proxy rests where it is.
  bool holds(const Pull& pull, double tangent, const CellPoint& p, double threshold) noexcept {
    if constexpr (!kFriction) return tangent <= threshold;
    const double press = std::max(0.0, -pull.normal) / std::sqrt(pull.area);
    if (course_.sticking) {
      if (tangent - mu(p, true) * press <= threshold) return true;
      course_.sticking = false;
    }
    const double mu_d = mu(p, false);
    if (course_.may_stick_again && tangent < kStickAgain * mu_d * press) course_.sticking = true;
    course_.may_stick_again = false;
    return course_.sticking || tangent - mu_d * press <= threshold;
  }

  enum class OnEdge { rests, leaves, moves };

  /// The same over all touching cells; else the piece to move on is in the cell of largest excess. Whether p leaves is
  /// for the cell to say that w points into; p moves there.
  OnEdge look_on_edge(const TouchingCells& touching, const CellVector& w, double threshold, bool may_leave,
                      CellPoint& p, Piece& piece) noexcept {
    double tangent[4] = {};
    double press[4] = {};
    CellVector normal;
    const CellPoint* gripping = nullptr;  // there is no friction beyond the border
    for (int k = 0; k < touching.count; ++k) {
      const TouchingCell& cell = touching.cell[k];
      const Pull pull = pull_in(surface_.patch(cell.point.i, cell.point.j), cell.point, w);
      if (may_leave && allows(cell.s, w.x) && allows(cell.t, w.y)) {
        if (leaves(pull, w)) {
          p = cell.point;
          return OnEdge::leaves;
        }
        may_leave = false;
      }
      const double inverse = 1.0 / std::sqrt(pull.area);
      tangent[k] = project_on_quadrant(pull, cell.s, cell.t).length;
      if (kFriction && surface_.is_inner(cell.point.i, cell.point.j)) {
        gripping = &cell.point;
        press[k] = std::max(0.0, -pull.normal) * inverse;
      }
      normal = {normal.x - pull.fs * inverse, normal.y - pull.ft * inverse, normal.z + inverse};
    }
    int largest = 0;
    const auto largest_excess = [&](double coefficient) {
      double excess = -std::numeric_limits<double>::infinity();
      for (int k = 0; k < touching.count; ++k)
        if (const double mine = tangent[k] - coefficient * press[k]; mine > excess) excess = mine, largest = k;
      return excess;
    };
    const auto rests = [&] {
      place_ = {true, normal, kFriction ? mu(p, false) : 0.0};
      return OnEdge::rests;
    };
    if (kFriction && course_.sticking) {
      if (largest_excess(gripping != nullptr ? mu(*gripping, true) : 0.0) <= threshold) return rests();
      course_.sticking = false;
    }
    const double mu_d = gripping != nullptr ? mu(*gripping, false) : 0.0;
    if (course_.may_stick_again && largest_excess(kStickAgain * mu_d) < 0.0) course_.sticking = true;
    course_.may_stick_again = false;
    if (course_.sticking || largest_excess(mu_d) <= threshold) return rests();
    const TouchingCell& cell = touching.cell[largest];
    piece.point = cell.point;
    piece.patch = surface_.patch(cell.point.i, cell.point.j);
    piece.pull = pull_in(piece.patch, cell.point, w);
    piece.tangent = project_on_quadrant(piece.pull, cell.s, cell.t);
    piece.s = cell.s;
    piece.t = cell.t;
    return OnEdge::moves;
  }
  [[nodiscard]] static Pull pull_in(const Patch& patch, const CellPoint& p, const CellVector& w) noexcept {
    return {patch.slope_s(p.s, p.t), patch.slope_t(p.s, p.t), w};
  }

  [[nodiscard]] static auto slope_along(const Piece& piece, const CellVector& w, const Segment& d) noexcept {
    if constexpr (Surface::kHasFastPath)
      return SegmentSlope(piece.patch, piece.pull, w, d);
    else
      return CurveSlope(piece.patch, piece.point, w, d);
  }

  /// One segment of descent in the piece's cell, stopped where friction holds; true when the proxy then rests.
  bool advance(const Piece& piece, const CellVector& w, double threshold, CellPoint& p) const noexcept {
    const Segment d = descent_direction(piece.patch, piece.point, piece.pull, w, piece.tangent, piece.s, piece.t);
    const double end = length_in_cell(surface_, piece.point, d);
    const double tau = descent_length(slope_along(piece, w, d), end);
    p = moved(surface_, piece.point, d, tau, end);
    p.z = piece.patch.height(p.s, p.t);
    // On very steep walls the tolerance can be finer than the coordinates: nothing nearer to rest can be written.
    if (p.s == piece.point.s && p.t == piece.point.t) return true;
    if constexpr (kFriction) {
      // The sliding edge's or cell's own excess, without the freedoms that end at the segment's end.
      const double excess = sliding_excess(piece, p);
      if (excess < -threshold) return stop_by_friction(piece, d, tau, end, excess, threshold, p);
    }
    return false;
  }

  /// Excess at q, on the piece's cell or, when the piece slides along an edge, over both cells of that edge.
  [[nodiscard]] double sliding_excess(const Piece& piece, const CellPoint& q) const noexcept {
    const CellVector w = hip_ - q;
    const Pull pull(piece.patch.slope_s(q.s, q.t), piece.patch.slope_t(q.s, q.t), w);
    const bool along_s = piece.tangent.dt == 0.0 && piece.t != Freedom::both;
    const bool along_t = piece.tangent.ds == 0.0 && piece.s != Freedom::both;
    if (!along_s && !along_t) return friction_excess(pull, mu(q, false));
    const Freedom s = along_t ? piece.s : Freedom::both;
    const Freedom t = along_s ? piece.t : Freedom::both;
    const double here = friction_excess(pull, project_on_quadrant(pull, s, t).length, mu(q, false));
    CellPoint other = q;
    if (along_t) {
      other.i += s == Freedom::up ? -1 : 1;
      other.s = s == Freedom::up ? 1.0 : 0.0;
    } else {
      other.j += t == Freedom::up ? -1 : 1;
      other.t = t == Freedom::up ? 1.0 : 0.0;
    }
    const auto reversed = [](Freedom f) { return static_cast<Freedom>(-static_cast<int>(f)); };
    const Patch patch = surface_.patch(other.i, other.j);
    const Pull beyond(patch.slope_s(other.s, other.t), patch.slope_t(other.s, other.t), w);
    const double there =
        friction_excess(beyond, project_on_quadrant(beyond, reversed(s), reversed(t)).length, mu(other, false));
    return std::max(here, there);
  }

  /// The excess is positive at the segment's start and negative at tau_end: rests at a zero between (Anderson & Bjorck
  /// 1973).
  bool stop_by_friction(const Piece& piece, const Segment& d, double tau_end, double end, double excess_end,
                        double threshold, CellPoint& p) const noexcept {
    double low = 0.0;
    double high = tau_end;
    double at_low = friction_excess(piece.pull, piece.tangent.length, mu(piece.point, false));
    double at_high = excess_end;
    int same_side = 0;
    for (int k = 0; k < kRootIterations; ++k) {
      double tau = low + (high - low) * (at_low / (at_low - at_high));
      if (!(tau > low && tau < high)) tau = 0.5 * (low + high);
      const bool exhausted = !(tau > low && tau < high);
      p = moved(surface_, piece.point, d, exhausted ? high : tau, end);
      p.z = piece.patch.height(p.s, p.t);
      if (exhausted) return false;
      const double excess = sliding_excess(piece, p);
      if (std::abs(excess) <= kRootShare * threshold) return true;
      // The end that stays for the second time gets the weight that would have hit a parabola's zero.
      const auto weight = [excess](double before) {
        const double bent = 1.0 - excess / before;
        return bent > 0.0 ? bent : 0.5;
      };
      if (excess > 0.0) {
        if (same_side > 0) at_high *= weight(at_low);
        low = tau, at_low = excess;
        same_side = 1;
      } else {
        if (same_side < 0) at_low *= weight(at_high);
        high = tau, at_high = excess;
        same_side = -1;
      }
    }
    return false;
  }

  static constexpr int kRootIterations = 80;

  const Surface& surface_;
  CellVector hip_;
  double tolerance_;
  int limit_;
  bool flies_;
  SolverState course_;
  bool leaving_ = false;
  bool unfinished_ = false;
  RestPlace place_;
};

}  // namespace sparsha::haptics
