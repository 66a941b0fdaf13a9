#include "pipeline/filter/filter.h"

#include <algorithm>

#include "base/error.h"
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
      if (!cloud.normals.empty()) cloud.normals[kept] = cloud.normals[i];
    }
    ++kept;
  }
  const std::size_t gone = keep.size() - kept;
  if (gone == 0) return 0;
  cloud.resize_points(kept);
  if (!cloud.rgba.empty()) cloud.rgba.resize(kept);
  if (!cloud.intensity.empty()) cloud.intensity.resize(kept);
  if (!cloud.normals.empty()) cloud.normals.resize(kept);
  cloud.faces.clear();
  return gone;
}

std::vector<std::uint8_t> inside(const Cloud& cloud, const CropConfig& crop) {
  std::vector<std::uint8_t> keep(cloud.size());
  const float* const xyz = cloud.xyz1();
  for (std::size_t i = 0; i < keep.size(); ++i) {
    keep[i] = is_inside(crop, cloud.origin_m, Eigen::Map<const Eigen::Vector3f>(xyz + 4 * i)) ? 1 : 0;
  }
  return keep;
}

/// Appends the points with keep[i] == 0 to `removed`.
void copy_removed(const Cloud& cloud, const std::vector<std::uint8_t>& keep, Cloud& removed) {
  std::size_t next = removed.size();
  removed.origin_m = cloud.origin_m;
  removed.resize_points(next + static_cast<std::size_t>(std::count(keep.begin(), keep.end(), std::uint8_t{0})));
  for (std::size_t i = 0; i < keep.size(); ++i) {
    if (keep[i] != 0) continue;
    std::copy_n(cloud.xyz1() + 4 * i, 3, removed.xyz1() + 4 * next);
    ++next;
  }
}

void check_left(const Cloud& cloud, const char* filter) {
  if (cloud.size() == 0) throw nothing_left(filter);
}

}  // namespace

Error nothing_left(const std::string& filter) {
  return {ErrorKind::input, {}, "nothing is left after the filter '" + filter + "'", "a filter that keeps some points"};
}

FilterCounts apply_filters(Cloud& cloud, const std::vector<FilterConfig>& filters, const Context& context,
                           Cloud* removed_outliers) {
  FilterCounts counts;
  for (const FilterConfig& filter : filters) {
    context.progress.throw_if_cancelled();
    if (const auto* crop = std::get_if<CropConfig>(&filter)) {
      counts.filtered += keep_only(cloud, inside(cloud, *crop));
      check_left(cloud, "crop");
    } else if (const auto* voxel = std::get_if<VoxelConfig>(&filter)) {
      const std::size_t before = cloud.size();
      thin_to_voxels(cloud, voxel->leaf_m, context.progress);
      counts.filtered += before - cloud.size();
      cloud.faces.clear();
      cloud.normals.clear();
    } else if (const auto* outliers = std::get_if<OutlierConfig>(&filter)) {
      const std::vector<std::uint8_t> keep = outliers->method == OutlierConfig::Method::pcl
                                                 ? statistical_inliers_by_pcl(cloud, *outliers)
                                                 : statistical_inliers(cloud, *outliers, context);
      if (removed_outliers != nullptr) copy_removed(cloud, keep, *removed_outliers);
      counts.outlier += keep_only(cloud, keep);
      check_left(cloud, "outliers");
    }
  }
  return counts;
}

}  // namespace sparsha::pipeline
