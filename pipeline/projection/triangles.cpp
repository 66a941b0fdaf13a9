// Rasterization with edge functions evaluated alike from both sides of an edge.
#include "pipeline/projection/triangles.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace sparsha::pipeline {
namespace {

constexpr int kRowsPerBand = 32;

struct Vertex {
  double x, y, z;
};

// A node that an outer edge passes by as closely as coordinates are rounded: the mesh was made on the node's own
// lattice.
struct NearNode {
  std::size_t node;
  float height_m;
  std::uint32_t face;
};

// How far rounding to float32, before and after the turn, may have moved a corner.
double rounding_m(double x, double y) { return 0x1p-22 * std::max(std::abs(x), std::abs(y)); }

// Twice the signed area of (a, b, p). Always computed from the lexicographically lower end, so that the two triangles
// of an edge get exactly opposite values.
double edge(const Vertex& a, const Vertex& b, double x, double y) {
  const bool swapped = a.x != b.x ? a.x > b.x : a.y > b.y;
  const Vertex& p = swapped ? b : a;
  const Vertex& q = swapped ? a : b;
  const double value = (q.x - p.x) * (y - p.y) - (q.y - p.y) * (x - p.x);
  return swapped ? -value : value;
}

class Rasterizer {
 public:
  Rasterizer(const BinLattice& lattice, TriangleHeights& out) : lattice_(lattice), out_(out) {}

  // Rows [first, last] of triangle `face`.
  void draw(const std::array<Vertex, 3>& t, std::uint32_t face, int first, int last) {
    const double area = edge(t[0], t[1], t[2].x, t[2].y);
    const double rounding =
        std::max({rounding_m(t[0].x, t[0].y), rounding_m(t[1].x, t[1].y), rounding_m(t[2].x, t[2].y)});
    const auto [low, high] = std::minmax({t[0].y, t[1].y, t[2].y});
    for (int j = first; j <= last; ++j) {
      const double y = lattice_.y0_m + j * lattice_.spacing_m;
      const auto [i0, i1] = columns(t, std::clamp(y, low, high));
      for (int i = i0; i <= i1; ++i) {
        const double x = lattice_.x0_m + i * lattice_.spacing_m;
        double z = 0.0;
        if (area != 0.0 ? inside(t, area, x, y, z) : on_edge(t, x, y, z)) {
          keep(i, j, z, face);
        } else if (area != 0.0 && passes_by(t, area, rounding, x, y, z)) {
          near_.push_back({node_of(i, j), static_cast<float>(z), face});
        }
      }
    }
  }

  // Nodes that no triangle contains take the highest of those that pass by.
  void finish() {
    std::erase_if(near_, [&](const NearNode& n) { return out_.face[n.node] != TriangleHeights::kNone; });
    for (const NearNode& n : near_) keep(n.node, n.height_m, n.face);
    near_.clear();
  }

 private:
  // Columns that the triangle can reach on the line y, one to spare on each side.
  [[nodiscard]] std::pair<int, int> columns(const std::array<Vertex, 3>& t, double y) const {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vertex& a = t[k];
      const Vertex& b = t[(k + 1) % 3];
      if ((a.y < y && b.y < y) || (a.y > y && b.y > y)) continue;
      const double along = a.y == b.y ? 0.0 : std::clamp((y - a.y) / (b.y - a.y), 0.0, 1.0);
      const double x = a.x + along * (b.x - a.x);
      low = std::min({low, x, a.y == b.y ? b.x : x});
      high = std::max({high, x, a.y == b.y ? b.x : x});
    }
    if (!(low <= high)) return {0, -1};
    const double first = std::floor((low - lattice_.x0_m) / lattice_.spacing_m) - 1.0;
    const double last = std::ceil((high - lattice_.x0_m) / lattice_.spacing_m) + 1.0;
    const double most = lattice_.nx - 1;
    if (first > most || last < 0.0) return {0, -1};
    return {static_cast<int>(std::max(0.0, first)), static_cast<int>(std::min(most, last))};
  }

  static bool inside(const std::array<Vertex, 3>& t, double area, double x, double y, double& z) {
    const double a = edge(t[1], t[2], x, y);
    const double b = edge(t[2], t[0], x, y);
    const double c = edge(t[0], t[1], x, y);
    if (area > 0.0 ? (a < 0.0 || b < 0.0 || c < 0.0) : (a > 0.0 || b > 0.0 || c > 0.0)) return false;
    const double sum = a + b + c;
    if (sum == 0.0) return on_edge(t, x, y, z);
    z = (a * t[0].z + b * t[1].z + c * t[2].z) / sum;
    return true;
  }

