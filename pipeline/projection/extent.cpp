// Coarse occupancy finds the object among outliers; each side is then the outermost point with neighbours.
#include "pipeline/projection/extent.h"

#include <algorithm>
#include <array>
#include <bitset>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include <Eigen/Geometry>

#include "base/error.h"
#include "base/numbers/statistics.h"
#include "pipeline/projection/simd/kernels.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kPiece = 1U << 17U;
constexpr std::size_t kBatch = 1024;
constexpr int kMostCells = 128;

struct Box {
  double x0, y0, x1, y1;
  [[nodiscard]] double longer() const { return std::max(x1 - x0, y1 - y0); }
};

// Square cells over a box; cell (i, j) counts the points in it.
struct Occupancy {
  int nx = 1, ny = 1;
  double cell_m = 1.0;
  double per_m = 1.0;
  Box box{};
  std::vector<std::uint32_t> count;
  std::vector<std::uint32_t> around;  // sum of the 3x3 cells
  std::vector<std::uint8_t> kept;

  [[nodiscard]] std::size_t at(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i);
  }
  // -1 outside.
  [[nodiscard]] std::ptrdiff_t cell_of(float x, float y) const {
    const double u = (static_cast<double>(x) - box.x0) * per_m;
    const double v = (static_cast<double>(y) - box.y0) * per_m;
    if (!(u >= 0.0 && v >= 0.0 && u < nx && v < ny)) return -1;
    return static_cast<std::ptrdiff_t>(at(static_cast<int>(u), static_cast<int>(v)));
  }
};

Occupancy count_points(std::uint64_t points, const OrientedPieces& pieces, const Box& box, ThreadPool& pool) {
  Occupancy cells;
  cells.box = box;
  const double wanted = std::sqrt(static_cast<double>(points) / 8.0);
  const int side = std::clamp(static_cast<int>(wanted), 4, kMostCells);
  cells.cell_m = std::max(box.longer(), 1e-30) / side * (1.0 + 1e-6);
  cells.per_m = 1.0 / cells.cell_m;
  cells.nx = std::min(side, static_cast<int>((box.x1 - box.x0) / cells.cell_m) + 1);
  cells.ny = std::min(side, static_cast<int>((box.y1 - box.y0) / cells.cell_m) + 1);
  const std::size_t size = cells.at(0, cells.ny);
  cells.count.assign(size, 0);
  // One band of all rows; points outside go to one cell more.
  BandKernel kernel;
  kernel.x_shift_m = static_cast<float>(cells.box.x0);
  kernel.y_shift_m = static_cast<float>(cells.box.y0);
  kernel.per_m = static_cast<float>(cells.per_m);
  kernel.right = static_cast<float>(cells.nx);
  kernel.top = static_cast<float>(cells.ny);
  kernel.row_length = cells.nx;
  kernel.band_rows_log2 = 31;
  kernel.row_mask = std::numeric_limits<std::int32_t>::max();
  kernel.nowhere = static_cast<std::int32_t>(size);
  pieces([&](const OrientedPoints& piece) {
    std::vector<std::vector<std::uint32_t>> partial((piece.count + kPiece - 1) / kPiece);
    pool.for_ranges(piece.count, kPiece, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t>& mine = partial[begin / kPiece];
      mine.assign(size + 1, 0);
      std::array<std::int32_t, kBatch> band;
      std::array<std::int32_t, kBatch> cell;
      for (std::size_t first = begin; first < end; first += kBatch) {
        const std::size_t batch = std::min(kBatch, end - first);
        fastest_kernels().index_bands(kernel, piece.x.get() + first, piece.y.get() + first, batch, band.data(),
                                      cell.data());
        for (std::size_t k = 0; k < batch; ++k) ++mine[static_cast<std::size_t>(band[k] + cell[k])];
      }
    });
    for (const std::vector<std::uint32_t>& mine : partial) {
      for (std::size_t c = 0; c < size; ++c) cells.count[c] += mine[c];
    }
  });
  pieces.add_up(cells.count);
  return cells;
}

