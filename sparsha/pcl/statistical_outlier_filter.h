// Statistical outlier removal with PCL's manners: the same result for any order of points and number of threads.
#pragma once

#include <string>

#include <pcl/filters/filter_indices.h>

namespace sparsha {

/// Keeps points whose mean distance to their MeanK nearest neighbours is at most mean + StddevMulThresh * standard
/// deviation of all such distances (Rusu et al. 2008), as pcl::StatisticalOutlierRemoval, but sums are exact and all
/// cores work. Points that are not finite are taken away (setNegative: stay away, as they are no outliers either).
/// filter() throws sparsha::Error of kind usage on impossible settings. Instantiated for the types that conversions.h
/// names; for others include impl/statistical_outlier_filter.hpp.
template <typename PointT>
class StatisticalOutlierFilter : public ::pcl::FilterIndices<PointT> {
 public:
  explicit StatisticalOutlierFilter(bool extract_removed_indices = false)
      : ::pcl::FilterIndices<PointT>(extract_removed_indices) {
    this->filter_name_ = "StatisticalOutlierFilter";
  }

  void setMeanK(int neighbours) { mean_k_ = neighbours; }
  [[nodiscard]] int getMeanK() const { return mean_k_; }
  void setStddevMulThresh(double deviations) { deviations_ = deviations; }
  [[nodiscard]] double getStddevMulThresh() const { return deviations_; }
  /// 0, the default: one per core.
  void setNumberOfThreads(unsigned threads) { threads_ = threads; }

 protected:
  using ::pcl::FilterIndices<PointT>::applyFilter;
  void applyFilter(::pcl::Indices& indices) override;

 private:
  int mean_k_ = 8;
  double deviations_ = 2.0;
  unsigned threads_ = 0;
};

}  // namespace sparsha
