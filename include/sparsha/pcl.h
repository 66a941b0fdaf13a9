// For programs that use the Point Cloud Library (component `pcl`): from a cloud to heights.
//
//   sparsha::MongeProjection<PointT>          a cloud seen from one side as a scene::DepthGrid, lengths in metres
//   sparsha::StatisticalOutlierFilter<PointT> decides as PCL's StatisticalOutlierRemoval, whatever the order of points
//   sparsha::to_cloud, sparsha::from_cloud    conversions; a sensor_origin_ becomes a station
//
// In PCL's manners, but errors are exceptions (sparsha/error.h). One thread at a time for each object; compute() and
// filter() use as many threads as they are told to, with the same result. Common point types are instantiated in the
// library; for others include sparsha/pcl/impl/.
#pragma once

#include "sparsha/error.h"
#include "sparsha/pcl/conversions.h"
#include "sparsha/pcl/monge_projection.h"
#include "sparsha/pcl/statistical_outlier_filter.h"
#include "sparsha/scene.h"