// The sums of the 3x3 cells around each; returns those around cells that hold points.
std::vector<std::uint32_t> sum_around(Occupancy& cells) {
  cells.around.resize(cells.count.size());
  std::vector<std::uint32_t> occupied;
  const auto nx = static_cast<std::size_t>(cells.nx);
  std::vector<std::uint32_t> column(nx + 2, 0);  // sums of three rows
  for (int j = 0; j < cells.ny; ++j) {
    std::fill(column.begin(), column.end(), 0U);
    for (int b = std::max(0, j - 1); b <= std::min(cells.ny - 1, j + 1); ++b) {
      for (std::size_t i = 0; i < nx; ++i) column[i + 1] += cells.count[cells.at(0, b) + i];
    }
    for (std::size_t i = 0; i < nx; ++i) {
      const std::size_t c = cells.at(0, j) + i;
      cells.around[c] = column[i] + column[i + 1] + column[i + 2];
      if (cells.count[c] > 0) occupied.push_back(cells.around[c]);
    }
  }
  return occupied;
}

// Keeps cells whose 3x3 neighbourhood is not nearly empty, then drops small groups that stand apart.
void keep_supported_cells(Occupancy& cells, std::uint64_t points) {
  std::vector<std::uint32_t> occupied = sum_around(cells);
  cells.kept.assign(cells.count.size(), 0);
  if (occupied.empty()) return;
  const std::uint32_t middle = median(occupied);
  const std::uint32_t least = std::max(std::min<std::uint32_t>(3, middle), middle / 64);
  for (std::size_t c = 0; c < cells.count.size(); ++c) {
    cells.kept[c] = cells.count[c] > 0 && cells.around[c] >= least ? 1 : 0;
  }

  const std::uint64_t few = points / 1000;
  std::vector<std::size_t> group;
  std::vector<bool> seen(cells.count.size(), false);
  for (std::size_t first = 0; first < seen.size(); ++first) {
    if (cells.kept[first] == 0 || seen[first]) continue;
    group.assign(1, first);
    seen[first] = true;
    std::uint64_t held = 0;
    for (std::size_t k = 0; k < group.size(); ++k) {
      held += cells.count[group[k]];
      const int i = static_cast<int>(group[k] % static_cast<std::size_t>(cells.nx));
      const int j = static_cast<int>(group[k] / static_cast<std::size_t>(cells.nx));
      for (int b = std::max(0, j - 2); b <= std::min(cells.ny - 1, j + 2); ++b) {
        for (int a = std::max(0, i - 2); a <= std::min(cells.nx - 1, i + 2); ++a) {
          const std::size_t c = cells.at(a, b);
          if (cells.kept[c] != 0 && !seen[c]) {
            seen[c] = true;
            group.push_back(c);
          }
        }
      }
    }
    if (held <= few) {
      for (const std::size_t c : group) cells.kept[c] = 0;
    }
  }
}

// Box of the kept cells, in cells: [i0, i1] x [j0, j1].
struct CellBox {
  int i0 = 1 << 30, j0 = 1 << 30, i1 = -1, j1 = -1;
};

CellBox box_of_kept(const Occupancy& cells) {
  CellBox box;
  for (int j = 0; j < cells.ny; ++j) {
    for (int i = 0; i < cells.nx; ++i) {
      if (cells.kept[cells.at(i, j)] == 0) continue;
      box.i0 = std::min(box.i0, i);
      box.j0 = std::min(box.j0, j);
      box.i1 = std::max(box.i1, i);
      box.j1 = std::max(box.j1, j);
    }
  }
  return box;
}

// A point at the border and its two local point spacings.
struct BorderPoint {
  std::array<float, 3> place;
  float reach_m;
};

constexpr std::size_t kTries = 256;  // outermost points that are asked for neighbours

// The points of one side, those that can be a candidate or a neighbour of one.
struct Strip {
  std::size_t axis;  // 0 x, 1 y
  float sign;        // of the outward direction
  float most_reach_m = 0.0F;
  std::size_t limit = 1U << 20U;  // when it is exceeded, points that came to lie too far inside go
  std::vector<BorderPoint> points;

