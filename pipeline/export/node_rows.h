// Level 0 of a scene row by row, without holding it in memory.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/LU>

#include "base/threads/progress.h"
#include "scene/depth_grid.h"
#include "scene/frame/unrolling.h"
#include "scene/scene.h"

namespace sparsha::pipeline {

enum class Nodes {
  measured,
  known,    ///< filled ones, too
  of_cells  ///< known, and a corner of a cell with four known corners: of a mesh without loose vertices
};

/// Reads bands of rows; asked for rows in order it touches each once, those between bands twice.
class NodeRows {
 public:
  NodeRows(const scene::Scene& scene, Nodes nodes);

  [[nodiscard]] const scene::Lattice& lattice() const { return lattice_; }
  /// Whether node (i, j) is exported; j may not go back by more than a band.
  [[nodiscard]] bool known(int i, int j);
  /// Node (i, j) in the grid frame, metres.
  [[nodiscard]] Eigen::Vector3d grid_m(int i, int j);
  /// A place of the grid frame in the scan frame, metres.
  [[nodiscard]] Eigen::Vector3d scan_m(const Eigen::Vector3d& grid_m) const;
  /// 0xAABBGGRR; scenes with colour only.
  [[nodiscard]] std::uint32_t rgba(int i, int j);

 private:
  static constexpr int kBand = 256;  // rows
  void load(int j);
  std::size_t locate(int i, int j);
  /// Of a row in memory.
  [[nodiscard]] bool chosen(int i, int j) const;
  /// Of an unrolled scene, whether column and row lie once around, and not in what is repeated beyond the seam.
  [[nodiscard]] bool once_around(int i, int j) const;

  const scene::Scene& scene_;
  Nodes nodes_;
  std::optional<scene::Unrolling> unrolling_;
  scene::Lattice lattice_;
  int first_ = 0, rows_ = 0;  // that the band is asked for; it has the rows beside them, too
  int lowest_ = 0;            // in the band
  scene::Layers band_;
};

/// Exported vertices and triangles in the order in which all mesh formats write them: by rows from below, and in a row
/// from the left; triangles counter-clockwise as seen by the viewer, in the scan frame too.
struct MeshCounts {
  std::uint64_t vertices = 0;
  std::uint64_t triangles = 0;
};
[[nodiscard]] MeshCounts count_mesh(const scene::Scene& scene, Nodes nodes, Progress& progress);

/// Calls vertex(scan position, rgba) for each.
template <typename Vertex>
void for_each_vertex(const scene::Scene& scene, Nodes nodes, Progress& progress, Vertex&& vertex) {
  NodeRows rows(scene, nodes);
  const scene::Lattice& lattice = rows.lattice();
  const bool colour = scene.description().has_colour;
  for (int j = 0; j < lattice.ny; ++j) {
    if (j % 64 == 0) progress.at(static_cast<double>(j) / lattice.ny);
    for (int i = 0; i < lattice.nx; ++i) {
      if (!rows.known(i, j)) continue;
      const Eigen::Vector3d p = rows.grid_m(i, j);
      vertex(rows.scan_m(p), colour ? rows.rgba(i, j) : std::uint32_t{0});
    }
  }
}

/// Calls triangle(a, b, c) with numbers of the vertices Nodes::of_cells from 0. A cell whose four nodes are known has
/// two, cut along its shorter diagonal; a cell with three known nodes has none: the grid does not say what lies there.
template <typename Triangle>
void for_each_triangle(const scene::Scene& scene, Progress& progress, Triangle&& triangle) {
  NodeRows rows(scene, Nodes::of_cells);
  const scene::Lattice& lattice = rows.lattice();
  const bool mirrored = scene.description().scan_from_grid.topLeftCorner<3, 3>().determinant() < 0.0;
  constexpr std::uint64_t kNone = ~std::uint64_t{0};
  const auto nx = static_cast<std::size_t>(lattice.nx);
  std::vector<std::uint64_t> low(nx, kNone), high(nx, kNone);
  std::vector<double> low_z(nx), high_z(nx);
  std::uint64_t next = 0;
  for (int j = 0; j < lattice.ny; ++j) {
    if (j % 64 == 0) progress.at(static_cast<double>(j) / lattice.ny);
    std::swap(low, high);
    std::swap(low_z, high_z);
    for (int i = 0; i < lattice.nx; ++i) {
      const bool known = rows.known(i, j);
      high[static_cast<std::size_t>(i)] = known ? next++ : kNone;
      if (known) high_z[static_cast<std::size_t>(i)] = rows.grid_m(i, j).z();
    }
    if (j == 0) continue;
    for (std::size_t i = 0; i + 1 < nx; ++i) {
      if (low[i] == kNone || low[i + 1] == kNone || high[i] == kNone || high[i + 1] == kNone) continue;
      const double rising = std::abs(high_z[i + 1] - low_z[i]);
      const double falling = std::abs(high_z[i] - low_z[i + 1]);
      const auto emit = [&](std::uint64_t a, std::uint64_t b, std::uint64_t c) {
        mirrored ? triangle(a, c, b) : triangle(a, b, c);
      };
      if (rising <= falling) {
        emit(low[i], low[i + 1], high[i + 1]);
        emit(low[i], high[i + 1], high[i]);
      } else {
        emit(low[i], low[i + 1], high[i]);
        emit(low[i + 1], high[i + 1], high[i]);
      }
    }
  }
}

}  // namespace sparsha::pipeline
