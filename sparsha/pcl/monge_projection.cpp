// The projection behind the templates, and the templates for the common point types.
#include <cmath>

#include <pcl/point_types.h>

#include "base/threads/context.h"
#include "pipeline/projection/projection.h"
#include "pipeline/scan/origin.h"
#include "scene/config/haptics.h"
#include "sparsha/pcl/impl/monge_projection.hpp"

namespace sparsha {
namespace detail {
namespace {

void require(bool right, const char* wrong, const char* expected) {
  if (!right) throw usage_error(wrong, expected);
}

scene::GridConfig grid_of(const MongeSettings& settings) {
  require(settings.scan_to_grid.allFinite() && std::abs(settings.scan_to_grid.block<3, 3>(0, 0).determinant()) > 0.0,
          "an orientation that is singular", "an invertible transform of finite numbers");
  require(settings.spacing_m >= 0.0 && std::isfinite(settings.spacing_m), "a spacing that is no length", "metres");
  require(settings.noise_m >= 0.0 && std::isfinite(settings.noise_m), "a noise that is no length", "metres");
  require(settings.size == 0 || settings.size >= 2, "a grid of that size", "two nodes or more along the longer side");
  require(settings.size == 0 || settings.spacing_m == 0.0, "a size and a spacing", "one of the two");
  scene::GridConfig grid;
  grid.spacing_m = settings.spacing_m;
  grid.size = settings.size;
  if (settings.noise_m > 0.0) grid.noise_m = settings.noise_m;
  if (!settings.bounds_m.empty()) {
    const std::vector<double>& b = settings.bounds_m;
    require(b[0] < b[2] && b[1] < b[3] && std::isfinite(b[2] - b[0]) && std::isfinite(b[3] - b[1]),
            "bounds that enclose nothing", "xmin, ymin, xmax, ymax with xmin < xmax and ymin < ymax");
    grid.bounds_m = {b[0], b[1], b[2], b[3]};
  }
  return grid;
}

ProjectedPoint shown(pipeline::PointClass point) {
  switch (point) {
    case pipeline::PointClass::used:
      return ProjectedPoint::used;
    case pipeline::PointClass::occluded:
      return ProjectedPoint::occluded;
    case pipeline::PointClass::outlier:
      return ProjectedPoint::outlier;
    case pipeline::PointClass::outside:
      return ProjectedPoint::outside;
  }
  return ProjectedPoint::invalid;
}

}  // namespace

void add_stations(pipeline::Cloud& cloud, const Eigen::Vector4f& sensor_origin) {
  if (cloud.size() == 0) return;
  const Eigen::Vector3d place = sensor_origin.head<3>().cast<double>();
  const bool known = place.allFinite() && !place.isZero(0.0);
  if (!known && cloud.normals.empty()) return;
  pipeline::PointSample seen;
  pipeline::PointSample with_normal;
  const float* xyz = cloud.xyz1();
  for (std::size_t i = 0; i < cloud.size(); ++i, xyz += 4) {
    const Eigen::Vector3d p = cloud.origin_m + Eigen::Map<const Eigen::Vector3f>(xyz).cast<double>();
    if (known) seen.add(p);
    if (cloud.normals.empty()) continue;
    const Eigen::Vector3f& normal = cloud.normals[i];
    if (normal.allFinite() && normal.squaredNorm() > 0.0F) with_normal.add(p, normal.normalized());
  }
  if (known) cloud.stations.push_back({"the cloud's sensor", true, cloud.origin_m + place, seen.points(), {}});
  if (with_normal.empty()) return;
  cloud.stations.push_back(
      {"the cloud's normals", true, Eigen::Vector3d::Zero(), with_normal.points(), with_normal.normals()});
}

MongeResult project(const pipeline::Cloud& cloud, const MongeSettings& settings) {
  if (cloud.size() == 0) throw Error(ErrorKind::input, {}, "the cloud has no finite point", "at least one");
  const scene::GridConfig grid = grid_of(settings);
  ThreadPool pool(settings.threads);
  Progress progress;
  pipeline::Projection projection =
      pipeline::project(cloud, settings.scan_to_grid, grid, scene::HapticsConfig().resolution_m, {pool, progress});
  MongeResult result{std::move(projection.grid), projection.noise_m, projection.point_spacing_m, {}};
  result.points.reserve(cloud.size());
  for (const pipeline::PointClass point : projection.point_class) result.points.push_back(shown(point));
  return result;
}

}  // namespace detail

#define SPARSHA_INSTANTIATE(PointT)                                                                                  \
  template pipeline::Cloud to_cloud(const ::pcl::PointCloud<PointT>&, const Eigen::Vector3d&, ::pcl::Indices*);      \
  template pipeline::Cloud to_cloud(const ::pcl::PointCloud<PointT>&, const ::pcl::Indices&, const Eigen::Vector3d&, \
                                    ::pcl::Indices*);                                                                \
  template void from_cloud(const pipeline::Cloud&, ::pcl::PointCloud<PointT>&);                                      \
  template class MongeProjection<PointT>;

SPARSHA_INSTANTIATE(::pcl::PointXYZ)
SPARSHA_INSTANTIATE(::pcl::PointXYZI)
SPARSHA_INSTANTIATE(::pcl::PointXYZRGB)
SPARSHA_INSTANTIATE(::pcl::PointXYZRGBA)
SPARSHA_INSTANTIATE(::pcl::PointNormal)
SPARSHA_INSTANTIATE(::pcl::PointXYZRGBNormal)
#undef SPARSHA_INSTANTIATE

}  // namespace sparsha