  Strip(std::size_t a, float s) : axis(a), sign(s) {}

  [[nodiscard]] bool outer(const BorderPoint& a, const BorderPoint& b) const {
    const float pa = sign * a.place[axis];
    const float pb = sign * b.place[axis];
    return pa != pb ? pa > pb : a.place < b.place;
  }
  void prune() {
    if (points.size() <= limit) return;
    const auto last = points.begin() + static_cast<std::ptrdiff_t>(kTries) - 1;
    std::nth_element(points.begin(), last, points.end(),
                     [&](const BorderPoint& a, const BorderPoint& b) { return outer(a, b); });
    // A little more than the reach, since differences of floats round.
    const float least = sign * last->place[axis] - 1.001F * most_reach_m;
    std::erase_if(points, [&](const BorderPoint& p) { return sign * p.place[axis] < least; });
    limit = std::max(limit, 2 * points.size());
  }
};

// The supported points of the two outermost columns and rows of kept cells: left, right, bottom, top.
std::array<Strip, 4> border_strips(const OrientedPieces& pieces, const Occupancy& cells, const CellBox& kept,
                                   ThreadPool& pool) {
  // Most points are inside by a plain comparison; a little to spare keeps its rounding harmless.
  const auto border = [](double corner, double cells_m) { return static_cast<float>(corner + cells_m); };
  BorderKernel inner;
  inner.left_m = border(cells.box.x0, (kept.i0 + 2.05) * cells.cell_m);
  inner.right_m = border(cells.box.x0, (kept.i1 - 1.05) * cells.cell_m);
  inner.bottom_m = border(cells.box.y0, (kept.j0 + 2.05) * cells.cell_m);
  inner.top_m = border(cells.box.y0, (kept.j1 - 1.05) * cells.cell_m);
  // Two local point spacings of the points in a cell.
  const auto reach_of = [&](std::size_t c) {
    return static_cast<float>(6.0 * cells.cell_m / std::sqrt(static_cast<double>(cells.around[c])));
  };
  std::vector<std::bitset<4>> sides_of(cells.kept.size());  // those that a kept cell is at
  std::array<Strip, 4> strips{Strip(0, -1.0F), Strip(0, 1.0F), Strip(1, -1.0F), Strip(1, 1.0F)};
  for (int j = kept.j0; j <= kept.j1; ++j) {
    for (int i = kept.i0; i <= kept.i1; ++i) {
      const std::size_t c = cells.at(i, j);
      if (cells.kept[c] == 0) continue;
      const std::array<bool, 4> at_side{i <= kept.i0 + 1, i >= kept.i1 - 1, j <= kept.j0 + 1, j >= kept.j1 - 1};
      for (std::size_t side = 0; side < 4; ++side) {
        if (!at_side[side]) continue;
        sides_of[c].set(side);
        strips[side].most_reach_m = std::max(strips[side].most_reach_m, reach_of(c));
      }
    }
  }
  pieces([&](const OrientedPoints& points) {
    std::vector<std::array<std::vector<BorderPoint>, 4>> parts((points.count + kPiece - 1) / kPiece);
    pool.for_ranges(points.count, kPiece, [&](std::size_t begin, std::size_t end) {
      std::array<std::uint32_t, kBatch> drawn;
      for (std::size_t first = begin; first < end; first += kBatch) {
        const std::size_t found = fastest_kernels().draw_border(inner, points.x.get() + first, points.y.get() + first,
                                                                std::min(kBatch, end - first), drawn.data());
        for (std::size_t d = 0; d < found; ++d) {
          const std::size_t k = first + drawn[d];
          const std::ptrdiff_t cell = cells.cell_of(points.x[k], points.y[k]);
          if (cell < 0) continue;
          const auto c = static_cast<std::size_t>(cell);
          if (sides_of[c].none()) continue;
          const BorderPoint point{{points.x[k], points.y[k], points.z[k]}, reach_of(c)};
          for (std::size_t side = 0; side < 4; ++side) {
            if (sides_of[c][side]) parts[begin / kPiece][side].push_back(point);
          }
        }
      }
    });
    for (const std::array<std::vector<BorderPoint>, 4>& part : parts) {
      for (std::size_t side = 0; side < 4; ++side) {
        strips[side].points.insert(strips[side].points.end(), part[side].begin(), part[side].end());
        strips[side].prune();
      }
    }
  });
  for (Strip& strip : strips) {
    pieces.join(strip.points);
    strip.prune();
  }
  return strips;
}

