// The surface of a whole object as sheets: height fields over squares of the six sides of a box, each of one
// connected layer that faces that side (a layered depth image, Shade et al. 1998, with measured layers).
//
//   chart frame of a direction: w along the direction, u and v across it so that (u, v, w) is right-handed;
//   node (i, j) of a sheet is at u = (first_u + i) * spacing, v = (first_v + j) * spacing, storage index j * nx + i;
//   cell (i, j) has the nodes (i, j) (i+1, j) (i, j+1) (i+1, j+1)
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

namespace sparsha::scene {

/// The outward directions of charts in the grid frame.
enum class Side : std::uint8_t { right, left, up, down, front, back };
inline constexpr std::size_t kSides = 6;

/// Which axes of the grid frame are u, v and w of a side, and the sign of w. u and v are never reversed.
struct SideAxes {
  int u, v, w;
  double sign;

  [[nodiscard]] static constexpr SideAxes of(Side side) {
    const int w = static_cast<int>(side) / 2;
    const bool reversed = static_cast<int>(side) % 2 != 0;
    const int next = (w + 1) % 3;
    const int last = (w + 2) % 3;
    return reversed ? SideAxes{last, next, w, -1.0} : SideAxes{next, last, w, 1.0};
  }
  /// (u, v, w) -> (x, y, z).
  template <typename Vector>
  [[nodiscard]] Vector to_grid(const Vector& chart) const {
    Vector p;
    p[u] = chart[0];
    p[v] = chart[1];
    p[w] = static_cast<typename Vector::Scalar>(sign) * chart[2];
    return p;
  }
  /// (x, y, z) -> (u, v, w).
  template <typename Vector>
  [[nodiscard]] Vector to_chart(const Vector& grid) const {
    return Vector(grid[u], grid[v], static_cast<typename Vector::Scalar>(sign) * grid[w]);
  }
};

/// One connected layer.
struct Sheet {
  /// Bits of a node's mask.
  enum Mask : std::uint8_t {
    kMeasured = 1,
    kCell = 2,  ///< the cell whose lowest node this is: its four nodes are measured and connected
  };

  Side side = Side::front;
  int first_u = 0, first_v = 0;  ///< node (0, 0), in spacings from the charts' origin
  int nx = 0, ny = 0;
  std::vector<float> height_m;          ///< w of the surface relative to the charts' origin; NaN where not measured
  std::vector<float> slope_u, slope_v;  ///< dw/du and dw/dv of the measured surface; NaN where not measured
  std::vector<std::uint8_t> mask;
  std::vector<float> texture_m;  ///< of the surface before its envelope, along the normal; NaN as above; empty: none
  std::vector<float> curvature_per_m;      ///< of the texture; NaN also where nothing tells it; empty: none
  std::vector<std::uint32_t> colour_rgba;  ///< 0xAABBGGRR; 0 where no point near has one; empty: none
  std::vector<float> intensity;            ///< NaN where no point near has one; empty: none
  std::vector<float> error_m;  ///< mean distance of the scans' points about it; NaN where none is near; empty: none

  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny); }
  [[nodiscard]] std::size_t index(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
  }
  [[nodiscard]] bool measured(std::size_t node) const { return (mask[node] & kMeasured) != 0; }
  /// The envelope's height at a measured node, which lies `texture_m` before it along its normal. Requires a texture.
  [[nodiscard]] float envelope_m(std::size_t node) const {
    return height_m[node] - texture_m[node] * std::hypot(1.0F, slope_u[node], slope_v[node]);
  }
};

/// All sheets of an object: by side, then by their first node. Grid frame, metres.
struct Charts {
  double spacing_m = 0.0;
  Eigen::Vector3d origin_m = Eigen::Vector3d::Zero();
  std::vector<Sheet> sheets;

  [[nodiscard]] std::uint64_t measured_nodes() const {
    std::uint64_t count = 0;
    for (const Sheet& sheet : sheets) {
      for (std::size_t node = 0; node < sheet.count(); ++node) count += sheet.measured(node) ? 1 : 0;
    }
    return count;
  }

  /// Place of a node relative to origin_m. Requires that it is measured.
  [[nodiscard]] Eigen::Vector3d place_m(const Sheet& sheet, int i, int j) const {
    const double height = static_cast<double>(sheet.height_m[sheet.index(i, j)]);
    return SideAxes::of(sheet.side)
        .to_grid(Eigen::Vector3d((sheet.first_u + i) * spacing_m, (sheet.first_v + j) * spacing_m, height));
  }
  /// Outward unit normal of the measured surface at a node. Requires that it is measured.
  [[nodiscard]] static Eigen::Vector3d normal(const Sheet& sheet, int i, int j) {
    const std::size_t node = sheet.index(i, j);
    const Eigen::Vector3d n(-static_cast<double>(sheet.slope_u[node]), -static_cast<double>(sheet.slope_v[node]), 1.0);
    return SideAxes::of(sheet.side).to_grid(Eigen::Vector3d(n.normalized()));
  }
};

}  // namespace sparsha::scene
