// One cell of a bilinear Monge surface and the surface as the proxy solvers see it. All lengths are in cells, so that
// tolerances and conditioning do not depend on the scene's size.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "haptics/proxy/hot.h"
#include "haptics/surface/monge_surface.h"

namespace sparsha::haptics {

/// A point by its cell and its place in it: x = i + s, y = j + t. Cells (-1, j) and (nx-1, j), (i, -1) and (i, ny-1)
/// lie beyond the border and have no outer edge. Kept this way because s and t resolve 1e-16 of a cell however far from
/// the origin the cell is.
struct CellPoint {
  int i = 0;
  int j = 0;
  double s = 0.0;
  double t = 0.0;
  double z = 0.0;
};

/// The hand's position in cells, from node (0,0).
struct CellVector {
  double x = 0.0;
  double y = 0.0;
  double z = 0.0;
};

/// hip - p without losing p's resolution.
[[nodiscard]] inline CellVector operator-(const CellVector& hip, const CellPoint& p) noexcept {
  return {(hip.x - p.i) - p.s, (hip.y - p.j) - p.t, hip.z - p.z};
}

/// s, or the edge that it cannot be told from once i + s is written as one number. Without this a proxy could rest a
/// share of an ulp beside a crease that everybody else sees it lie on.
[[nodiscard]] inline double snapped_to_edge(double s, int i) noexcept {
  const double ulps = 4.0 * std::numeric_limits<double>::epsilon() * (1.0 + std::abs(static_cast<double>(i)));
  if (std::abs(s) <= ulps) return 0.0;
  return std::abs(1.0 - s) <= ulps ? 1.0 : s;
}

/// f(s, t) = z + a s + b t + c s t.
struct BilinearPatch {
  double z = 0.0;
  double a = 0.0;
  double b = 0.0;
  double c = 0.0;

  [[nodiscard]] double height(double s, double t) const noexcept { return z + s * a + t * (b + s * c); }
  [[nodiscard]] double slope_s(double, double t) const noexcept { return a + c * t; }
  [[nodiscard]] double slope_t(double s, double) const noexcept { return b + c * s; }
};

/// Friction coefficient of one cell, bilinear like its heights.
struct CellCoefficients {
  double mu = 0.0;
  double a = 0.0;
  double b = 0.0;
  double c = 0.0;

  [[nodiscard]] double at(double s, double t) const noexcept { return mu + s * a + t * (b + s * c); }
};

/// A MongeSurface in cells; cheap to make, for one update.
class BilinearSurface {
 public:
  using Patch = BilinearPatch;
  static constexpr bool kHasFastPath = true;

  explicit BilinearSurface(const MongeSurface& surface) noexcept
      : BilinearSurface(surface, 1.0 / surface.lattice.spacing_m) {}
  BilinearSurface(const MongeSurface& surface, double cells_per_m) noexcept
      : height_(surface.height_m.data()),
        mu_dynamic_(surface.mu_dynamic.empty() ? nullptr : surface.mu_dynamic.data()),
        mu_static_(surface.mu_static.empty() ? nullptr : surface.mu_static.data()),
        nx_(surface.lattice.nx),
        ny_(surface.lattice.ny),
        cell_m_(surface.lattice.spacing_m),
        cells_per_m_(cells_per_m),
        highest_(surface.highest_m * cells_per_m_) {}

  [[nodiscard]] int nx() const noexcept { return nx_; }
  [[nodiscard]] int ny() const noexcept { return ny_; }
  [[nodiscard]] double cell_m() const noexcept { return cell_m_; }
  [[nodiscard]] double cells_per_m() const noexcept { return cells_per_m_; }
  [[nodiscard]] double highest() const noexcept { return highest_; }
  [[nodiscard]] bool has_friction() const noexcept { return mu_dynamic_ != nullptr && mu_static_ != nullptr; }

  [[nodiscard]] bool is_inner(int i, int j) const noexcept {
    return static_cast<unsigned>(i) < static_cast<unsigned>(nx_ - 1) &&
           static_cast<unsigned>(j) < static_cast<unsigned>(ny_ - 1);
  }
  [[nodiscard]] bool has_low_s(int i) const noexcept { return i >= 0; }
  [[nodiscard]] bool has_high_s(int i) const noexcept { return i < nx_ - 1; }
  [[nodiscard]] bool has_low_t(int j) const noexcept { return j >= 0; }
  [[nodiscard]] bool has_high_t(int j) const noexcept { return j < ny_ - 1; }

  /// The nearest place inside p's cell, on an edge when within rounding of it.
  void keep_in_cell(CellPoint& p) const noexcept {
    p.s = snapped_to_edge(p.s, p.i);
    p.t = snapped_to_edge(p.t, p.j);
    if (has_low_s(p.i)) p.s = std::max(p.s, 0.0);
    if (has_high_s(p.i)) p.s = std::min(p.s, 1.0);
    if (has_low_t(p.j)) p.t = std::max(p.t, 0.0);
    if (has_high_t(p.j)) p.t = std::min(p.t, 1.0);
  }

