// One look at a cloud.
#include "pipeline/projection/projection.h"

#include "pipeline/projection/projector.h"

namespace sparsha::pipeline {

Projection project(const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid, const scene::GridConfig& config,
                   double resolution_m, const Context& context, const Approval& approval) {
  return Projector(cloud, context.pool, false).project(scan_to_grid, config, resolution_m, context, approval);
}

}  // namespace sparsha::pipeline