// Outermost coordinate of a point that has at least three neighbours in reach.
double outermost_supported(Strip& strip, double otherwise) {
  const std::size_t tries = std::min(strip.points.size(), kTries);
  std::partial_sort(strip.points.begin(), strip.points.begin() + static_cast<std::ptrdiff_t>(tries), strip.points.end(),
                    [&](const BorderPoint& a, const BorderPoint& b) { return strip.outer(a, b); });
  for (std::size_t t = 0; t < tries; ++t) {
    const std::array<float, 3>& p = strip.points[t].place;
    const float reach = strip.points[t].reach_m;
    int neighbours = -1;  // the point finds itself
    for (const BorderPoint& q : strip.points) {
      const float dx = q.place[0] - p[0];
      const float dy = q.place[1] - p[1];
      const float dz = (q.place[2] - p[2]) / 1.5F;
      if (dx * dx + dy * dy + dz * dz <= reach * reach && ++neighbours == 3) break;
    }
    if (neighbours >= 3) return static_cast<double>(p[strip.axis]);
  }
  return otherwise;
}

// What a point is to the faces: of none, inside or near the object, or far from it and held by slivers and crumbs only.
enum class VertexRole : std::uint8_t { none, near, stray };

// Area of a triangle, and whether it is compact: a vertex that strayed pulls slivers behind it.
struct TriangleShape {
  double area_m2 = 0.0;
  bool compact = false;
};

TriangleShape shape_of(const OrientedPoints& points, const std::array<std::uint32_t, 3>& face) {
  const auto corner = [&](std::size_t k) {
    const std::uint32_t v = face[k];
    return Eigen::Vector3d(points.x[v], points.y[v], points.z[v]);
  };
  const Eigen::Vector3d a = corner(1) - corner(0);
  const Eigen::Vector3d b = corner(2) - corner(0);
  const double doubled = a.cross(b).norm();
  const double longest = std::max({a.norm(), b.norm(), (b - a).norm()});
  constexpr double kFlattest = 0.05;  // height over longest side
  return {0.5 * doubled, doubled > kFlattest * longest * longest};
}

std::vector<VertexRole> roles_of_vertices(const OrientedPoints& points,
                                          const std::vector<std::array<std::uint32_t, 3>>& faces,
                                          const Extent& extent) {
  const double reach = std::max(extent.width_m(), extent.height_m());
  const auto is_near = [&](std::size_t v) {
    const auto x = static_cast<double>(points.x[v]);
    const auto y = static_cast<double>(points.y[v]);
    return x >= extent.xmin_m - reach && x <= extent.xmax_m + reach && y >= extent.ymin_m - reach &&
           y <= extent.ymax_m + reach;
  };
  std::vector<VertexRole> roles(points.count, VertexRole::none);
  bool any_stray = false;
  for (const std::array<std::uint32_t, 3>& face : faces) {
    for (const std::uint32_t v : face) {
      if (!(points.x[v] < OrientedPoints::kFarAway) || roles[v] != VertexRole::none) continue;
      roles[v] = is_near(v) ? VertexRole::near : VertexRole::stray;
      any_stray = any_stray || roles[v] == VertexRole::stray;
    }
  }
  if (!any_stray) return roles;
  std::vector<TriangleShape> shapes(faces.size());
  double compact_m2 = 0.0;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    const bool known =
        std::all_of(faces[f].begin(), faces[f].end(), [&](std::uint32_t v) { return roles[v] != VertexRole::none; });
    if (known) shapes[f] = shape_of(points, faces[f]);
    if (shapes[f].compact) compact_m2 += shapes[f].area_m2;
  }
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (!shapes[f].compact || shapes[f].area_m2 < 1e-3 * compact_m2) continue;
    for (const std::uint32_t v : faces[f]) roles[v] = VertexRole::near;
  }
  return roles;
}

}  // namespace

