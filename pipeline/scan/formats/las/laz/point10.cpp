#include "pipeline/scan/formats/las/laz/point10.h"

#include <algorithm>
#include <cstdlib>

namespace sparsha::pipeline::laz {
namespace {

// Where things are in the item.
constexpr std::size_t kX = 0, kY = 4, kZ = 8, kIntensity = 12, kBits = 14, kClass = 15, kAngle = 16, kUser = 17,
                      kSource = 18;

/// Context from the number of returns (row) and the return.
constexpr std::uint8_t kReturnMap[8][8] = {
    {15, 14, 13, 12, 11, 10, 9, 8},  {14, 0, 1, 3, 6, 10, 10, 9},    {13, 1, 2, 4, 7, 11, 11, 10},
    {12, 3, 4, 5, 8, 12, 12, 11},    {11, 6, 7, 8, 9, 13, 13, 12},   {10, 10, 11, 12, 13, 14, 14, 13},
    {9, 10, 11, 12, 13, 14, 15, 14}, {8, 9, 10, 11, 12, 13, 14, 15},
};

void add_to(std::uint8_t* at, std::int32_t difference) {
  put(at, get<std::uint32_t>(at) + static_cast<std::uint32_t>(difference));
}
std::uint8_t next_byte(Decoder& in, std::vector<SymbolModel>& by_last, std::uint8_t last) {
  return static_cast<std::uint8_t>(in.symbol(by_last[last]));
}

}  // namespace

void Point10::next(Decoder& in, std::uint8_t* item) {
  const std::uint32_t changed = in.symbol(changed_);
  if (changed & 32U) item[kBits] = next_byte(in, bits_, item[kBits]);
  const std::uint32_t r = item[kBits] & 7U;
  const std::uint32_t n = item[kBits] >> 3U & 7U;
  const std::uint32_t m = kReturnMap[n][r];
  const std::uint32_t level = n > r ? n - r : r - n;
  const std::uint32_t single = n == 1 ? 1 : 0;
  if (changed != 0) {
    if (changed & 16U) {
      last_intensity_[m] = static_cast<std::uint16_t>(intensity_.get(in, last_intensity_[m], std::min(m, 3U)));
    }
    put(item + kIntensity, last_intensity_[m]);
    if (changed & 8U) item[kClass] = next_byte(in, class_, item[kClass]);
    if (changed & 4U) item[kAngle] = low_byte(item[kAngle] + std::int64_t{in.symbol(angle_[item[kBits] >> 6U & 1U])});
    if (changed & 2U) item[kUser] = next_byte(in, user_, item[kUser]);
    if (changed & 1U) {
      put(item + kSource, static_cast<std::uint16_t>(source_.get(in, get<std::uint16_t>(item + kSource))));
    }
  }
  const std::int32_t dx = dx_.get(in, median_x_[m].get(), single);
  add_to(item + kX, dx);
  median_x_[m].add(dx);
  const std::int32_t dy = dy_.get(in, median_y_[m].get(), single + even_context(dx_.size(), 20));
  add_to(item + kY, dy);
  median_y_[m].add(dy);
  last_z_[level] = z_.get(in, last_z_[level], single + even_context((dx_.size() + dy_.size()) / 2, 18));
  put(item + kZ, last_z_[level]);
}

std::int32_t Point10First::median(const std::array<std::int32_t, 3>& last) const {
  return std::max(std::min(last[0], last[1]), std::min(std::max(last[0], last[1]), last[2]));
}

void Point10First::next(Decoder& in, std::uint8_t* item) {
  const std::int32_t dx = dx_.get(in, median(last_dx_));
  const std::int32_t dy = dy_.get(in, median(last_dy_), std::min(dx_.size(), 19U));
  last_dx_[oldest_] = dx;
  last_dy_[oldest_] = dy;
  oldest_ = (oldest_ + 1) % 3;
  const std::uint32_t size = (dx_.size() + dy_.size()) / 2;
  add_to(item + kX, dx);
  add_to(item + kY, dy);
  put(item + kZ, z_.get(in, get<std::int32_t>(item + kZ), std::min(size, 19U)));
  const std::uint32_t changed = in.symbol(changed_);
  const auto word = [&](IntegerModel& model, std::size_t at) {
    put(item + at, static_cast<std::uint16_t>(model.get(in, get<std::uint16_t>(item + at))));
  };
  if (changed & 32U) word(intensity_, kIntensity);
  if (changed & 16U) item[kBits] = next_byte(in, bits_, item[kBits]);
  if (changed & 8U) item[kClass] = next_byte(in, class_, item[kClass]);
  if (changed & 4U) item[kAngle] = low_byte(angle_.get(in, item[kAngle], size < 3 ? 1 : 0));
  if (changed & 2U) item[kUser] = next_byte(in, user_, item[kUser]);
  if (changed & 1U) word(source_, kSource);
}

}  // namespace sparsha::pipeline::laz
