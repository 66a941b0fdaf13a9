// The source paper's proxy (Aniyath et al. 2014, eq. 1 to 6): the tangential part of the way to the hand, taken in
// steps of rho, each followed by a projection along the normal; friction scales the step by 1 - mu_d cot(beta) once
// tan(beta) has exceeded mu_s. It chatters at patch creases; the exact solver does not. The projection knows one normal
// and no way: at a cliff it would carry the proxy to the top at once, so a tick's move is bounded (Reach).
#include <algorithm>
#include <cmath>

#include "haptics/proxy/ray_march.h"
#include "haptics/proxy/update.h"

namespace sparsha::haptics {
namespace {

struct Normal {
  double x, y, z;
};

Normal unit_normal(const BilinearPatch& patch, const CellPoint& p) noexcept {
  const double fs = patch.slope_s(p.s, p.t);
  const double ft = patch.slope_t(p.s, p.t);
  const double inverse = 1.0 / std::sqrt(1.0 + fs * fs + ft * ft);
  return {-fs * inverse, -ft * inverse, inverse};
}

/// The surface point on the line q + alpha n: Newton on the gap; straight down where that does not settle.
CellPoint project_along(const BilinearSurface& surface, const CellVector& q, const Normal& n) noexcept {
  constexpr int kIterations = 20;
  constexpr double kSettled = 1e-13;  // cells
  double alpha = 0.0;
  for (int k = 0; k < kIterations; ++k) {
    CellPoint p = locate(surface, {q.x + alpha * n.x, q.y + alpha * n.y, q.z + alpha * n.z});
    const BilinearPatch patch = surface.patch(p.i, p.j);
    const double gap = p.z - patch.height(p.s, p.t);
    if (std::abs(gap) <= kSettled * (1.0 + std::abs(p.z))) {
      p.z = patch.height(p.s, p.t);
      return p;
    }
    const double slope = n.z - patch.slope_s(p.s, p.t) * n.x - patch.slope_t(p.s, p.t) * n.y;
    if (!(slope > 0.0)) break;
    alpha -= gap / slope;
    if (!(std::abs(alpha) < kFarthestCell)) break;
  }
  CellPoint p = locate(surface, q);
  p.z = surface.patch(p.i, p.j).height(p.s, p.t);
  return p;
}

/// Where a tick may take the proxy, in cells: no farther from the hand than where the tick began, as the nearest points
/// are that the iteration looks for, and a cell more, for it chatters. So what it lags behind the hand grows by the
/// hand's own way and a cell, and no move is longer than twice the lag and a cell.
class Reach {
 public:
  Reach(const CellPoint& start, const CellVector& hip) noexcept : hip_(hip), most_(length(hip - start) + 1.0) {}
  [[nodiscard]] bool holds(const CellPoint& p) const noexcept { return length(hip_ - p) <= most_; }
  /// Steps are so much shorter than the method has them: halved whenever one went beyond, for the rest of the tick,
  /// which then costs some forty projections more at most.
  double share = 1.0;

 private:
  static double length(const CellVector& v) noexcept { return std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z); }
  CellVector hip_;
  double most_;
};

/// One iteration; false when it did not move or the hand leaves the surface.
bool step(const BilinearSurface& surface, const CellVector& hip, const SolverOptions& options, CellPoint& p,
          bool& contact, SolverState& course, Reach& reach) noexcept {
  const Normal n = unit_normal(surface.patch(p.i, p.j), p);
  const CellVector v = hip - p;
  const double along = n.x * v.x + n.y * v.y + n.z * v.z;
  if (along > 0.0) {
    contact = false;
    course.sticking = false;
    return false;
  }
  const CellVector tangential{v.x - along * n.x, v.y - along * n.y, v.z - along * n.z};
  const double length =
      std::sqrt(tangential.x * tangential.x + tangential.y * tangential.y + tangential.z * tangential.z);
  double factor = 1.0;
  if (surface.has_friction() && length > 0.0) {
    const double mu_d = surface.mu_dynamic(p.i, p.j, p.s, p.t);
    if (course.sticking && length <= surface.mu_static(p.i, p.j, p.s, p.t) * -along) return false;
    course.sticking = course.may_stick_again && length < kStickAgain * mu_d * -along;
    course.may_stick_again = false;
    if (course.sticking) return false;
    factor = std::clamp(1.0 - mu_d * -along / length, 0.0, 1.0);
  }
  for (;; reach.share *= 0.5) {
    const double rho = options.paper_rho * factor * reach.share;
    if (rho * length <= options.tolerance_cells) return false;
    const CellVector q{p.i + p.s + rho * tangential.x, p.j + p.t + rho * tangential.y, p.z + rho * tangential.z};
    const CellPoint next = project_along(surface, q, n);
    if (!reach.holds(next)) continue;
    p = next;
    return true;
  }
}

}  // namespace

ProxyUpdate update_paper(const MongeSurface& surface, const Eigen::Vector3d& hip, ProxyState& state,
                         const SolverOptions& options) noexcept {
  const BilinearSurface cells(surface);
  const CellVector hand = to_cells(cells, hip);
  if (!is_reachable(hand)) return report_no_hand(state);
  CellPoint p;
  if (!place_of(cells, state, p)) {
    state = start_proxy(surface, hip);
    static_cast<void>(place_of(cells, state, p));
  }
  const double floor = cells.patch(p.i, p.j).height(p.s, p.t);
  if (state.contact || p.z < floor) p.z = floor, state.contact = true;
  Reach reach(p, hand);
  SolverState course;
  course.sticking = cells.has_friction() && state.contact && state.sticking;
  course.may_stick_again = cells.has_friction() && state.contact && !state.sticking;

  int segments = 0;
  bool at_hand = false;
  bool settled = false;
  bool leaving = false;
  for (int k = 0; k < options.paper_iterations && !at_hand && !settled; ++k) {
    if (state.contact) {
      ++segments;
      const bool moved = step(cells, hand, options, p, state.contact, course, reach);
      settled = !moved && state.contact;
      leaving = !state.contact;
      if (state.contact) continue;
    }
    const MarchEnd end = march_to_hand(cells, hand, p, leaving, segments, options.segment_limit);
    leaving = false;
    state.contact = end == MarchEnd::surface;
    course.sticking = cells.has_friction() && state.contact;
    at_hand = end == MarchEnd::hand;
    if (end == MarchEnd::limit) break;
  }
  state.sticking = course.sticking;
  ProxyUpdate update = report(surface, cells, hip, p, at_hand, {}, state);
  update.segments = segments;
  update.unfinished = reach.share < 1.0 || (!at_hand && !settled && options.paper_iterations > 1);
  return update;
}

}  // namespace sparsha::haptics
