// Each verdict is that of the first filter that refuses a point.
#include "pipeline/filter/streamed.h"

#include <algorithm>
#include <cmath>

#include "pipeline/filter/plane.h"

namespace sparsha::pipeline {

bool can_be_streamed(const FilterConfig& filter) {
  return std::holds_alternative<CropConfig>(filter) || std::holds_alternative<PassConfig>(filter) ||
         std::holds_alternative<RemovePlaneConfig>(filter);
}

StreamedFilters::StreamedFilters(const ScanSet& scans, const std::vector<FilterConfig>& filters, const Context& context)
    : origin_m_(scans.origin_m()) {
  for (const FilterConfig& filter : filters) {
    if (!can_be_streamed(filter)) break;
    filters_.push_back(filter);
  }
  for (const FilterConfig& filter : filters_) {
    steps_.steps.emplace_back().name = filter_name(filter);
    if (const auto* crop = std::get_if<CropConfig>(&filter)) tests_.emplace_back(*crop);
    if (const auto* pass = std::get_if<PassConfig>(&filter)) tests_.emplace_back(*pass);
    if (const auto* plane = std::get_if<RemovePlaneConfig>(&filter)) {
      at_key_of(filter, [&] { add_plane(scans, *plane, context); });
    }
  }
  samples_ = !tests_.empty();
}

void StreamedFilters::add_plane(const ScanSet& scans, const RemovePlaneConfig& config, const Context& context) {
  PlaneSample sample(config.distance_m);
  std::uint64_t passed = 0;
  (void)scans.stream(
      [&](const CloudBlock& block) {
        for (const Eigen::Vector3f& p : block.points) {
          if (!passes(p)) continue;
          ++passed;
          sample.add(p);
        }
      },
      context.progress);
  if (passed == 0 && !tests_.empty()) {
    at_key_of(filters_[tests_.size() - 1], [&] { throw nothing_left(steps_.steps[tests_.size() - 1].name); });
  }
  const FoundPlane plane = find_plane(sample, config, context);
  steps_.steps.back().found = to_string(plane);
  tests_.emplace_back(plane.cut);
}

bool StreamedFilters::passes(const Eigen::Vector3f& point) const {
  return std::all_of(tests_.begin(), tests_.end(),
                     [&](const PointTest& test) { return keeps(test, origin_m_, point); });
}

bool StreamedFilters::keep(const Eigen::Vector3f& point) {
  ++points_;
  for (std::size_t k = 0; k < tests_.size(); ++k) {
    if (keeps(tests_[k], origin_m_, point)) continue;
    ++steps_.steps[k].removed;
    const auto* cut = std::get_if<PlaneCut>(&tests_[k]);
    if (cut != nullptr && std::abs(height_m(*cut, point)) <= cut->distance_m) ++steps_.steps[k].in_plane;
    steps_.steps[k].sample.add(origin_m_ + point.cast<double>());
    return false;
  }
  if (samples_) steps_.kept.add(origin_m_ + point.cast<double>());
  return true;
}

FilterSteps StreamedFilters::finish(Progress& progress) {
  std::uint64_t left = points_;
  for (std::size_t k = 0; k < tests_.size(); ++k) {
    FilterStep& step = steps_.steps[k];
    at_key_of(filters_[k], [&] {
      if (left > 0 && step.removed == left) throw nothing_left(step.name, step.found);
    });
    if (std::holds_alternative<PlaneCut>(tests_[k])) warn_of_plane(step, left, progress);
    left -= step.removed;
  }
  return std::move(steps_);
}

}  // namespace sparsha::pipeline
