// Each names what is in the way and what would do.
#include "pipeline/build/refused_scans.h"

#include <string>
#include <variant>

#include <fmt/format.h>

#include "base/system.h"
#include "pipeline/filter/voxel.h"
#include "scene/config/config.h"

namespace sparsha::pipeline {
namespace {

// What the projection does by itself.
std::string without(const scene::FilterConfig& filter, const std::string& name) {
  if (std::holds_alternative<scene::OutlierConfig>(filter) ||
      std::holds_alternative<scene::RadiusOutlierConfig>(filter)) {
    return ", or no '" + name + "': the projection leaves them out by itself";
  }
  return std::holds_alternative<scene::ThinConfig>(filter) ? ", or no 'thin': the projection does not need it" : "";
}

}  // namespace

Error no_points(const scene::Config& config) {
  return input_error(config.scans.front().file.string(), "there are no points to build from",
                     "a scan with at least one finite point");
}

void require_room(const scene::Lattice& lattice, std::uint64_t bytes) {
  const std::uint64_t memory = system::physical_memory_bytes();
  if (memory == 0 || bytes <= memory / 10 * 9) return;
  throw usage_error(fmt::format("a grid of {} x {} nodes needs about {} MB for its layers, this machine has {} MB",
                                lattice.nx, lattice.ny, bytes / 1'000'000U, memory / 1'000'000U),
                    "a smaller grid.size, a larger grid.spacing_mm or --memory");
}

void require_points_only(const ScanAmount& amount, const std::vector<scene::FilterConfig>& filters,
                         std::uint64_t bytes) {
  const std::uint64_t needed = bytes > 0 ? bytes : bytes_in_memory(amount, filters);
  if (amount.faces > 0) throw refusal_of_mesh(amount, needed, bytes > 0);
  for (const scene::FilterConfig& filter : filters) {
    if (std::holds_alternative<scene::VoxelConfig>(filter)) return;  // what follows it has a cloud in memory
    if (can_be_streamed(filter)) continue;
    const std::string name = scene::filter_name(filter);
    throw Error(ErrorKind::failure, filter.place,
                fmt::format("{} points need about {} MB {} the grid in memory, more than the limit, and the filter "
                            "'{}' works in memory only",
                            amount.points, needed / 1'000'000U + 1, bytes > 0 ? "with" : "at least and", name),
                "a higher --memory, a voxel filter before it" + without(filter, name));
  }
}

Error refusal_in_memory(bool around, std::uint64_t points, std::uint64_t bytes, bool with_grid) {
  const std::string block = around ? "around" : "unroll";
  return Error(ErrorKind::failure, {},
               fmt::format("{}: {} points need about {} MB {} the grid in memory, more than the limit, and {} is built "
                           "in memory only",
                           block, points, bytes / 1'000'000U + 1, with_grid ? "with" : "at least and",
                           around ? "a whole object" : "an unrolled one"),
               "a higher --memory, a voxel filter, or no block '" + block + "'");
}

Error refusal_of_voxels(const ScanSet& scans, StreamedFilters& streamed, const scene::FilterConfig& filter,
                        Progress& progress) {
  constexpr std::uint64_t kErrors = 25;  // a part of the count: five standard errors of it
  VoxelCounter counter(scans.origin_m(), std::get<scene::VoxelConfig>(filter).leaf_m);
  (void)scans.stream(
      [&](const CloudBlock& block) {
        for (std::size_t k = 0; k < block.points.size(); ++k)
          if (streamed.keep(block, k)) counter.add(block.points[k].data());
      },
      progress);
  const std::uint64_t voxels = counter.voxels() + counter.voxels() / kErrors;
  return Error(ErrorKind::failure, filter.place,
               fmt::format("the filter 'voxel' leaves about {} points, which need about {} MB, more than the limit",
                           counter.voxels(), bytes_of_voxels(voxels) / 1'000'000U + 1),
               "a larger leaf_mm or a higher --memory");
}

}  // namespace sparsha::pipeline
