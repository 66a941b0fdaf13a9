// For .cpp files: PCL's trees for the points that the pipeline has. They are compiled in pcl_trees.cpp, not once more
// in each file that searches neighbours.
#pragma once

#include <flann/flann.hpp>

// PCL's trees ask FLANN for its single k-d tree and for nothing else. FLANN's choice by name would compile its seven
// other kinds of index as well.
template <>
inline flann::NNIndex<flann::L2_Simple<float>>* flann::create_index_by_type<flann::L2_Simple<float>>(
    flann_algorithm_t kind, const Matrix<float>& places, const IndexParams& params, const L2_Simple<float>& distance) {
  if (kind != FLANN_INDEX_KDTREE_SINGLE) throw FLANNException("only the single k-d tree is compiled");
  return new KDTreeSingleIndex<L2_Simple<float>>(places, params, distance);
}

#include <pcl/kdtree/kdtree_flann.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/search/organized.h>

extern template class pcl::KdTreeFLANN<pcl::PointXYZ>;
extern template class pcl::KdTreeFLANN<pcl::PointNormal>;
extern template class pcl::KdTreeFLANN<pcl::FPFHSignature33>;
extern template class pcl::search::KdTree<pcl::PointXYZ>;
extern template class pcl::search::KdTree<pcl::PointNormal>;
extern template class pcl::search::OrganizedNeighbor<pcl::PointXYZ>;
extern template class pcl::search::OrganizedNeighbor<pcl::PointNormal>;
