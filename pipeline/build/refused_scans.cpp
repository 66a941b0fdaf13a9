// Each names what is in the way and what would do.
#include "pipeline/build/refused_scans.h"

#include <string>
#include <variant>

#include <fmt/format.h>

#include "base/system.h"
#include "pipeline/filter/streamed.h"
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
  if (amount.faces > 0) {
    throw refusal_of_mesh(amount, bytes > 0 ? bytes : bytes_in_memory(amount, filters), bytes > 0);
  }
  for (const scene::FilterConfig& filter : filters) {
    if (std::holds_alternative<scene::VoxelConfig>(filter)) return;  // what follows it has a cloud in memory
    if (can_be_streamed(filter)) continue;
    const std::string name = scene::filter_name(filter);
    throw Error(ErrorKind::failure, filter.place,
                fmt::format("{} points need about {} MB and the grid in memory, more than the limit, and the filter "
                            "'{}' works in memory only",
                            amount.points, bytes_in_memory(amount, filters) / 1'000'000U + 1, name),
                "a higher --memory, a voxel filter before it" + without(filter, name));
  }
}

}  // namespace sparsha::pipeline
