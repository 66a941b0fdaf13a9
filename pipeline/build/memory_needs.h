// What a build of a configuration takes in memory, before it is taken.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "pipeline/outofcore/memory.h"
#include "pipeline/projection/projection.h"
#include "pipeline/scan/set.h"
#include "scene/config/config.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

/// Bytes of the parts of a build. The configuration must outlive it.
class MemoryNeeds {
 public:
  /// `grid_only`: see BuildOptions.
  MemoryNeeds(const scene::Config& config, bool grid_only) : config_(config), grid_only_(grid_only) {}

  [[nodiscard]] bool around() const { return !grid_only_ && config_.around.has_value(); }
  [[nodiscard]] bool unrolls() const { return config_.unroll.has_value(); }
  [[nodiscard]] bool checks() const { return !grid_only_ && config_.check.has_value(); }
  [[nodiscard]] bool finds_pillars() const { return !grid_only_ && config_.audio && config_.audio->find_pillars; }

  /// Of the nodes of one view.
  [[nodiscard]] std::uint64_t nodes(const ScanSet& scans, const scene::Lattice& lattice) const;

  /// Of a whole object, beside those of its front view. `places`: points, or places on faces of a `mesh`; `sample_m`
  /// some of them, scan frame.
  [[nodiscard]] std::uint64_t charts(double places, const std::vector<Eigen::Vector3d>& sample_m, bool mesh,
                                     const Eigen::Matrix4d& scan_to_grid, const scene::Lattice& lattice) const;

  /// What a point takes beyond what bytes_in_memory() counts for it, of which `bytes_per_point` are its projection's.
  [[nodiscard]] std::uint64_t more_than_windows(std::uint64_t bytes_per_point) const;

  /// What a build in memory needs whose points and nodes are these, `charts` of a whole object.
  [[nodiscard]] std::uint64_t with_grid(const ScanSet& scans, const std::vector<scene::FilterConfig>& filters,
                                        double points, std::uint64_t charts, const scene::Lattice& lattice,
                                        const ProjectionNeeds& needs) const;

 private:
  const scene::Config& config_;
  bool grid_only_;
};

}  // namespace sparsha::pipeline
