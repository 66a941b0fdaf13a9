// One look at a cloud.
#include "pipeline/grid/project.h"

#include "pipeline/grid/projector.h"

namespace sparsha::pipeline {

Projection project(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const GridConfig& config,
                   double resolution_m, ThreadPool& pool, Progress& progress, const ApproveLattice& approve) {
  return Projector(cloud, pool, false).project(scan_to_grid, config, resolution_m, pool, progress, approve);
}

}  // namespace sparsha::pipeline
