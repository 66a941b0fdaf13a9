// Each verdict is that of the first filter that refuses a point.
#include "pipeline/filter/streamed.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

#include "base/files/message.h"
#include "pipeline/filter/plane.h"
#include "pipeline/filter/plane_doubt.h"
#include "pipeline/scan/value_test.h"
#include "scene/config/config.h"

namespace sparsha::pipeline {

namespace {

/// Of what several processes have drawn, each from its share, the sample of all points; gives how many those are. What
/// stands for a cube in any of the samples stands for it among all points, or something does that is there as well.
std::uint64_t join_samples(const ReadingRanks& ranks, double distance_m, PlaneSample& sample, std::uint64_t points) {
  MessageWriter mine;
  mine.put(points);
  const std::vector<Eigen::Vector3f> drawn = sample.take();
  mine.put(std::uint64_t{drawn.size()});
  for (const Eigen::Vector3f& p : drawn) mine.put(std::array{p.x(), p.y(), p.z()});
  ReadingRanks::Bytes bytes = mine.take();
  ranks.join(bytes);
  PlaneSample all(distance_m);
  std::uint64_t count = 0;
  for (MessageReader message(bytes); !message.at_end();) {
    count += message.get<std::uint64_t>();
    for (auto left = message.get<std::uint64_t>(); left > 0; --left) {
      const auto p = message.get<std::array<float, 3>>();
      all.add({p[0], p[1], p[2]});
    }
  }
  sample = std::move(all);
  return count;
}

}  // namespace

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
  if (scans.is_shared()) passed = join_samples(scans.ranks(), config.distance_m, sample, passed);
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

void StreamedFilters::join(const ReadingRanks& ranks) {
  const auto write = [](const StreamedFilters& of) {
    MessageWriter message;
    message.put(of.points_);
    for (const std::uint64_t unknown : of.unknown_) message.put(unknown);
    for (std::size_t k = 0; k < of.tests_.size(); ++k) {
      const FilterStep& step = of.steps_.steps[k];
      message.put(std::array{step.removed, step.in_plane});
      step.sample.write(message);
    }
    of.steps_.kept.write(message);
    return message.take();
  };
  StreamedFilters all = *this;
  all.points_ = 0;
  all.unknown_.assign(unknown_.size(), 0);
  all.steps_.kept = PointSample(FilterSteps::kSample);
  for (FilterStep& step : all.steps_.steps) {
    step.removed = step.in_plane = 0;
    step.sample = PointSample(FilterStep::kSample);
  }
  const auto add = [](StreamedFilters& to, MessageReader& message) {
    to.points_ += message.get<std::uint64_t>();
    for (std::uint64_t& unknown : to.unknown_) unknown += message.get<std::uint64_t>();
    for (std::size_t k = 0; k < to.tests_.size(); ++k) {
      FilterStep& step = to.steps_.steps[k];
      const auto counts = message.get<std::array<std::uint64_t, 2>>();
      step.removed += counts[0];
      step.in_plane += counts[1];
      step.sample.add(message);
    }
    to.steps_.kept.add(message);
  };
  const ReadingRanks::Bytes sum = ranks.merged(write(*this), [&](const auto& first, const auto& second) {
    StreamedFilters two = all;
    for (const ReadingRanks::Bytes* const part : {&first, &second}) {
      MessageReader message(*part);
      add(two, message);
    }
    return write(two);
  });
  MessageReader message(sum);
  add(all, message);
  *this = std::move(all);
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
