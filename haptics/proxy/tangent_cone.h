// The part of the pull that the surface cannot hold: w projected on a cell's tangent quadrant (non-negative least
// squares in the surface metric G = I + grad f grad f^T), and by how much friction fails to hold it.
#pragma once

#include <algorithm>
#include <cmath>

#include "haptics/proxy/bilinear_patch.h"
#include "haptics/proxy/hot.h"

namespace sparsha::haptics {

/// First-order geometry of D = |hip - p|^2 / 2 at a point of one cell.
struct Pull {
  double fs, ft;  ///< slopes
  double bs, bt;  ///< -grad D in (s, t)
  double normal;  ///< w . (-fs, -ft, 1): positive when the hand leaves the surface
  double area;    ///< 1 + fs^2 + ft^2 = det G

  Pull(double slope_s, double slope_t, const CellVector& w) noexcept
      : fs(slope_s),
        ft(slope_t),
        bs(w.x + slope_s * w.z),
        bt(w.y + slope_t * w.z),
        normal(w.z - slope_s * w.x - slope_t * w.y),
        area(1.0 + slope_s * slope_s + slope_t * slope_t) {}

  /// |T|^2 * area of the unconstrained projection; a sum of squares, so that nothing cancels.
  [[nodiscard]] double squared_tangent() const noexcept {
    const double cross = bs * ft - bt * fs;
    return bs * bs + bt * bt + cross * cross;
  }
};

/// Which way a coordinate may move: inside a cell both ways, on its low edge up only, on its high edge down only.
enum class Freedom : int { down = -1, both = 0, up = 1 };

/// T_c: its direction in (s, t) and its length.
struct TangentProjection {
  double ds = 0.0;
  double dt = 0.0;
  double length = 0.0;  ///< cells
};

[[nodiscard]] inline bool allows(Freedom freedom, double d) noexcept { return static_cast<double>(freedom) * d >= 0.0; }

[[nodiscard]] SPARSHA_HOT inline TangentProjection project_on_quadrant(const Pull& pull, Freedom s,
                                                                       Freedom t) noexcept {
  const double cross = pull.bs * pull.ft - pull.bt * pull.fs;
  const double inverse = 1.0 / pull.area;
  const double ds = (pull.bs + pull.ft * cross) * inverse;
  const double dt = (pull.bt - pull.fs * cross) * inverse;
  if (allows(s, ds) && allows(t, dt))
    return {ds, dt, std::sqrt((pull.bs * pull.bs + pull.bt * pull.bt + cross * cross) * inverse)};
  // On a facet of the quadrant: one coordinate stays, the other takes its own optimum where that is allowed.
  const double gss = 1.0 + pull.fs * pull.fs;
  const double gtt = 1.0 + pull.ft * pull.ft;
  const bool along_s = t != Freedom::both && allows(s, pull.bs);
  const bool along_t = s != Freedom::both && allows(t, pull.bt);
  const double squared_s = along_s ? pull.bs * pull.bs / gss : 0.0;
  const double squared_t = along_t ? pull.bt * pull.bt / gtt : 0.0;
  if (squared_s >= squared_t) return {along_s ? pull.bs / gss : 0.0, 0.0, std::sqrt(squared_s)};
  return {0.0, pull.bt / gtt, std::sqrt(squared_t)};
}

/// |T| - mu * max(0, -w.n), cells.
[[nodiscard]] inline double friction_excess(const Pull& pull, double tangent, double mu) noexcept {
  return tangent - mu * std::max(0.0, -pull.normal) / std::sqrt(pull.area);
}

/// The same for the unconstrained projection.
[[nodiscard]] inline double friction_excess(const Pull& pull, double mu) noexcept {
  return (std::sqrt(pull.squared_tangent()) - mu * std::max(0.0, -pull.normal)) / std::sqrt(pull.area);
}

}  // namespace sparsha::haptics
