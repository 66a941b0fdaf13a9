#include "haptics/proxy/proxy.h"

#include "haptics/proxy/exact_solver.h"
#include "haptics/proxy/hot.h"
#include "haptics/proxy/update.h"

namespace sparsha::haptics {
namespace {

template <class Surface>
CellPoint place_or_start(const MongeSurface& monge, const Surface& surface, const Eigen::Vector3d& hip_m,
                         ProxyState& state) noexcept {
  CellPoint p;
  if (!place_of(surface, state, p)) {
    state = start_proxy(monge, hip_m);
    static_cast<void>(place_of(surface, state, p));
  }
  return p;
}

template <bool kFriction, class Surface>
ProxyUpdate finish(const MongeSurface& monge, const Surface& surface, const Eigen::Vector3d& hip_m, const CellPoint& p,
                   const ExactSolver<Surface, kFriction>& solver, ProxyState& state) noexcept {
  ProxyUpdate update = report(monge, surface, hip_m, p, !state.contact && !solver.unfinished(), solver.place(), state);
  update.segments = solver.segments();
  update.unfinished = solver.unfinished();
  return update;
}

/// The general solver from the state's proxy. Like `go_on`, it makes anew what the fast path keeps in registers.
template <bool kFriction, class Surface>
SPARSHA_SELDOM ProxyUpdate solve(const MongeSurface& monge, const Eigen::Vector3d& hip_m, ProxyState& state,
                                 const SolverOptions& options) noexcept {
  const Surface surface(monge);
  const CellVector hip = to_cells(surface, hip_m);
  if (!is_reachable(hip)) return report_no_hand(state);
  CellPoint p = place_or_start(monge, surface, hip_m, state);
  ExactSolver<Surface, kFriction> solver(surface, hip, options);
  solver.settle_and_solve(p, state.contact, state.sticking);
  return finish(monge, surface, hip_m, p, solver, state);
}

/// The general solver from where the fast path has handed over.
template <bool kFriction>
SPARSHA_SELDOM ProxyUpdate go_on(const MongeSurface& monge, const Eigen::Vector3d& hip_m, CellPoint p,
                                 SolverState course, ProxyState& state, const SolverOptions& options) noexcept {
  const BilinearSurface surface(monge);
  ExactSolver<BilinearSurface, kFriction> solver(surface, to_cells(surface, hip_m), options);
  solver.go_on(p, state.contact, state.sticking, course);
  return finish(monge, surface, hip_m, p, solver, state);
}

/// The smooth fast path where the state is as the solver left it, in contact away from the border; else the general
/// solver.
template <bool kFriction, CubicBasis kBasis>
ProxyUpdate update_smooth(const MongeSurface& monge, double cells_per_m, const Eigen::Vector3d& hip_m,
                          ProxyState& state, const SolverOptions& options) noexcept {
  const BicubicSurface<kBasis> surface(monge, cells_per_m);
  CellPoint p{state.cell.i, state.cell.j, state.cell.s, state.cell.t, state.cell.z};
  const CellVector hip = to_cells(surface, hip_m);
  if (!state.contact || !surface.is_deep(p.i, p.j) || !is_at(surface, p, state.position) || !is_reachable(hip))
    return solve<kFriction, BicubicSurface<kBasis>>(monge, hip_m, state, options);
  SolverState course;
  course.sticking = kFriction && state.sticking;
  course.may_stick_again = kFriction && !state.sticking;
  RestPlace place;
  SmoothPath<kFriction, kBasis> path(surface, hip, options.tolerance_cells, p, course);
  if (path.follow(options.segment_limit, place)) return report_rest<kFriction>(monge, surface, p, place, course, state);
  // From where the tick began: the general steps take its decisions themselves.
  return solve<kFriction, BicubicSurface<kBasis>>(monge, hip_m, state, options);
}

// Where the surface turns under a sliding proxy, where friction lets it stop depends on the hand's way and not on its
// end alone: half the normal's turn is what the force may be off by, of the depth.
constexpr double kTurnOfPart_rad = 0.01;
constexpr int kMostParts = 4;
constexpr int kManySegments = 8;  // a way that is costly enough is not divided further

/// Follows the hand's straight way since the last tick in as many parts as the normal's turn asks for, if it goes on
/// turning as it did.
template <CubicBasis kBasis>
ProxyUpdate follow_hand(const MongeSurface& monge, double cells_per_m, const Eigen::Vector3d& hip_m, ProxyState& state,
                        const SolverOptions& options) noexcept {
  const HandTrack last = state.track;
  const bool known = last.known && state.contact && last.proxy == state.position;
  const Eigen::Vector3d way_m = known ? Eigen::Vector3d(hip_m - last.hand) : Eigen::Vector3d::Zero();
  const double length_m = way_m.norm();
  // The curvature of Catmull-Rom patches jumps at the edges of cells, which no turn of the last tick tells of.
  constexpr double kPart = kBasis == CubicBasis::catmull_rom ? 0.5 * kTurnOfPart_rad : kTurnOfPart_rad;
  constexpr int kMost = kBasis == CubicBasis::catmull_rom ? 2 * kMostParts : kMostParts;
  const double turns = length_m * last.turn_per_m / kPart;
  const int parts = !(turns >= 1.0) ? 1 : turns < kMost ? 1 + static_cast<int>(turns) : kMost;
  SolverOptions left = options;
  ProxyUpdate found;
  int segments = 0;
  for (int part = 1; part <= parts; ++part) {
    const Eigen::Vector3d hand_m =
        part == parts ? hip_m : Eigen::Vector3d(last.hand + way_m * (static_cast<double>(part) / parts));
    found = update_smooth<true, kBasis>(monge, cells_per_m, hand_m, state, left);
    segments += found.segments;
    left.segment_limit = std::max(1, options.segment_limit - segments);
    if (segments > kManySegments) part = std::max(part, parts - 1);
  }
  found.segments = segments;
  const double turn_per_m = known && length_m > 0.0 ? (found.normal - last.normal).norm() / length_m
                            : known                 ? last.turn_per_m
                                                    : 0.0;
  state.track = {found.position, hip_m, found.normal, turn_per_m, found.contact};
  return found;
}

/// The fast path where the state is as the solver left it, in contact inside a cell; else the general solver.
template <bool kFriction>
SPARSHA_HOT inline ProxyUpdate update_bilinear(const MongeSurface& monge, const BilinearSurface& surface,
                                               const Eigen::Vector3d& hip_m, ProxyState& state,
                                               const SolverOptions& options) noexcept {
  CellPoint p{state.cell.i, state.cell.j, state.cell.s, state.cell.t, state.cell.z};
  const CellVector hip = to_cells(surface, hip_m);
  if (!state.contact || !surface.is_inner(p.i, p.j) || !is_strictly_inside(p) || !is_at(surface, p, state.position) ||
      !is_reachable(hip))
    return solve<kFriction, BilinearSurface>(monge, hip_m, state, options);
  const BilinearPatch patch = surface.patch_inside(p.i, p.j);
  if (p.z != patch.height(p.s, p.t)) return solve<kFriction, BilinearSurface>(monge, hip_m, state, options);
  SolverState course;
  course.sticking = kFriction && state.sticking;
  course.may_stick_again = kFriction && !state.sticking;
  RestPlace place;
  FastPath<kFriction> path(surface, hip, options.tolerance_cells, p, patch, both(0.0), course);
  if (path.follow(options.segment_limit, place) != FastPathEnd::rest)
    return go_on<kFriction>(monge, hip_m, p, course, state, options);
  return report_rest<kFriction>(monge, surface, p, place, course, state);
}

}  // namespace

CellShape shape_of(scene::HapticsConfig::Surface surface, scene::HapticsConfig::Creases creases) noexcept {
  using Config = scene::HapticsConfig;
  if (surface == Config::Surface::c1) return CellShape::c1;
  return creases == Config::Creases::rounded ? CellShape::rounded : CellShape::bilinear;
}

double touched_height(const MongeSurface& surface, double x_m, double y_m, CellShape shape) noexcept {
  const auto height_on = [&](const auto& cells) {
    const CellPoint p = locate(cells, to_cells(cells, {x_m, y_m, 0.0}));
    return cells.patch(p.i, p.j).height(p.s, p.t) * cells.cell_m();
  };
  if (shape == CellShape::c1) return height_on(C1Surface(surface));
  if (shape == CellShape::rounded) return height_on(RoundedSurface(surface));
  return surface.height(x_m, y_m);
}

ProxyState start_proxy(const MongeSurface& surface, const Eigen::Vector3d& hip) noexcept {
  ProxyState state;
  const BilinearSurface cells(surface);
  const CellVector hand = to_cells(cells, hip);
  if (!is_reachable(hand)) return state;
  CellPoint p = locate(cells, hand);
  const double floor = cells.patch(p.i, p.j).height(p.s, p.t);
  state.contact = hand.z < floor;
  state.sticking = state.contact;
  p.z = state.contact ? floor : hand.z;
  keep_place(cells, p, state);
  if (!state.contact) state.position = hip;
  return state;
}

void move_proxy(ProxyState& state, const Eigen::Vector3d& position, double share) noexcept {
  HandTrack& track = state.track;
  track.known = track.known && track.proxy == state.position;
  track.hand = position + share * (track.hand - state.position);
  track.turn_per_m /= share;
  track.proxy = state.position = position;
}

ProxyUpdate update_exact(const MongeSurface& surface, const Eigen::Vector3d& hip, ProxyState& state,
                         const SolverOptions& options) noexcept {
  const bool friction = !surface.mu_dynamic.empty() && !surface.mu_static.empty();
  const double spacing_m = surface.lattice.spacing_m;
  const double cells_per_m = state.cell.spacing_m == spacing_m ? state.cell.cells_per_m : 1.0 / spacing_m;
  if (options.shape == CellShape::rounded)
    return friction ? follow_hand<CubicBasis::b_spline>(surface, cells_per_m, hip, state, options)
                    : update_smooth<false, CubicBasis::b_spline>(surface, cells_per_m, hip, state, options);
  if (options.shape == CellShape::c1) [[unlikely]]
    return friction ? follow_hand<CubicBasis::catmull_rom>(surface, cells_per_m, hip, state, options)
                    : update_smooth<false, CubicBasis::catmull_rom>(surface, cells_per_m, hip, state, options);
  const BilinearSurface cells(surface, cells_per_m);
  return friction ? update_bilinear<true>(surface, cells, hip, state, options)
                  : update_bilinear<false>(surface, cells, hip, state, options);
}

}  // namespace sparsha::haptics
