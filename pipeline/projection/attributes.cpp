// Attributes are splatted from used points to the four nodes of their cell with bilinear weights.
#include "pipeline/projection/attributes.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace sparsha::pipeline {
namespace {

constexpr double kWeightOne = 256.0;

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

// Of a colour; nothing for a point that has none.
std::optional<std::array<std::int64_t, 4>> channels(std::uint32_t rgba) {
  if (rgba == kNoColour) return std::nullopt;
  return std::array<std::int64_t, 4>{rgba & 255U, (rgba >> 8U) & 255U, (rgba >> 16U) & 255U, rgba >> 24U};
}

}  // namespace

AttributeSums::AttributeSums(const scene::Lattice& nodes, const BinLattice& lattice, bool colour, bool intensity,
                             float largest_intensity)
    : nodes_(nodes),
      lattice_(lattice),
      intensity_scale_(largest_intensity),
      colour_(colour ? nodes.count() : 0),
      intensity_(intensity ? nodes.count() : 0) {}

std::optional<std::array<std::int64_t, 1>> AttributeSums::scaled(float intensity) const {
  const std::optional<std::int64_t> value = intensity_scale_.of(intensity);
  if (!value) return std::nullopt;
  return std::array<std::int64_t, 1>{*value};
}

template <std::size_t Channels, typename Read>
void AttributeSums::splat(std::vector<Sum<Channels>>& sums, const OrientedPoints& points, const PointClass* point_class,
                          const Read& read) const {
  for (std::size_t k = 0; k < points.count; ++k) {
    if (point_class[k] != PointClass::used) continue;
    const std::optional<std::array<std::int64_t, Channels>> value = read(k);
    if (!value) continue;
    const double u = (static_cast<double>(points.x[k]) - lattice_.x0_m) / lattice_.spacing_m;
    const double v = (static_cast<double>(points.y[k]) - lattice_.y0_m) / lattice_.spacing_m;
    const int i = static_cast<int>(std::floor(u));
    const int j = static_cast<int>(std::floor(v));
    for (int b = std::max(0, j); b <= std::min(nodes_.ny - 1, j + 1); ++b) {
      for (int a = std::max(0, i); a <= std::min(nodes_.nx - 1, i + 1); ++a) {
        const double near = std::max(0.0, 1.0 - std::abs(u - a)) * std::max(0.0, 1.0 - std::abs(v - b));
        const auto weight = static_cast<std::int64_t>(std::lround(near * kWeightOne)) + 1;
        Sum<Channels>& sum = sums[nodes_.index(a, b)];
        for (std::size_t c = 0; c < Channels; ++c) sum.value[c] += weight * (*value)[c];
        sum.weight += weight;
      }
    }
  }
}

void AttributeSums::add(const OrientedPoints& points, const PointClass* point_class, const std::uint32_t* rgba,
                        const float* intensity) {
  if (!colour_.empty()) splat<4>(colour_, points, point_class, [&](std::size_t k) { return channels(rgba[k]); });
  if (!intensity_.empty())
    splat<1>(intensity_, points, point_class, [&](std::size_t k) { return scaled(intensity[k]); });
}

template <std::size_t Channels, typename OnMesh, typename Write>
void AttributeSums::each_node(const std::vector<Sum<Channels>>& sums, const Projection& projection,
                              const OnMesh& on_mesh, const Write& write) const {
  for (int j = 0; j < nodes_.ny; ++j) {
    for (int i = 0; i < nodes_.nx; ++i) {
      const std::size_t node = nodes_.index(i, j);
      if (projection.grid.state[node] != scene::NodeState::measured) continue;
      std::array<double, Channels> value{};
      if (!on_mesh(i, j, value)) {
        if (sums[node].weight == 0) continue;
        for (std::size_t c = 0; c < Channels; ++c) {
          value[c] = static_cast<double>(sums[node].value[c]) / static_cast<double>(sums[node].weight);
        }
      }
      write(node, value);
    }
  }
}

template <typename ColourOnMesh, typename IntensityOnMesh>
void AttributeSums::write_all(Projection& projection, const ColourOnMesh& colour_on_mesh,
                              const IntensityOnMesh& intensity_on_mesh) const {
  if (!colour_.empty()) {
    projection.colour_rgba.assign(nodes_.count(), 0);
    each_node<4>(colour_, projection, colour_on_mesh, [&](std::size_t node, const std::array<double, 4>& value) {
      std::uint32_t rgba = 0;
      for (std::size_t c = 0; c < 4; ++c) {
        const auto level = static_cast<std::uint32_t>(std::lround(std::clamp(value[c], 0.0, 255.0)));
        rgba |= level << (8U * static_cast<std::uint32_t>(c));
      }
      projection.colour_rgba[node] = rgba;
    });
  }
  if (!intensity_.empty()) {
    projection.intensity.assign(nodes_.count(), std::numeric_limits<float>::quiet_NaN());
    each_node<1>(intensity_, projection, intensity_on_mesh, [&](std::size_t node, const std::array<double, 1>& value) {
      projection.intensity[node] = intensity_scale_.back(value[0]);
    });
  }
}

void AttributeSums::write(Projection& projection) const {
  write_all(
      projection, [](int, int, std::array<double, 4>&) { return false; },
      [](int, int, std::array<double, 1>&) { return false; });
}

void AttributeSums::write(Projection& projection, const Cloud& cloud, const OrientedPoints& points,
                          const TriangleHeights& mesh) const {
  if (mesh.face.empty()) {
    write(projection);
    return;
  }
  const auto from_corners = [&](const auto& read) {
    return [&, read](int i, int j, auto& value) {
      const std::size_t node = nodes_.index(i, j);
      if (mesh.face[node] == TriangleHeights::kNone || projection.grid.height_m[node] != mesh.height_m[node]) {
        return false;
      }
      const std::array<std::uint32_t, 3>& f = cloud.faces[mesh.face[node]];
      const std::array<double, 3> w =
          barycentric(points, f, lattice_.x0_m + i * lattice_.spacing_m, lattice_.y0_m + j * lattice_.spacing_m);
      // Corners that have none leave the others their weight.
      double known = 0.0;
      bool all = true;
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const auto part = read(f[corner]);
        all = all && part;
        if (!part) continue;
        known += w[corner];
        for (std::size_t c = 0; c < value.size(); ++c) value[c] += w[corner] * static_cast<double>((*part)[c]);
      }
      if (all) return true;
      for (double& v : value) v = known > 0.0 ? v / known : 0.0;
      return known > 0.0;
    };
  };
  write_all(projection, from_corners([&](std::size_t k) { return channels(cloud.rgba[k]); }),
            from_corners([&](std::size_t k) { return scaled(cloud.intensity[k]); }));
}

}  // namespace sparsha::pipeline
