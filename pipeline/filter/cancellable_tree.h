// PCL's kd-tree for PCL's own filters, which know nothing of cancelling.
#pragma once

#include <memory>

#include "base/threads/progress.h"

namespace pcl {
struct PointXYZ;
namespace search {
template <typename PointT>
class Search;
}  // namespace search
}  // namespace pcl

namespace sparsha::pipeline {

/// Every search throws Cancelled once that is asked for; PCL's filters search for each point. Neighbours come without
/// order, as PCL's filters ask for them by themselves. One thread.
[[nodiscard]] std::shared_ptr<pcl::search::Search<pcl::PointXYZ>> cancellable_tree(const Progress& progress);

}  // namespace sparsha::pipeline
