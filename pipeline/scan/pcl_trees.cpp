#include "pipeline/scan/pcl_trees.hpp"

template class pcl::KdTreeFLANN<pcl::PointXYZ>;
template class pcl::KdTreeFLANN<pcl::PointNormal>;
template class pcl::KdTreeFLANN<pcl::FPFHSignature33>;
template class pcl::search::KdTree<pcl::PointXYZ>;
template class pcl::search::KdTree<pcl::PointNormal>;
template class pcl::search::OrganizedNeighbor<pcl::PointXYZ>;
template class pcl::search::OrganizedNeighbor<pcl::PointNormal>;
