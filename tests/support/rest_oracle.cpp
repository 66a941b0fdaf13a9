#include "tests/support/rest_oracle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Geometry>

namespace sparsha::haptics::test {
namespace {

using Eigen::Vector3d;

constexpr double kEps = std::numeric_limits<double>::epsilon();

double node_height(const MongeSurface& surface, int i, int j) {
  i = std::clamp(i, 0, surface.lattice.nx - 1);
  j = std::clamp(j, 0, surface.lattice.ny - 1);
  return static_cast<double>(surface.height_m[surface.lattice.index(i, j)]);
}

/// Cells along one axis that a coordinate touches: 4 ulp of the coordinate decide what is on a line.
std::vector<int> cells_along(double coordinate, double spacing, int nodes) {
  const double u = coordinate / spacing;
  const double slack = 4.0 * kEps * std::max(1.0, std::abs(u));
  std::vector<int> cells;
  const double nearest = std::round(u);
  if (std::abs(u - nearest) <= slack && nearest >= 0.0 && nearest <= nodes - 1)
    return {static_cast<int>(nearest) - 1, static_cast<int>(nearest)};
  return {static_cast<int>(std::clamp(std::floor(u), -1.0, nodes - 1.0))};
}

/// Longest projection of w on the cone spanned by signed tangents: plane first, then the rays.
double cone_projection(const Vector3d& w, const Vector3d& es, const Vector3d& et, int sign_s, int sign_t) {
  const Vector3d n = es.cross(et).normalized();
  const Vector3d in_plane = w - w.dot(n) * n;
  const double ds = in_plane.x();  // es = (1, 0, .), et = (0, 1, .)
  const double dt = in_plane.y();
  if (sign_s * ds >= 0.0 && sign_t * dt >= 0.0) return in_plane.norm();
  double longest = 0.0;
  const auto along = [&](const Vector3d& e, int sign) {
    const double length = w.dot(e.normalized());
    longest = std::max(longest, sign == 0 ? std::abs(length) : std::max(0.0, sign * length));
  };
  if (sign_t != 0) along(es, sign_s);
  if (sign_s != 0) along(et, sign_t);
  return longest;
}

}  // namespace

double coefficient_at(const MongeSurface& surface, const std::vector<float>& nodes, const Vector3d& proxy) {
  if (nodes.empty()) return 0.0;
  const double h = surface.lattice.spacing_m;
  const double u = std::clamp(proxy.x() / h, 0.0, surface.lattice.nx - 1.0);
  const double v = std::clamp(proxy.y() / h, 0.0, surface.lattice.ny - 1.0);
  const int i = std::min(static_cast<int>(u), surface.lattice.nx - 2);
  const int j = std::min(static_cast<int>(v), surface.lattice.ny - 2);
  double value = 0.0;
  for (int b = 0; b < 2; ++b)
    for (int a = 0; a < 2; ++a)
      value += (a == 0 ? 1.0 - (u - i) : u - i) * (b == 0 ? 1.0 - (v - j) : v - j) *
               static_cast<double>(nodes[surface.lattice.index(i + a, j + b)]);
  return value;
}

Judgement judge(const MongeSurface& surface, const Vector3d& proxy, const Vector3d& hip, double mu) {
  const double h = surface.lattice.spacing_m;
  const Vector3d w = hip - proxy;
  Judgement result;
  result.excess_cells = -std::numeric_limits<double>::infinity();
  double steepest = 0.0;
  double twist = 0.0;  // change of slope per cell
  const std::vector<int> cells_x = cells_along(proxy.x(), h, surface.lattice.nx);
  const std::vector<int> cells_y = cells_along(proxy.y(), h, surface.lattice.ny);
  double floor = -std::numeric_limits<double>::infinity();
  for (const int i : cells_x)
    for (const int j : cells_y) {
      const double z00 = node_height(surface, i, j);
      const double z10 = node_height(surface, i + 1, j);
      const double z01 = node_height(surface, i, j + 1);
      const double z11 = node_height(surface, i + 1, j + 1);
      const double s = proxy.x() / h - i;
      const double t = proxy.y() / h - j;
      const double fx = ((1.0 - t) * (z10 - z00) + t * (z11 - z01)) / h;
      const double fy = ((1.0 - s) * (z01 - z00) + s * (z11 - z10)) / h;
      const double z = (1.0 - t) * ((1.0 - s) * z00 + s * z10) + t * ((1.0 - s) * z01 + s * z11);
      floor = std::max(floor, z);
      const Vector3d es(1.0, 0.0, fx);
      const Vector3d et(0.0, 1.0, fy);
      const Vector3d n = es.cross(et).normalized();
      // Low cell of two: its high edge, so it can only be entered downwards.
      const int sign_s = cells_x.size() == 2 ? (i == cells_x[0] ? -1 : 1) : 0;
      const int sign_t = cells_y.size() == 2 ? (j == cells_y[0] ? -1 : 1) : 0;
      const double tangent = cone_projection(w, es, et, sign_s, sign_t) / h;
      const bool beyond = i < 0 || j < 0 || i >= surface.lattice.nx - 1 || j >= surface.lattice.ny - 1;
      const double press = std::max(0.0, -w.dot(n)) / h;
      result.excess_cells = std::max(result.excess_cells, tangent - (beyond ? 0.0 : mu) * press);
      result.tangent_cells = std::max(result.tangent_cells, tangent);
      if (sign_s * w.x() >= 0.0 && sign_t * w.y() >= 0.0) result.pull_cells = w.dot(n) / h;
      steepest = std::max(steepest, std::sqrt(1.0 + fx * fx + fy * fy));
      twist = std::max(twist, std::abs((z11 - z10) - (z01 - z00)) / h);
    }
  result.below_cells = (floor - proxy.z()) / h;
  const double coordinate =
      std::max({std::abs(proxy.x()), std::abs(proxy.y()), std::abs(hip.x()), std::abs(hip.y())}) / h;
  const double height = std::max(std::abs(proxy.z()), std::abs(hip.z())) / h;
  // An ulp of x or y moves the point along the slope and turns the tangent plane by the twist, and w with it.
  const double ulps = kEps * (coordinate * (steepest + twist * w.norm() / h) + height);
  result.allowance_cells = 1e-9 + 4.0 * kEps * w.norm() / h + 4.0 * ulps;
  return result;
}

}  // namespace sparsha::haptics::test
