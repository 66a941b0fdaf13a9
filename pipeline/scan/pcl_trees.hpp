// For .cpp files: PCL's trees for the points that the pipeline has. FLANN's eleven kinds of index behind them are
// compiled in pcl_trees.cpp, not once more in each file that searches neighbours: some 10 s and 500 MB a file.
#pragma once

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