  [[nodiscard]] double height_at(int i, int j) const noexcept {
    return static_cast<double>(height_[node(i, j)]) * cells_per_m_;
  }
  [[nodiscard]] SPARSHA_HOT Patch patch(int i, int j) const noexcept {
    if (is_inner(i, j)) [[likely]]
      return patch_inside(i, j);
    return patch_beyond(i, j);
  }
  /// Of a cell beyond the border.
  [[nodiscard]] SPARSHA_SELDOM Patch patch_beyond(int i, int j) const noexcept {
    const int i0 = std::clamp(i, 0, nx_ - 1);
    const int j0 = std::clamp(j, 0, ny_ - 1);
    const int i1 = std::clamp(i + 1, 0, nx_ - 1);
    const int j1 = std::clamp(j + 1, 0, ny_ - 1);
    return patch_of(height_[node(i0, j0)], height_[node(i1, j0)], height_[node(i0, j1)], height_[node(i1, j1)]);
  }
  /// Of an inner cell.
  [[nodiscard]] SPARSHA_HOT Patch patch_inside(int i, int j) const noexcept {
    const float* low = height_ + node(i, j);
    const float* high = low + nx_;
    return patch_of(low[0], low[1], high[0], high[1]);
  }

  /// Coefficients in a cell, bilinear between nodes, 0 beyond the border. Only with has_friction().
  [[nodiscard]] double mu_dynamic(int i, int j, double s, double t) const noexcept {
    return interpolate(mu_dynamic_, i, j, s, t);
  }
  [[nodiscard]] SPARSHA_HOT double mu_static(int i, int j, double s, double t) const noexcept {
    return interpolate(mu_static_, i, j, s, t);
  }
  /// mu_dynamic of an inner cell. Only with has_friction().
  [[nodiscard]] SPARSHA_HOT CellCoefficients coefficients(int i, int j) const noexcept {
    const float* low = mu_dynamic_ + node(i, j);
    const float* high = low + nx_;
    const double m00 = low[0];
    const double m01 = high[0];
    const double a = static_cast<double>(low[1]) - m00;
    return {m00, a, m01 - m00, (static_cast<double>(high[1]) - m01) - a};
  }

  /// Asks for the rows that a proxy in this inner cell comes to next. On a large surface every row is a page of its
  /// own, and waiting for it would cost more than the tick.
  SPARSHA_HOT void prefetch_around(int i, int j) const noexcept {
    constexpr std::size_t kLarge = std::size_t{1} << 20;  // nodes: what stays in the second cache needs no help
    if (static_cast<std::size_t>(nx_) * static_cast<std::size_t>(ny_) < kLarge) [[likely]]
      return;
    prefetch_rows(i, j);
  }

 protected:
  [[nodiscard]] const float* heights() const noexcept { return height_; }
  [[nodiscard]] std::size_t node(int i, int j) const noexcept {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx_) + static_cast<std::size_t>(i);
  }

 private:
  SPARSHA_HOT void prefetch_rows(int i, int j) const noexcept {
    for (const int row : {j - 3, j - 2, j - 1, j + 2, j + 3, j + 4}) {
      if (row < 0 || row >= ny_) continue;
      SPARSHA_PREFETCH(height_ + node(i, row));
      if (!has_friction()) continue;
      SPARSHA_PREFETCH(mu_dynamic_ + node(i, row));
      SPARSHA_PREFETCH(mu_static_ + node(i, row));
    }
  }
  [[nodiscard]] SPARSHA_HOT Patch patch_of(double z00, double z10, double z01, double z11) const noexcept {
    z00 *= cells_per_m_, z10 *= cells_per_m_, z01 *= cells_per_m_, z11 *= cells_per_m_;
    return {z00, z10 - z00, z01 - z00, (z11 - z10) - (z01 - z00)};
  }
  [[nodiscard]] SPARSHA_HOT double interpolate(const float* values, int i, int j, double s, double t) const noexcept {
    if (!is_inner(i, j)) return 0.0;
    const float* low = values + node(i, j);
    const float* high = low + nx_;
    const double at_low = static_cast<double>(low[0]) + s * (static_cast<double>(low[1]) - static_cast<double>(low[0]));
    const double at_high =
        static_cast<double>(high[0]) + s * (static_cast<double>(high[1]) - static_cast<double>(high[0]));
    return at_low + t * (at_high - at_low);
  }

  const float* height_;
  const float* mu_dynamic_;
  const float* mu_static_;
  int nx_;
  int ny_;
  double cell_m_;
  double cells_per_m_;
  double highest_;
};

}  // namespace sparsha::haptics
