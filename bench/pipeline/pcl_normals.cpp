// PCL's templates are compiled here, so that this file needs OpenMP's flag.
#include "bench/pipeline/pcl_normals.h"

#include <memory>

#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/features/impl/normal_3d.hpp>
#include <pcl/features/impl/normal_3d_omp.hpp>
#include <pcl/kdtree/impl/kdtree_flann.hpp>
#include <pcl/search/impl/kdtree.hpp>

namespace sparsha::bench {

std::vector<Eigen::Vector3f> by_pcl_normals(const pipeline::Cloud& cloud, int neighbours, unsigned threads) {
  pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation(threads);
  estimation.setInputCloud(cloud.points);
  estimation.setSearchMethod(std::make_shared<pcl::search::KdTree<pcl::PointXYZ>>());
  estimation.setKSearch(neighbours);
  pcl::PointCloud<pcl::Normal> normals;
  estimation.compute(normals);
  std::vector<Eigen::Vector3f> vectors;
  vectors.reserve(normals.size());
  for (const pcl::Normal& normal : normals) vectors.emplace_back(normal.getNormalVector3fMap());
  return vectors;
}

bool pcl_normals_have_threads() {
#ifdef _OPENMP
  return true;
#else
  return false;
#endif
}

}  // namespace sparsha::bench
