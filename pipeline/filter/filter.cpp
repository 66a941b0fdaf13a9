#include "pipeline/filter/filter.h"

#include "pipeline/base/error.h"
#include "pipeline/filter/outliers.h"
#include "pipeline/filter/voxel.h"

namespace sparsha::pipeline {
namespace {

/// Takes the points with keep[i] == 0 away, and then all faces. Returns how many went.
std::uint64_t keep_only(Cloud& cloud, const std::vector<std::uint8_t>& keep) {
  float* const xyz = cloud.xyz1();
  std::size_t kept = 0;
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (keep[i] == 0) continue;
    if (kept != i) {
      for (std::size_t k = 0; k < 3; ++k) xyz[4 * kept + k] = xyz[4 * i + k];
      if (!cloud.rgba.empty()) cloud.rgba[kept] = cloud.rgba[i];
      if (!cloud.intensity.empty()) cloud.intensity[kept] = cloud.intensity[i];
    }
    ++kept;
  }
  const std::size_t gone = keep.size() - kept;
  if (gone == 0) return 0;
  cloud.resize_points(kept);
  if (!cloud.rgba.empty()) cloud.rgba.resize(kept);
  if (!cloud.intensity.empty()) cloud.intensity.resize(kept);
  cloud.faces.clear();
  return gone;
}

std::vector<std::uint8_t> inside(const Cloud& cloud, const CropConfig& crop) {
  std::vector<std::uint8_t> keep(cloud.size());
  const float* const xyz = cloud.xyz1();
  for (std::size_t i = 0; i < keep.size(); ++i) {
    const Eigen::Vector3d p = cloud.origin_m + Eigen::Map<const Eigen::Vector3f>(xyz + 4 * i).cast<double>();
    keep[i] = (p.array() >= crop.min_m.array()).all() && (p.array() <= crop.max_m.array()).all() ? 1 : 0;
  }
  return keep;
}

void check_left(const Cloud& cloud, const char* filter) {
  if (cloud.size() > 0) return;
  throw Error(ErrorKind::input, {}, std::string("nothing is left after the filter '") + filter + "'",
              "a filter that keeps some points");
}

}  // namespace

FilterCounts apply_filters(Cloud& cloud, const std::vector<FilterConfig>& filters, ThreadPool& pool,
                           Progress& progress) {
  FilterCounts counts;
  for (const FilterConfig& filter : filters) {
    progress.throw_if_cancelled();
    if (const auto* crop = std::get_if<CropConfig>(&filter)) {
      counts.filtered += keep_only(cloud, inside(cloud, *crop));
      check_left(cloud, "crop");
    } else if (const auto* voxel = std::get_if<VoxelConfig>(&filter)) {
      const std::size_t before = cloud.size();
      thin_to_voxels(cloud, voxel->leaf_m, progress);
      counts.filtered += before - cloud.size();
      cloud.faces.clear();
    } else if (const auto* outliers = std::get_if<OutlierConfig>(&filter)) {
      counts.outlier += keep_only(cloud, outliers->method == OutlierConfig::Method::pcl
                                             ? statistical_inliers_by_pcl(cloud, *outliers)
                                             : statistical_inliers(cloud, *outliers, pool, progress));
      check_left(cloud, "outliers");
    }
  }
  return counts;
}

}  // namespace sparsha::pipeline
