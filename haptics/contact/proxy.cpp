#include "haptics/contact/proxy.h"

#include "haptics/contact/exact_solver.h"
#include "haptics/contact/proxy_update.h"

namespace sparsha::haptics {
namespace {

template <bool kFriction, class Surface>
ProxyUpdate solve(const MongeSurface& monge, const Surface& surface, const Eigen::Vector3d& hip_m,
                  const CellVector& hip, ProxyState& state, const SolverOptions& options) noexcept {
  CellPoint p;
  if (!place_of(surface, state, p)) {
    state = start_proxy(monge, hip_m);
    static_cast<void>(place_of(surface, state, p));
  }
  ExactSolver<Surface, kFriction> solver(surface, hip, options);
  solver.solve(p, state.contact, state.sticking);
  ProxyUpdate update = report(monge, surface, hip_m, p, !state.contact && !solver.unfinished(), solver.place(), state);
  update.segments = solver.segments();
  update.unfinished = solver.unfinished();
  return update;
}

template <class Surface>
ProxyUpdate update_on(const Surface& cells, const MongeSurface& surface, const Eigen::Vector3d& hip, ProxyState& state,
                      const SolverOptions& options) noexcept {
  const CellVector hand = to_cells(cells, hip);
  if (!is_reachable(hand)) return report_no_hand(state);
  return cells.has_friction() ? solve<true>(surface, cells, hip, hand, state, options)
                              : solve<false>(surface, cells, hip, hand, state, options);
}

}  // namespace

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

ProxyUpdate update_exact(const MongeSurface& surface, const Eigen::Vector3d& hip, ProxyState& state,
                         const SolverOptions& options) noexcept {
  return options.c1_surface ? update_on(C1Surface(surface), surface, hip, state, options)
                            : update_on(BilinearSurface(surface), surface, hip, state, options);
}

}  // namespace sparsha::haptics
