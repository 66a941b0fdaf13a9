#include "pipeline/scan/fields.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/text/lower_case.h"
#include "pipeline/scan/cloud.h"

namespace sparsha::pipeline {
namespace {

constexpr std::size_t kBuckets = std::size_t{1} << 16U;
constexpr std::uint32_t kSign = 0x80000000U;

/// Of a number: its sign, exponent and first 7 binary digits, in the order of the numbers.
std::size_t bucket_of(float value) {
  const auto bits = std::bit_cast<std::uint32_t>(value + 0.0F);  // -0 is 0
  return ((bits & kSign) != 0 ? ~bits : bits | kSign) >> 16U;
}

/// The number of a bucket that is nearest to 0.
float number_of(std::size_t bucket) {
  const auto key = static_cast<std::uint32_t>(bucket) << 16U;
  return std::bit_cast<float>((key & kSign) != 0 ? key & ~kSign : ~(key | 0xFFFFU) | kSign);
}

bool is_among(std::string_view name, std::span<const std::string_view> names) {
  return std::find(names.begin(), names.end(), name) != names.end();
}

}  // namespace

std::string field_key(std::string_view name) {
  constexpr std::string_view kBlanks = " \t";
  constexpr std::string_view kCloudCompare = "scalar_";
  const std::size_t begin = name.find_first_not_of(kBlanks);
  if (begin == std::string_view::npos) return {};
  std::string key = lower_case(name.substr(begin, name.find_last_not_of(kBlanks) - begin + 1));
  if (key.starts_with(kCloudCompare) && key.size() > kCloudCompare.size()) key.erase(0, kCloudCompare.size());
  return key == "class" ? PointField::kClass : key;
}

bool tells_worth(std::string_view key) {
  static constexpr std::array<std::string_view, 5> kNames = {PointField::kClass, "confidence", "quality", "opacity",
                                                             "withheld"};
  return is_among(key, kNames);
}

bool is_known_otherwise(std::string_view key) {
  static constexpr std::string_view kNames[] = {"x",
                                                "y",
                                                "z",
                                                "red",
                                                "green",
                                                "blue",
                                                "alpha",
                                                "r",
                                                "g",
                                                "b",
                                                "rgb",
                                                "rgba",
                                                "diffuse_red",
                                                "diffuse_green",
                                                "nx",
                                                "ny",
                                                "nz",
                                                "normal_x",
                                                "normal_y",
                                                "normal_z",
                                                "diffuse_blue",
                                                "colorred",
                                                "colorgreen",
                                                "colorblue",
                                                "nor:normalx",
                                                "nor:normaly",
                                                "nor:normalz",
                                                "diffuse_alpha",
                                                "_",
                                                "cartesianx",
                                                "cartesiany",
                                                "cartesianz",
                                                "sphericalrange",
                                                "sphericalazimuth",
                                                "sphericalelevation",
                                                "cartesianinvalidstate",
                                                "sphericalinvalidstate",
                                                kIntensityField};
  const auto begins = [&](std::string_view with) { return key.starts_with(with); };
  return is_among(key, kNames) || begins("f_dc_") || begins("f_rest_") || begins("scale_") || begins("rot_");
}

void FieldTally::add(std::span<const float> values) {
  if (counts_.empty()) counts_.resize(kBuckets);
  for (const float value : values) {
    if (std::isnan(value)) {
      ++missing_;
      continue;
    }
    ++values_;
    ++counts_[bucket_of(value)];
    least_ = std::min(least_, value);
    most_ = std::max(most_, value);
    whole_ = whole_ && value == std::trunc(value);
  }
}

void FieldTally::write(MessageWriter& message) const {
  message.put(name_);
  message.put(std::array{values_, missing_});
  message.put(std::array{least_, most_});
  message.put(whole_);
  message.put(static_cast<std::uint64_t>(std::ranges::count_if(counts_, [](std::uint64_t n) { return n > 0; })));
  for (std::size_t k = 0; k < counts_.size(); ++k) {
    if (counts_[k] > 0) message.put(std::array<std::uint64_t, 2>{k, counts_[k]});
  }
}

void FieldTally::add(MessageReader& message) {
  name_ = message.text();
  const auto counts = message.get<std::array<std::uint64_t, 2>>();
  values_ += counts[0];
  missing_ += counts[1];
  const auto borders = message.get<std::array<float, 2>>();
  least_ = std::min(least_, borders[0]);
  most_ = std::max(most_, borders[1]);
  whole_ = message.get<bool>() && whole_;
  if (counts_.empty()) counts_.resize(kBuckets);
  const auto buckets = message.get<std::uint64_t>();
  for (std::uint64_t n = 0; n < buckets; ++n) {
    const auto bucket = message.get<std::array<std::uint64_t, 2>>();
    counts_[static_cast<std::size_t>(bucket[0])] += bucket[1];
  }
}

std::uint64_t FieldTally::count(int number) const {
  return counts_.empty() ? 0 : counts_[bucket_of(static_cast<float>(number))];
}

std::uint64_t FieldTally::below(float border) const {
  std::uint64_t sum = 0;
  for (std::size_t k = 0; k < std::min(counts_.size(), bucket_of(border)); ++k) sum += counts_[k];
  return sum;
}

float FieldTally::quantile(double rank) const {
  auto left = static_cast<std::uint64_t>(rank * static_cast<double>(values_ - 1));
  for (std::size_t k = 0; k < counts_.size(); ++k) {
    if (left < counts_[k]) return std::clamp(number_of(k), least_, most_);
    left -= counts_[k];
  }
  return most_;
}

std::vector<ValueCount> few_values(const FieldTally& tally) {
  constexpr std::size_t kFew = 16;
  std::vector<ValueCount> values;
  if (tally.values() == 0 || !tally.is_whole() || tally.least() < 0.0F || tally.most() > 255.0F) return values;
  for (int k = 0; k <= 255; ++k) {
    if (tally.count(k) > 0) values.push_back({k, tally.count(k)});
  }
  return values.size() <= kFew ? values : std::vector<ValueCount>{};
}

std::string_view las_class_name(int number) {
  // LAS 1.4 R15, table 17.
  static constexpr std::array<std::string_view, 23> kNames = {"never classified",
                                                              "unclassified",
                                                              "ground",
                                                              "low vegetation",
                                                              "medium vegetation",
                                                              "high vegetation",
                                                              "building",
                                                              "low noise",
                                                              "model key-point",
                                                              "water",
                                                              "rail",
                                                              "road surface",
                                                              "overlap",
                                                              "wire guard",
                                                              "wire conductor",
                                                              "transmission tower",
                                                              "wire connector",
                                                              "bridge deck",
                                                              "high noise",
                                                              "overhead structure",
                                                              "ignored ground",
                                                              "snow",
                                                              "temporal exclusion"};
  const auto k = static_cast<std::size_t>(number);
  return number >= 0 && k < kNames.size() ? kNames[k] : std::string_view{};
}

}  // namespace sparsha::pipeline
