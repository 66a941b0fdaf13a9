// A cloud kept ready to be looked at from one side after another.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include <Eigen/Core>

#include "base/threads/context.h"
#include "base/threads/thread_pool.h"
#include "pipeline/projection/buffer.h"
#include "pipeline/projection/plan.h"
#include "pipeline/projection/points.h"
#include "pipeline/projection/projection.h"
#include "pipeline/scan/cloud.h"
#include "scene/config/grid.h"
#include "scene/depth_grid.h"

namespace sparsha::pipeline {

/// Holds on to a cloud, to what does not depend on the orientation and to the memory of the last projection: a million
/// points need about 60 MB beside the cloud. One thread at a time.
class Projector {
 public:
  /// `cloud` has to outlive the projector and to stay as it is. Without `keep_memory` arrays are freed as soon as they
  /// are not needed. Throws Error{input} when the cloud is empty or a face names a point that it does not have.
  Projector(const Cloud& cloud, ThreadPool& pool, bool keep_memory = true);

  /// What project() gives, bit for bit, and with the same errors.
  [[nodiscard]] Projection project(const Eigen::Matrix4d& scan_to_grid, const scene::GridConfig& grid,
                                   double resolution_m, const Context& context, const Approval& approval = {});

  /// The lattice that project() would choose, without anything being measured. The same errors.
  [[nodiscard]] scene::Lattice lattice(const Eigen::Matrix4d& scan_to_grid, const scene::GridConfig& grid,
                                       double resolution_m, const Context& context);

 private:
  [[nodiscard]] ProjectionPlan plan(const OrientedPoints& points, const Eigen::Matrix4d& scan_to_grid,
                                    const Eigen::Vector3d& origin_m, const scene::GridConfig& grid, double resolution_m,
                                    ThreadPool& pool, const Approval& approval) const;

  const Cloud& cloud_;
  RawPoints raw_;
  std::vector<std::uint8_t> vertices_;  // one flag per point that is a vertex of a face; empty without faces
  bool only_mesh_ = false;
  bool keep_memory_ = true;
  std::vector<float> origin_sample_;
  MemoryStore memory_;
};

}  // namespace sparsha::pipeline
