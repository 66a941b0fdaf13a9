// The filters at the start of a list that decide about one point at a time, for points that are never all in memory.
#pragma once

#include <cstdint>
#include <optional>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "base/threads/context.h"
#include "pipeline/filter/filter.h"
#include "pipeline/filter/point_test.h"
#include "pipeline/scan/set.h"

namespace sparsha::pipeline {

/// True for crop, pass, remove_plane, field and classes.
[[nodiscard]] bool can_be_streamed(const scene::FilterConfig& filter);

/// Gives each point the same verdict, and the same counts, as apply_filters() does.
class StreamedFilters {
 public:
  /// Goes through the scans once for every plane. Throws as apply_filters() does.
  StreamedFilters(const ScanSet& scans, const std::vector<scene::FilterConfig>& filters, const Context& context);

  /// How many filters at the start of the list these are.
  [[nodiscard]] std::size_t count() const { return tests_.size(); }
  /// A sample of what is kept is taken also where there are no filters.
  void sample_kept() { samples_ = true; }
  /// Counts.
  [[nodiscard]] bool keep(const CloudBlock& block, std::size_t point);
  /// After the last point of a set of scans that several processes read: adds what the others have counted and drawn.
  /// Called by all of them.
  void join(const ReadingRanks& ranks);
  /// To be called when all points have come. Warns; throws Error{input} when none was kept.
  [[nodiscard]] FilterSteps finish(Progress& progress);

 private:
  /// What looks at a value of the point and not at its place.
  struct ValueTest {
    std::variant<scene::FieldConfig, scene::ClassesConfig> test;
    std::optional<std::size_t> field;  ///< place among the scans' fields; absent: the intensity

    [[nodiscard]] float value(const CloudBlock& block, std::size_t point) const;
  };
  using Test = std::variant<PointTest, ValueTest>;

  template <typename Config>
  void add_value_test(const ScanSet& scans, const Config& config);
  [[nodiscard]] bool passes(const Test& test, const CloudBlock& block, std::size_t point) const;
  [[nodiscard]] bool passes_all(const CloudBlock& block, std::size_t point) const;
  void add_plane(const ScanSet& scans, const scene::RemovePlaneConfig& config, const Context& context);

  Eigen::Vector3d origin_m_;
  std::vector<scene::FilterConfig> filters_;
  std::vector<Test> tests_;
  std::vector<std::uint64_t> unknown_;  ///< of each test: points that stay since the scans say no value of them
  FilterSteps steps_;
  std::uint64_t points_ = 0;
  bool samples_ = false;
};

}  // namespace sparsha::pipeline
