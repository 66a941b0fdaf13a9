// The exact active-set proxy solver: descends D = |hip - p|^2 / 2 over z >= f(x, y) from where the proxy was, so that
// it ends in the local minimum a finger would find. One class a surface type; friction is a template parameter because
// frictionless solving needs no coefficients at all.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "haptics/contact/bicubic_descent.h"
#include "haptics/contact/descent.h"
#include "haptics/contact/glide.h"
#include "haptics/contact/proxy_place.h"
#include "haptics/contact/ray_march.h"
#include "haptics/contact/tangent_cone.h"
#include "haptics/contact/touching_cells.h"

namespace sparsha::haptics {

template <class Surface, bool kFriction>
class ExactSolver {
 public:
  ExactSolver(const Surface& surface, const CellVector& hip, const SolverOptions& options) noexcept
      : surface_(surface), hip_(hip), tolerance_(options.tolerance_cells), limit_(options.segment_limit) {}

  /// Puts `p` on the surface or into the air, where the state's say-so no longer holds, and moves it to rest.
  void settle_and_solve(CellPoint& p, bool& contact, bool& sticking) noexcept {
    settle_on(surface_.patch(p.i, p.j), p, contact);
    course_.sticking = kFriction && contact && sticking;
    course_.may_stick_again = kFriction && contact && !sticking;
    solve(p, contact, true);
    sticking = course_.sticking;
  }
  /// Goes on where the fast lane has handed over.
  void go_on(CellPoint& p, bool& contact, bool& sticking, const TickCourse& course) noexcept {
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

  /// Moves `p`, feasible, to rest. `may_glide`: the fast lane has not just handed over.
  void solve(CellPoint& p, bool& contact, bool may_glide) noexcept {
    bool landed = false;
    while (course_.segments < limit_) {
      if (!contact) {
        if (!fly(p, contact)) return;
        landed = contact;
        course_.sticking = kFriction && contact;
        course_.may_stick_again = false;
        continue;
      }
      if (may_glide && !landed && glides(p)) return;
      may_glide = true;
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
        if (!landed && leaves_from_edge(touching, w, p)) {
          take_off(contact);
          continue;
        }
        Piece piece;
        if (holds_on_edge(touching, w, threshold, piece)) return;
        if (advance(piece, w, threshold, p)) return;
      }
      landed = false;
      ++course_.segments;
    }
    unfinished_ = true;
  }

  /// Takes the fast lane where it is open; true when the proxy then rests.
  [[nodiscard]] bool glides(CellPoint& p) noexcept {
    if constexpr (Surface::kHasFastLane) {
      return surface_.is_inner(p.i, p.j) && is_strictly_inside(p) &&
             glide<kFriction>(surface_, hip_, tolerance_, limit_, p, surface_.patch_inside(p.i, p.j), course_,
                              place_) == GlideEnd::rest;
    } else {
      return false;
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

  /// On edges and nodes the cell that w points into decides; p moves there.
  [[nodiscard]] bool leaves_from_edge(const TouchingCells& touching, const CellVector& w, CellPoint& p) const noexcept {
    for (int k = 0; k < touching.count; ++k) {
      const TouchingCell& cell = touching.cell[k];
      if (!allows(cell.s, w.x) || !allows(cell.t, w.y)) continue;
      const Patch patch = surface_.patch(cell.point.i, cell.point.j);
      const Pull pull(patch.slope_s(cell.point.s, cell.point.t), patch.slope_t(cell.point.s, cell.point.t), w);
      if (!leaves(pull, w)) return false;
      p = cell.point;
      return true;
    }
    return false;
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

  /// The same over all touching cells; else the cell of largest excess is the piece to move on.
  bool holds_on_edge(const TouchingCells& touching, const CellVector& w, double threshold, Piece& piece) noexcept {
    Piece pieces[4];
    for (int k = 0; k < touching.count; ++k) {
      const TouchingCell& cell = touching.cell[k];
      Piece& here = pieces[k];
      here.point = cell.point;
      here.patch = surface_.patch(cell.point.i, cell.point.j);
      here.pull =
          Pull(here.patch.slope_s(cell.point.s, cell.point.t), here.patch.slope_t(cell.point.s, cell.point.t), w);
      here.s = cell.s;
      here.t = cell.t;
      here.tangent = project_on_quadrant(here.pull, cell.s, cell.t);
    }
    const auto largest_excess = [&](bool stick, double factor, int& largest) {
      double excess = -std::numeric_limits<double>::infinity();
      for (int k = 0; k < touching.count; ++k) {
        const double mine =
            friction_excess(pieces[k].pull, pieces[k].tangent.length, factor * mu(pieces[k].point, stick));
        if (mine > excess) excess = mine, largest = k;
      }
      return excess;
    };
    int largest = 0;
    if (kFriction && course_.sticking) {
      if (largest_excess(true, 1.0, largest) <= threshold) return true;
      course_.sticking = false;
    }
    if (course_.may_stick_again && largest_excess(false, kStickAgain, largest) < 0.0) course_.sticking = true;
    course_.may_stick_again = false;
    if (course_.sticking || largest_excess(false, 1.0, largest) <= threshold) return true;
    piece = pieces[largest];
    return false;
  }

  [[nodiscard]] static auto slope_along(const Piece& piece, const CellVector& w, const Segment& d) noexcept {
    if constexpr (Surface::kHasFastLane)
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

  /// The excess is positive at the segment's start and negative at tau_end: rests at a zero between (Illinois).
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
      if (excess > 0.0) {
        low = tau, at_low = excess;
        if (same_side > 0) at_high *= 0.5;
        same_side = 1;
      } else {
        high = tau, at_high = excess;
        if (same_side < 0) at_low *= 0.5;
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
  TickCourse course_;
  bool leaving_ = false;
  bool unfinished_ = false;
  RestPlace place_;
};

}  // namespace sparsha::haptics
