#include "pipeline/build/memory_needs.h"

#include <algorithm>

#include <Eigen/Geometry>

namespace sparsha::pipeline {
namespace {

constexpr std::uint64_t kWindowBytes = 56;  // per point, that bytes_in_memory() allows for its projection
constexpr std::uint64_t kDiscBytes = 112;   // of a whole object, whatever its front view takes

}  // namespace

std::uint64_t MemoryNeeds::nodes(const ScanSet& scans, const scene::Lattice& lattice) const {
  return bytes_of_nodes(config_, grid_only_, config_.grid.colour && scans.has_colour(),
                        config_.grid.intensity && scans.has_intensity(), lattice);
}

std::uint64_t MemoryNeeds::charts(double places, const std::vector<Eigen::Vector3d>& sample_m, bool mesh,
                                  const Eigen::Matrix4d& scan_to_grid, const scene::Lattice& lattice) const {
  const double spacing_m = lattice.spacing_m;
  std::vector<double> depth_m;
  for (const Eigen::Vector3d& p : sample_m) depth_m.push_back((scan_to_grid * p.homogeneous()).z());
  std::sort(depth_m.begin(), depth_m.end());
  // A few points far before or behind are no part of the object.
  const std::size_t few = depth_m.size() / 200;
  const double deep_m = depth_m.empty() ? 0.0 : depth_m[depth_m.size() - 1 - few] - depth_m[few];
  const double nz = deep_m / spacing_m + 1.0, nx = lattice.nx, ny = lattice.ny;
  return bytes_of_charts(places, 2.0 * (nx * ny + nx * nz + ny * nz), mesh);
}

std::uint64_t MemoryNeeds::more_than_windows(std::uint64_t bytes_per_point) const {
  return std::max(bytes_per_point, around() ? kDiscBytes : kWindowBytes) - kWindowBytes;
}

std::uint64_t MemoryNeeds::with_grid(const ScanSet& scans, const std::vector<scene::FilterConfig>& filters,
                                     double points, std::uint64_t charts, const scene::Lattice& lattice,
                                     const ProjectionNeeds& needs) const {
  std::uint64_t needed = bytes_in_memory(amount_of(scans), filters) + nodes(scans, lattice) + charts;
  // What is counted for a point is enough for windows; discs take more.
  needed += more_than_windows(needs.bytes_per_point) * scans.points() + needs.column_bytes;
  needed += needs.kept_side_bytes(points);
  // Of a mesh as many places may be sampled as there are nodes.
  const std::uint64_t places = scans.points() + (scans.faces() > 0 ? lattice.count() : 0U);
  return checks() ? needed + bytes_of_sample(*config_.check, places, lattice) : needed;
}

}  // namespace sparsha::pipeline
