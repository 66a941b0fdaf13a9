// Each verdict is that of the first filter that refuses a point.
#include "pipeline/filter/streamed.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "pipeline/filter/plane.h"
#include "pipeline/filter/plane_doubt.h"
#include "pipeline/scan/value_test.h"
#include "scene/config/config.h"

namespace sparsha::pipeline {

bool can_be_streamed(const scene::FilterConfig& filter) {
  return std::holds_alternative<scene::CropConfig>(filter) || std::holds_alternative<scene::PassConfig>(filter) ||
         std::holds_alternative<scene::RemovePlaneConfig>(filter) || !field_of(filter).empty();
}

StreamedFilters::StreamedFilters(const ScanSet& scans, const std::vector<scene::FilterConfig>& filters,
                                 const Context& context)
    : origin_m_(scans.origin_m()) {
  for (const scene::FilterConfig& filter : filters) {
    if (!can_be_streamed(filter)) break;
    filters_.push_back(filter);
  }
  for (const scene::FilterConfig& filter : filters_) {
    steps_.steps.emplace_back().name = scene::filter_name(filter);
    if (const auto* crop = std::get_if<scene::CropConfig>(&filter)) tests_.emplace_back(PointTest(*crop));
    if (const auto* pass = std::get_if<scene::PassConfig>(&filter)) tests_.emplace_back(PointTest(*pass));
    if (const auto* field = std::get_if<scene::FieldConfig>(&filter)) add_value_test(scans, *field);
    if (const auto* classes = std::get_if<scene::ClassesConfig>(&filter)) add_value_test(scans, *classes);
    if (const auto* plane = std::get_if<scene::RemovePlaneConfig>(&filter)) {
      at_key_of(filter, [&] { add_plane(scans, *plane, context); });
    }
  }
  unknown_.resize(tests_.size());
  samples_ = !tests_.empty();
}

template <typename Config>
void StreamedFilters::add_value_test(const ScanSet& scans, const Config& config) {
  const std::string name = field_of(config);
  ValueTest test{config, {}};
  if (name != kIntensityField) {
    const auto found = std::find(scans.fields().begin(), scans.fields().end(), name);
    if (found == scans.fields().end()) throw std::logic_error("the scans were not asked for the field " + name);
    test.field = static_cast<std::size_t>(found - scans.fields().begin());
  }
  tests_.emplace_back(std::move(test));
}

void StreamedFilters::add_plane(const ScanSet& scans, const scene::RemovePlaneConfig& config, const Context& context) {
  PlaneSample sample(config.distance_m);
  std::uint64_t passed = 0;
  (void)scans.stream(
      [&](const CloudBlock& block) {
        for (std::size_t k = 0; k < block.points.size(); ++k) {
          if (!passes_all(block, k)) continue;
          ++passed;
          sample.add(block.points[k]);
        }
      },
      context.progress);
  if (passed == 0 && !tests_.empty()) {
    at_key_of(filters_[tests_.size() - 1], [&] { throw nothing_left(steps_.steps[tests_.size() - 1].name); });
  }
  const FoundPlane plane = find_plane(sample, config, context);
  steps_.steps.back().found = to_string(plane);
  steps_.steps.back().of_object = plane.of_object;
  tests_.emplace_back(PointTest(plane.cut));
}

float StreamedFilters::ValueTest::value(const CloudBlock& block, std::size_t point) const {
  const std::span<const float> values = field ? block.fields[*field] : block.intensity;
  return values.empty() ? kNoValue : values[point];
}

bool StreamedFilters::passes(const Test& test, const CloudBlock& block, std::size_t point) const {
  if (const auto* place = std::get_if<PointTest>(&test)) return keeps(*place, origin_m_, block.points[point]);
  const auto& value = std::get<ValueTest>(test);
  return std::visit([&](const auto& t) { return keeps(t, value.value(block, point)); }, value.test);
}

bool StreamedFilters::passes_all(const CloudBlock& block, std::size_t point) const {
  return std::all_of(tests_.begin(), tests_.end(), [&](const Test& test) { return passes(test, block, point); });
}

bool StreamedFilters::keep(const CloudBlock& block, std::size_t point) {
  ++points_;
  const Eigen::Vector3f& p = block.points[point];
  for (std::size_t k = 0; k < tests_.size(); ++k) {
    if (passes(tests_[k], block, point)) {
      const auto* value = std::get_if<ValueTest>(&tests_[k]);
      if (value != nullptr && std::isnan(value->value(block, point))) ++unknown_[k];
      continue;
    }
    ++steps_.steps[k].removed;
    const auto* place = std::get_if<PointTest>(&tests_[k]);
    const auto* cut = place != nullptr ? std::get_if<PlaneCut>(place) : nullptr;
    if (cut != nullptr && std::abs(height_m(*cut, p)) <= cut->distance_m) ++steps_.steps[k].in_plane;
    steps_.steps[k].sample.add(origin_m_ + p.cast<double>());
    return false;
  }
  if (samples_) steps_.kept.add(origin_m_ + p.cast<double>());
  return true;
}

FilterSteps StreamedFilters::finish(Progress& progress) {
  std::uint64_t left = points_;
  for (std::size_t k = 0; k < tests_.size(); ++k) {
    FilterStep& step = steps_.steps[k];
    if (std::holds_alternative<ValueTest>(tests_[k])) step.found = unknown_text(unknown_[k]);
    at_key_of(filters_[k], [&] {
      if (left > 0 && step.removed == left) throw nothing_left(step.name, step.found);
    });
    const auto* place = std::get_if<PointTest>(&tests_[k]);
    if (place != nullptr && std::holds_alternative<PlaneCut>(*place)) warn_of_plane(step, left, progress);
    left -= step.removed;
  }
  return std::move(steps_);
}

}  // namespace sparsha::pipeline
