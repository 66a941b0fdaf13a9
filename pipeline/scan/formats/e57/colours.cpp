#include "pipeline/scan/formats/e57/colours.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "pipeline/scan/scalar.h"
#include "pipeline/scan/writer.h"

namespace sparsha::pipeline::e57 {
namespace {

constexpr double kByte = 255.0, kWord = 65535.0;

/// The greatest value that the field's type can have; infinite for floating-point numbers.
double most_of(const Field& field) {
  if (field.kind != Field::Kind::integer) return std::numeric_limits<double>::infinity();
  const double ends[] = {static_cast<double>(field.minimum), static_cast<double>(field.maximum)};
  return std::max(ends[0] * field.scale, ends[1] * field.scale) + field.offset;  // a scale may be negative
}

}  // namespace

ColourLimits::ColourLimits(const std::array<const Field*, 3>& channels, const pugi::xml_node& limits,
                           const NumberOf& number_of)
    : whole_(channels[0]->kind == Field::Kind::integer), stated_(limits) {
  constexpr const char* kLeast[] = {"colorRedMinimum", "colorGreenMinimum", "colorBlueMinimum"};
  constexpr const char* kMost[] = {"colorRedMaximum", "colorGreenMaximum", "colorBlueMaximum"};
  for (std::size_t k = 0; k < 3; ++k) {
    most_[k] = most_of(*channels[k]);
    high_[k] = std::isinf(most_[k]) ? 1.0 : most_[k];
    if (!stated_) continue;
    const std::size_t from = limits.child(kMost[k]) ? k : 0;  // red's where a channel has none
    low_[k] = number_of(limits.child(kLeast[from]));
    high_[k] = number_of(limits.child(kMost[from]));
    if (high_[k] > low_[k]) continue;
    low_[k] = 0.0;
    high_[k] = whole_ ? kByte : 1.0;
  }
}

bool ColourLimits::may_exceed() const {
  for (std::size_t k = 0; k < 3; ++k) {
    if (most_[k] > high_[k]) return true;
  }
  return false;
}

bool ColourLimits::may_be_bytes() const {
  return whole_ && std::all_of(high_.begin(), high_.end(), [](double high) { return high >= kWord; });
}

bool ColourLimits::look(const std::array<double, 3>& values) {
  for (std::size_t k = 0; k < 3; ++k) {
    if (values[k] > largest_[k] && std::isfinite(values[k])) largest_[k] = values[k];
  }
  const double largest = *std::max_element(largest_.begin(), largest_.end());
  return may_exceed() || largest <= (high_[0] > kWord ? kWord : kByte);
}

void ColourLimits::set(double high) {
  low_.fill(0.0);
  high_.fill(high);
}

std::optional<std::string> ColourLimits::settle() {
  const double largest = *std::max_element(largest_.begin(), largest_.end());
  for (std::size_t k = 0; k < 3; ++k) {
    if (largest_[k] <= high_[k] * kColourOvershoot) continue;
    const double limit = high_[k];
    const ColourScale scale = colour_scale(largest, !whole_);
    const double usual = scale == ColourScale::unit ? 1.0 : scale == ColourScale::byte ? kByte : kWord;
    const double most = *std::max_element(most_.begin(), most_.end());
    set(std::max(largest > usual * kColourOvershoot ? largest : 0.0, std::min(usual, most)));
    return fmt::format(
        "its colours go up to {:.6g}, beyond their limit of {:.6g}; they are read as values from 0 to {:.6g}", largest,
        limit, high_[0]);
  }
  if (!may_be_bytes() || largest > kWord) return std::nullopt;
  const double limit = high_[0];
  if (largest <= kByte) {
    set(kByte);
  } else if (!stated_) {
    set(kWord);  // the type may have no limit
  }
  if (!stated_ || largest > kByte || largest == 0.0) return std::nullopt;
  return fmt::format(
      "its colours go up to {:.6g}, far below their limit of {:.6g}; they are read as values from 0 to {:.6g}", largest,
      limit, kByte);
}

std::uint32_t ColourLimits::rgba(const std::array<double, 3>& values) const {
  const auto channel = [&](std::size_t k) {
    return colour_byte((values[k] - low_[k]) * (kByte / (high_[k] - low_[k])), ColourScale::byte);
  };
  return pack_rgba(channel(0), channel(1), channel(2));
}

}  // namespace sparsha::pipeline::e57
