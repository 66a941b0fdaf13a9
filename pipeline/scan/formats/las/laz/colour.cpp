#include "pipeline/scan/formats/las/laz/colour.h"

#include <algorithm>

namespace sparsha::pipeline::laz {
namespace {

std::int32_t clamped(std::int32_t value) { return std::clamp(value, 0, 255); }

}  // namespace

void Colour::next(Decoder& in, std::uint8_t* item) {
  const std::uint32_t changed = in.symbol(changed_);
  const auto decode = [&](std::size_t model, std::int32_t prediction) {
    return low_byte(std::int64_t{in.symbol(differences_[model])} + prediction);
  };
  const std::uint8_t old_low = item[0], old_high = item[1];
  if (changed & 1U) item[0] = decode(0, old_low);
  if (changed & 2U) item[1] = decode(1, old_high);
  if ((changed & 64U) == 0) {
    item[2] = item[4] = item[0];
    item[3] = item[5] = item[1];
    return;
  }
  // Green is predicted by red's step, blue by the mean of both; first the low bytes, then the high ones.
  for (std::size_t high = 0; high < 2; ++high) {
    const std::int32_t red_step = item[high] - (high == 0 ? old_low : old_high);
    const std::uint8_t old_green = item[2 + high];
    if (changed & 4U << high) item[2 + high] = decode(2 + high, clamped(red_step + old_green));
    if (changed & 16U << high) {
      const std::int32_t step = (red_step + item[2 + high] - old_green) / 2;
      item[4 + high] = decode(4 + high, clamped(step + item[4 + high]));
    }
  }
}

void ColourFirst::next(Decoder& in, std::uint8_t* item) {
  const std::uint32_t changed = in.symbol(changed_);
  for (std::uint32_t i = 0; i < 6; ++i) {
    if (changed & 1U << i) item[i] = low_byte(bytes_.get(in, item[i], i));
  }
}

void NearInfrared::next(Decoder& in, std::uint8_t* item) {
  const std::uint32_t changed = in.symbol(changed_);
  for (std::uint32_t i = 0; i < 2; ++i) {
    if (changed & 1U << i) item[i] = low_byte(std::int64_t{in.symbol(differences_[i])} + item[i]);
  }
}

}  // namespace sparsha::pipeline::laz
