// What a build needs in memory, by measurement, and what a limit leaves for points.
#pragma once

#include <cstdint>
#include <string>

#include "base/error.h"
#include "pipeline/scan/set.h"
#include "scene/config/filters.h"
#include "scene/config/layers.h"
#include "scene/depth_grid.h"
#include "scene/scene_fwd.h"

namespace sparsha::pipeline {

/// The limit of a build; see BuildOptions.
struct MemoryLimit {
  std::uint64_t bytes = 0;   ///< 0 = none
  std::uint64_t points = 0;  ///< 0 = as many as `bytes` allow
  /// Arrays of nodes lie in files (base/system/disk_arrays.h), and a share of the limit is for what is touched of them.
  bool nodes_on_disk = false;
  std::uint64_t beside = 0;  ///< of `bytes` those that are taken while points are measured, whatever tiles there are
  /// For what refusals name: what any way of building takes at least, and what a build in memory takes, which is enough
  /// in any case; 0 where it is not known.
  std::uint64_t floor = 0, in_memory = 0;

  [[nodiscard]] bool none() const { return bytes == 0 && points == 0; }
};

/// Threads of a build within so many `bytes`, 0 = no limit: `threads`, 0 = one a core, or as many as leave each its
/// buffers and the watch of the resident set a core that is free at times.
[[nodiscard]] unsigned threads_within(std::uint64_t bytes, unsigned threads);

/// Throws Error{failure} when scans cannot even be looked at within so many `bytes`; 0 = no limit. `looks`: views of
/// them are tried as well.
void require_room_for_program(std::uint64_t bytes, bool looks);

/// The memory that a refusal names, of which so many `bytes` turned out to be needed.
[[nodiscard]] std::uint64_t enough_of(const MemoryLimit& limit, std::uint64_t bytes);

/// "800 MB", and "12 bytes" of less than one.
[[nodiscard]] std::string amount_text(std::uint64_t bytes);

/// What decides how much memory scans take.
struct ScanAmount {
  std::uint64_t points = 0;
  std::uint64_t faces = 0;
  std::uint64_t attributes = 0;  ///< of each point: colour, intensity, fields
};
[[nodiscard]] ScanAmount amount_of(const ScanSet& scans);

/// Whether a build in memory may fit, whatever its nodes need.
[[nodiscard]] bool may_fit(const MemoryLimit& limit, const ScanAmount& scans,
                           const std::vector<scene::FilterConfig>& filters);

/// The most that a build in memory needs at once beside its nodes, bytes.
[[nodiscard]] std::uint64_t bytes_in_memory(const ScanAmount& scans, const std::vector<scene::FilterConfig>& filters);

/// The most that a build in memory needs while it tells sides apart, which takes `side_bytes`: nothing is sorted yet.
[[nodiscard]] std::uint64_t bytes_with_sides(const ScanAmount& scans, std::uint64_t side_bytes);

/// Throws Error{failure} before points go to disk where that alone takes more than the limit.
void require_room_on_disk(const MemoryLimit& limit);

/// The least that a build needs whose points are on disk, bytes. `side_bytes`: see require_room_for_sides(); otherwise
/// as nodes_fit().
[[nodiscard]] std::uint64_t bytes_on_disk(const MemoryLimit& limit, std::uint64_t side_bytes, std::uint64_t node_bytes,
                                          std::uint64_t bytes_per_point, std::uint64_t sample_bytes,
                                          const scene::Lattice& lattice);

/// Throws Error{failure} when sides cannot be told apart within the limit, with points on disk.
void require_room_for_sides(const MemoryLimit& limit, std::uint64_t side_bytes);

/// The error of a mesh that does not fit, which is built in memory only and needs so many `bytes`, with or without
/// those of the grid.
[[nodiscard]] Error refusal_of_mesh(const ScanAmount& scans, std::uint64_t bytes, bool with_grid);

/// Refuses a mesh while it is looked at, before it is in memory; empty without a limit. `fields` that points keep;
/// `guessed`: views of it are tried first, which takes more.
[[nodiscard]] MeshRefusal mesh_refusal(const MemoryLimit& limit, const std::vector<scene::FilterConfig>& filters,
                                       std::size_t fields, bool guessed);

/// Points that a first look at the scans may keep in memory, of `most` at most.
[[nodiscard]] std::uint64_t points_to_keep(const MemoryLimit& limit, std::uint64_t most);

/// The most that nodes need at once in any stage of a build, bytes. `colour` and `intensity`: there are such layers.
[[nodiscard]] std::uint64_t bytes_of_nodes(const scene::Config& config, bool grid_only, bool colour, bool intensity,
                                           const scene::Lattice& lattice);

/// The most that charts of a whole object take beside the nodes and what bytes_in_memory() counts for points, bytes.
/// `places`: points on the surface; `box_nodes`: nodes of the six sides of its box together. A mesh has so many places
/// that no point is counted for.
[[nodiscard]] std::uint64_t bytes_of_charts(double places, double box_nodes, bool mesh);

/// The most that the sample of a cross-check needs at once, bytes. `points`: at most so many are counted.
[[nodiscard]] std::uint64_t bytes_of_sample(const scene::CheckConfig& check, std::uint64_t points,
                                            const scene::Lattice& lattice);

/// Throws Error{failure} when the sample of the cross-check does not fit beside the nodes, which need `node_bytes` at
/// most.
void require_room_for_sample(const MemoryLimit& limit, const scene::CheckConfig& check, std::uint64_t points,
                             std::uint64_t node_bytes, const scene::Lattice& lattice);

/// Voxels that a filter may leave. The largest number without a limit.
[[nodiscard]] std::uint64_t most_voxels(const MemoryLimit& limit);

/// What so many voxels need, bytes.
[[nodiscard]] std::uint64_t bytes_of_voxels(std::uint64_t voxels);

/// Whether nodes that need `node_bytes` at most fit beside tiles of a useful size and the cross-check's sample.
[[nodiscard]] bool nodes_fit(const MemoryLimit& limit, std::uint64_t node_bytes, std::uint64_t bytes_per_point,
                             std::uint64_t sample_bytes, const scene::Lattice& lattice);

/// What a build needs whose largest tile has so many points, bytes.
[[nodiscard]] std::uint64_t bytes_with_tile(const MemoryLimit& limit, std::uint64_t points,
                                            std::uint64_t bytes_per_point, const scene::Lattice& lattice);

/// Points that a tile may have beside the grid of heights. Throws Error{failure} when the nodes alone, which need
/// `node_bytes` at most, exceed the limit; it names what is enough for the cross-check's sample as well.
[[nodiscard]] std::uint64_t points_of_a_tile(const MemoryLimit& limit, std::uint64_t node_bytes,
                                             std::uint64_t bytes_per_point, std::uint64_t sample_bytes,
                                             const scene::Lattice& lattice);

/// Bins that a tile of so many points may have. Without a bound where there is no limit of bytes.
[[nodiscard]] std::uint64_t bins_beside(const MemoryLimit& limit, std::uint64_t points, std::uint64_t bytes_per_point);

/// Of a lattice that a sample of the points has: throws as the two above when even one with a twentieth less of nodes
/// than that does not fit, with the memory that its own size needs. `check`: null without a cross-check.
void require_room_likely(const MemoryLimit& limit, const scene::CheckConfig* check, std::uint64_t points,
                         std::uint64_t node_bytes, std::uint64_t bytes_per_point, const scene::Lattice& lattice);

}  // namespace sparsha::pipeline
