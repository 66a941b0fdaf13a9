#include "haptics/proxy/rest_residual.h"

#include "haptics/proxy/bicubic_patch.h"
#include "haptics/proxy/place.h"
#include "haptics/proxy/tangent_cone.h"
#include "haptics/proxy/touching_cells.h"

namespace sparsha::haptics {
namespace {

template <class Surface>
RestResidual residual_on(const Surface& surface, const ProxyUpdate& update, const Eigen::Vector3d& hip) noexcept {
  const CellPoint p = locate(surface, to_cells(surface, update.position));
  const CellVector w = to_cells(surface, hip) - p;
  RestResidual residual;
  double steepest = 1.0;
  double highest = 0.0;
  const TouchingCells touching = touching_cells(surface, p);
  for (int k = 0; k < touching.count; ++k) {
    const CellPoint& q = touching.cell[k].point;
    const auto patch = surface.patch(q.i, q.j);
    const Pull pull(patch.slope_s(q.s, q.t), patch.slope_t(q.s, q.t), w);
    double mu = 0.0;
    if (surface.has_friction())
      mu = update.sticking ? surface.mu_static(q.i, q.j, q.s, q.t) : surface.mu_dynamic(q.i, q.j, q.s, q.t);
    const TangentProjection tangent = project_on_quadrant(pull, touching.cell[k].s, touching.cell[k].t);
    residual.excess_cells = std::max(residual.excess_cells, friction_excess(pull, tangent.length, mu));
    residual.below_cells = std::max(residual.below_cells, patch.height(q.s, q.t) - p.z);
    steepest = std::max(steepest, std::sqrt(pull.area));
    for (const double s : {0.0, 1.0})
      for (const double t : {0.0, 1.0}) highest = std::max(highest, std::abs(patch.height(s, t)));
  }
  // The coordinates are known to a few ulp, which the slope turns into height, and the patch to a few of its corners'.
  constexpr double kRounding = 16.0 * std::numeric_limits<double>::epsilon();
  const double known_to =
      kRounding * (std::abs(p.z) + highest + steepest * (std::abs(p.i + p.s) + std::abs(p.j + p.t)));
  if (residual.below_cells <= known_to) residual.below_cells = 0.0;
  return residual;
}

}  // namespace

RestResidual rest_residual(const MongeSurface& surface, const ProxyUpdate& update, const Eigen::Vector3d& hip,
                           CellShape shape) noexcept {
  switch (shape) {
    case CellShape::c1:
      return residual_on(C1Surface(surface), update, hip);
    case CellShape::rounded:
      return residual_on(RoundedSurface(surface), update, hip);
    case CellShape::bilinear:
      break;
  }
  return residual_on(BilinearSurface(surface), update, hip);
}

}  // namespace sparsha::haptics
