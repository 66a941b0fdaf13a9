// Attributes are splatted from used points to the four nodes of their cell with bilinear weights.
#include "pipeline/grid/project_attributes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace sparsha::pipeline {
namespace {

constexpr double kWeightOne = 256.0;

// Up to four channels of an attribute per point, 0 to 255 or a value scaled to integers.
template <std::size_t Channels>
struct Sums {
  std::array<std::int64_t, Channels> value{};
  std::int64_t weight = 0;
};

// Corners of a mesh node's triangle as weights that add up to one.
std::array<double, 3> barycentric(const OrientedPoints& points, const std::array<std::uint32_t, 3>& f, double x,
                                  double y) {
  const auto px = [&](std::size_t c) { return static_cast<double>(points.x[f[c]]); };
  const auto py = [&](std::size_t c) { return static_cast<double>(points.y[f[c]]); };
  const auto area = [&](std::size_t a, std::size_t b) {
    return (px(b) - px(a)) * (y - py(a)) - (py(b) - py(a)) * (x - px(a));
  };
  std::array<double, 3> w{area(1, 2), area(2, 0), area(0, 1)};
  const double sum = w[0] + w[1] + w[2];
  if (sum == 0.0) return {1.0 / 3.0, 1.0 / 3.0, 1.0 / 3.0};
  for (double& part : w) part /= sum;
  return w;
}

template <std::size_t Channels, typename Read, typename Write>
void splat(const Cloud& cloud, const OrientedPoints& points, const BinLattice& lattice, const TriangleHeights& mesh,
           const Projection& projection, Read read, Write write) {
  const Lattice& nodes = projection.grid.lattice;
  std::vector<Sums<Channels>> sums(nodes.count());
  for (std::size_t k = 0; k < points.count; ++k) {
    if (projection.fate[k] != PointFate::used) continue;
    const double u = (static_cast<double>(points.x[k]) - lattice.x0_m) / lattice.spacing_m;
    const double v = (static_cast<double>(points.y[k]) - lattice.y0_m) / lattice.spacing_m;
    const int i = static_cast<int>(std::floor(u));
    const int j = static_cast<int>(std::floor(v));
    const std::array<std::int64_t, Channels> value = read(k);
    for (int b = std::max(0, j); b <= std::min(nodes.ny - 1, j + 1); ++b) {
      for (int a = std::max(0, i); a <= std::min(nodes.nx - 1, i + 1); ++a) {
        const double near = std::max(0.0, 1.0 - std::abs(u - a)) * std::max(0.0, 1.0 - std::abs(v - b));
        const auto weight = static_cast<std::int64_t>(std::lround(near * kWeightOne)) + 1;
        Sums<Channels>& sum = sums[nodes.index(a, b)];
        for (std::size_t c = 0; c < Channels; ++c) sum.value[c] += weight * value[c];
        sum.weight += weight;
      }
    }
  }
  for (int j = 0; j < nodes.ny; ++j) {
    for (int i = 0; i < nodes.nx; ++i) {
      const std::size_t node = nodes.index(i, j);
      if (projection.grid.state[node] != NodeState::measured) continue;
      std::array<double, Channels> value{};
      const bool on_mesh = !mesh.face.empty() && mesh.face[node] != TriangleHeights::kNone &&
                           projection.grid.height_m[node] == mesh.height_m[node];
      if (on_mesh) {
        const std::array<std::uint32_t, 3>& f = cloud.faces[mesh.face[node]];
        const std::array<double, 3> w =
            barycentric(points, f, lattice.x0_m + i * lattice.spacing_m, lattice.y0_m + j * lattice.spacing_m);
        for (std::size_t corner = 0; corner < 3; ++corner) {
          const std::array<std::int64_t, Channels> part = read(f[corner]);
          for (std::size_t c = 0; c < Channels; ++c) value[c] += w[corner] * static_cast<double>(part[c]);
        }
      } else if (sums[node].weight > 0) {
        for (std::size_t c = 0; c < Channels; ++c) {
          value[c] = static_cast<double>(sums[node].value[c]) / static_cast<double>(sums[node].weight);
        }
      } else {
        continue;
      }
      write(node, value);
    }
  }
}

}  // namespace

void project_attributes(const Cloud& cloud, const OrientedPoints& points, const BinLattice& lattice,
                        const TriangleHeights& mesh, const GridConfig& config, ThreadPool&, Projection& projection) {
  if (config.colour && cloud.rgba.size() == points.count) {
    projection.colour_rgba.assign(projection.grid.lattice.count(), 0);
    splat<4>(
        cloud, points, lattice, mesh, projection,
        [&](std::size_t k) {
          const std::uint32_t rgba = cloud.rgba[k];
          return std::array<std::int64_t, 4>{rgba & 255U, (rgba >> 8U) & 255U, (rgba >> 16U) & 255U, rgba >> 24U};
        },
        [&](std::size_t node, const std::array<double, 4>& value) {
          std::uint32_t rgba = 0;
          for (std::size_t c = 0; c < 4; ++c) {
            const auto level = static_cast<std::uint32_t>(std::lround(std::clamp(value[c], 0.0, 255.0)));
            rgba |= level << (8U * static_cast<std::uint32_t>(c));
          }
          projection.colour_rgba[node] = rgba;
        });
  }
  if (config.intensity && cloud.intensity.size() == points.count) {
    float largest = 0.0F;
    for (const float value : cloud.intensity) {
      if (std::isfinite(value)) largest = std::max(largest, std::abs(value));
    }
    const double scale = largest > 0.0F ? 16777216.0 / static_cast<double>(largest) : 1.0;
    projection.intensity.assign(projection.grid.lattice.count(), std::numeric_limits<float>::quiet_NaN());
    splat<1>(
        cloud, points, lattice, mesh, projection,
        [&](std::size_t k) {
          const float value = std::isfinite(cloud.intensity[k]) ? cloud.intensity[k] : 0.0F;
          return std::array<std::int64_t, 1>{std::llround(static_cast<double>(value) * scale)};
        },
        [&](std::size_t node, const std::array<double, 1>& value) {
          projection.intensity[node] = static_cast<float>(value[0] / scale);
        });
  }
}

}  // namespace sparsha::pipeline