Extent supported_extent(const PointTotals& points, const OrientedPieces& pieces, ThreadPool& pool) {
  if (!(points.min_m.x() <= points.max_m.x())) throw input_error({}, "no points to project", "at least four");
  const auto wide = [](float v) { return static_cast<double>(v); };
  Box box{wide(points.min_m.x()), wide(points.min_m.y()), wide(points.max_m.x()), wide(points.max_m.y())};
  Occupancy cells;
  CellBox kept;
  for (int zoom = 0; zoom < 64; ++zoom) {
    cells = count_points(points.count, pieces, box, pool);
    keep_supported_cells(cells, points.count);
    kept = box_of_kept(cells);
    if (kept.i1 < 0) break;
    const Box inner{box.x0 + (kept.i0 - 1) * cells.cell_m, box.y0 + (kept.j0 - 1) * cells.cell_m,
                    box.x0 + (kept.i1 + 2) * cells.cell_m, box.y0 + (kept.j1 + 2) * cells.cell_m};
    if (inner.longer() > 0.5 * box.longer() || box.longer() <= 0.0) break;
    box = inner;
  }
  Extent extent{box.x0, box.y0, box.x1, box.y1, box.longer() * box.longer(), points.count, 0};
  if (kept.i1 >= 0) {
    extent.covered_area_m2 = 0.0;
    extent.supported = 0;
    for (std::size_t c = 0; c < cells.kept.size(); ++c) {
      if (cells.kept[c] == 0) continue;
      extent.covered_area_m2 += cells.cell_m * cells.cell_m;
      extent.supported += cells.count[c];
    }
    std::array<Strip, 4> strips = border_strips(pieces, cells, kept, pool);
    const auto cell_x = [&](int i) { return box.x0 + i * cells.cell_m; };
    const auto cell_y = [&](int j) { return box.y0 + j * cells.cell_m; };
    extent.xmin_m = outermost_supported(strips[0], std::max(box.x0, cell_x(kept.i0)));
    extent.xmax_m = outermost_supported(strips[1], std::min(box.x1, cell_x(kept.i1 + 1)));
    extent.ymin_m = outermost_supported(strips[2], std::max(box.y0, cell_y(kept.j0)));
    extent.ymax_m = outermost_supported(strips[3], std::min(box.y1, cell_y(kept.j1 + 1)));
    extent.xmax_m = std::max(extent.xmin_m, extent.xmax_m);
    extent.ymax_m = std::max(extent.ymin_m, extent.ymax_m);
  }
  return extent;
}

void include_faces(const OrientedPoints& points, const std::vector<std::array<std::uint32_t, 3>>& faces,
                   Extent& extent) {
  if (faces.empty()) return;
  extent.corners = 3 * faces.size();
  const std::vector<VertexRole> roles = roles_of_vertices(points, faces, extent);
  const auto vertices = std::count_if(roles.begin(), roles.end(), [](VertexRole r) { return r != VertexRole::none; });
  const auto stray = std::count(roles.begin(), roles.end(), VertexRole::stray);
  const bool leave_out = stray <= vertices / 1000;
  const auto wide = [](float v) { return static_cast<double>(v); };
  for (std::size_t k = 0; k < roles.size(); ++k) {
    if (roles[k] == VertexRole::none || (leave_out && roles[k] == VertexRole::stray)) continue;
    extent.xmin_m = std::min(extent.xmin_m, wide(points.x[k]));
    extent.xmax_m = std::max(extent.xmax_m, wide(points.x[k]));
    extent.ymin_m = std::min(extent.ymin_m, wide(points.y[k]));
    extent.ymax_m = std::max(extent.ymax_m, wide(points.y[k]));
  }
}

}  // namespace sparsha::pipeline
