#include "pipeline/projection/count_scattered.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cstddef>

#include "base/error.h"
#include "pipeline/projection/extent.h"
#include "pipeline/projection/plan.h"
#include "pipeline/projection/scattered.h"
#include "scene/config/grid.h"

namespace sparsha::pipeline {

namespace {

/// Turns the shortest of the principal axes of a sample, x, y and z of each point, to z: a relief is seen from before.
Eigen::Matrix4d along_shortest_axis(const std::vector<float>& sample) {
  const Eigen::Map<const Eigen::Matrix3Xf> points(sample.data(), 3, static_cast<Eigen::Index>(sample.size() / 3));
  const Eigen::Matrix3Xd places = points.cast<double>();
  const Eigen::Matrix3Xd from_mean = places.colwise() - places.rowwise().mean();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(from_mean * from_mean.transpose());
  Eigen::Matrix4d turned = Eigen::Matrix4d::Identity();
  const Eigen::Vector3d z = axes.eigenvectors().col(0), x = axes.eigenvectors().col(2);
  turned.topLeftCorner<3, 3>() << x.transpose(), z.cross(x).transpose(), z.transpose();
  return turned;
}

}  // namespace

std::uint64_t count_scattered(const RawPoints& points_m, ThreadPool& pool) try {
  constexpr std::size_t kFewest = 100;  // fewer have no density
  if (points_m.count < kFewest) return 0;
  const Eigen::Vector3d zero = Eigen::Vector3d::Zero();
  const std::vector<Station> no_stations;
  const std::vector<float> sample = origin_sample(
      points_m.count, [&](const auto& use) { use(points_m); }, pool);
  const Eigen::Matrix4d scan_to_grid = along_shortest_axis(sample);
  const Eigen::Vector3d origin_m = origin_of_sample(sample, zero, scan_to_grid);
  const OrientedPoints oriented = orient_points(points_m, zero, scan_to_grid, origin_m, pool);
  const OrientedPieces whole = [&](const auto& use) { use(oriented); };
  PointTotals totals;
  totals.add(oriented);
  const ProjectionPlan plan = plan_projection(whole, totals, supported_extent(totals, whole, pool),
                                              {no_stations, scan_to_grid, origin_m}, false, {}, 0.0, pool);
  std::vector<std::uint8_t> skip;
  return flag_scattered(oriented, plan.scatter, plan.bins, BinWindow::nodes(plan.bins), skip);
} catch (const Error&) {
  return 0;  // a build says why
}

std::uint64_t count_scattered(const std::vector<Eigen::Vector3d>& points, double unit_m, ThreadPool& pool) {
  if (points.empty()) return 0;
  const Eigen::Vector3d& near = points.front();
  std::vector<float> xyz;
  xyz.reserve(3 * points.size());
  for (const Eigen::Vector3d& point : points) {
    const Eigen::Vector3f p = ((point - near) * unit_m).cast<float>();
    xyz.insert(xyz.end(), {p.x(), p.y(), p.z()});
  }
  return count_scattered(RawPoints{xyz.data(), 3, points.size()}, pool);
}

}  // namespace sparsha::pipeline
