// The filters at the start of a list that decide about one point at a time, for points that are never all in memory.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "base/context.h"
#include "pipeline/filter/filter.h"
#include "pipeline/filter/point_test.h"
#include "pipeline/scan/set.h"

namespace sparsha::pipeline {

/// True for crop, pass and remove_plane.
[[nodiscard]] bool can_be_streamed(const FilterConfig& filter);

/// Gives each point the same verdict, and the same counts, as apply_filters() does.
class StreamedFilters {
 public:
  /// Goes through the scans once for every plane. Throws as apply_filters() does.
  StreamedFilters(const ScanSet& scans, const std::vector<FilterConfig>& filters, const Context& context);

  /// How many filters at the start of the list these are.
  [[nodiscard]] std::size_t count() const { return tests_.size(); }
  /// A sample of what is kept is taken also where there are no filters.
  void sample_kept() { samples_ = true; }
  /// `point` is relative to the scans' origin. Counts.
  [[nodiscard]] bool keep(const Eigen::Vector3f& point);
  /// To be called when all points have come. Warns; throws Error{input} when none was kept.
  [[nodiscard]] FilterSteps finish(Progress& progress);

 private:
  [[nodiscard]] bool passes(const Eigen::Vector3f& point) const;
  void add_plane(const ScanSet& scans, const RemovePlaneConfig& config, const Context& context);

  Eigen::Vector3d origin_m_;
  std::vector<FilterConfig> filters_;
  std::vector<PointTest> tests_;
  FilterSteps steps_;
  std::uint64_t points_ = 0;
  bool samples_ = false;
};

}  // namespace sparsha::pipeline