  // As inside(), for a node not farther than `rounding` outside of an edge; its height is within the corners'.
  static bool passes_by(const std::array<Vertex, 3>& t, double area, double rounding, double x, double y, double& z) {
    double sum = 0.0, product = 0.0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vertex& a = t[(k + 1) % 3];
      const Vertex& b = t[(k + 2) % 3];
      double value = edge(a, b, x, y);
      if (area > 0.0 ? value < 0.0 : value > 0.0) {
        const double length2 = (b.x - a.x) * (b.x - a.x) + (b.y - a.y) * (b.y - a.y);
        if (value * value > rounding * rounding * length2) return false;
        value = 0.0;
      }
      sum += value;
      product += value * t[k].z;
    }
    if (sum == 0.0) return false;
    z = product / sum;
    return true;
  }

  static bool on_edge(const std::array<Vertex, 3>& t, double x, double y, double& z) {
    bool found = false;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vertex& a = t[k];
      const Vertex& b = t[(k + 1) % 3];
      if (edge(a, b, x, y) != 0.0) continue;
      if (x < std::min(a.x, b.x) || x > std::max(a.x, b.x) || y < std::min(a.y, b.y) || y > std::max(a.y, b.y))
        continue;
      const double dx = b.x - a.x;
      const double dy = b.y - a.y;
      double height = std::max(a.z, b.z);
      if (dx != 0.0 || dy != 0.0) {
        const double along = std::abs(dx) > std::abs(dy) ? (x - a.x) / dx : (y - a.y) / dy;
        height = a.z + along * (b.z - a.z);
      }
      z = found ? std::max(z, height) : height;
      found = true;
    }
    return found;
  }

  [[nodiscard]] std::size_t node_of(int i, int j) const {
    return static_cast<std::size_t>(j) * static_cast<std::size_t>(lattice_.nx) + static_cast<std::size_t>(i);
  }
  void keep(int i, int j, double z, std::uint32_t face) { keep(node_of(i, j), static_cast<float>(z), face); }
  void keep(std::size_t node, float height, std::uint32_t face) {
    if (out_.face[node] != TriangleHeights::kNone && height <= out_.height_m[node]) return;
    out_.height_m[node] = height;
    out_.face[node] = face;
  }

  const BinLattice& lattice_;
  TriangleHeights& out_;
  std::vector<NearNode> near_;
};

}  // namespace

TriangleHeights project_triangles(const OrientedPoints& points, const std::vector<std::array<std::uint32_t, 3>>& faces,
                                  const BinLattice& lattice, ThreadPool& pool) {
  const std::size_t nodes = static_cast<std::size_t>(lattice.nx) * static_cast<std::size_t>(lattice.ny);
  TriangleHeights out;
  out.height_m.assign(nodes, std::numeric_limits<float>::quiet_NaN());
  out.face.assign(nodes, TriangleHeights::kNone);

  // Rows [first, last] of a face; last < first when it misses the lattice.
  const auto rows_of = [&](const std::array<std::uint32_t, 3>& f) -> std::pair<int, int> {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    double rounding = 0.0;
    for (const std::uint32_t v : f) {
      if (v >= points.count || !(points.x[v] < OrientedPoints::kFarAway)) return {0, -1};
      low = std::min(low, static_cast<double>(points.y[v]));
      high = std::max(high, static_cast<double>(points.y[v]));
      rounding = std::max(rounding, rounding_m(static_cast<double>(points.x[v]), static_cast<double>(points.y[v])));
    }
    const double slack = 1e-9 + rounding / lattice.spacing_m;
    const double first = std::ceil((low - lattice.y0_m) / lattice.spacing_m - slack);
    const double last = std::floor((high - lattice.y0_m) / lattice.spacing_m + slack);
    const double most = lattice.ny - 1;
    if (first > most || last < 0.0) return {0, -1};
    return {static_cast<int>(std::max(0.0, first)), static_cast<int>(std::min(most, last))};
  };

  const std::size_t bands = static_cast<std::size_t>((lattice.ny + kRowsPerBand - 1) / kRowsPerBand);
  std::vector<std::vector<std::uint32_t>> of_band(bands);
  for (std::size_t k = 0; k < faces.size(); ++k) {
    const auto [first, last] = rows_of(faces[k]);
    for (int band = first / kRowsPerBand; first <= last && band <= last / kRowsPerBand; ++band) {
      of_band[static_cast<std::size_t>(band)].push_back(static_cast<std::uint32_t>(k));
    }
  }
  pool.for_ranges(bands, 1, [&](std::size_t band, std::size_t) {
    Rasterizer rasterizer(lattice, out);
    const int row = static_cast<int>(band) * kRowsPerBand;
    for (const std::uint32_t k : of_band[band]) {
      const auto [first, last] = rows_of(faces[k]);
      std::array<Vertex, 3> t{};
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t v = faces[k][c];
        t[c] = {static_cast<double>(points.x[v]), static_cast<double>(points.y[v]), static_cast<double>(points.z[v])};
      }
      rasterizer.draw(t, k, std::max(first, row), std::min(last, row + kRowsPerBand - 1));
    }
    rasterizer.finish();
  });
  return out;
}

}  // namespace sparsha::pipeline
