// Item POINT10: the 20 bytes that begin the points of formats 0 to 5.
#pragma once

#include <array>
#include <vector>

#include "pipeline/scan/formats/las/laz/fields.h"
#include "pipeline/scan/formats/las/laz/integers.h"

namespace sparsha::pipeline::laz {

/// Version 2, since 2011. next() turns the last point into the next one.
class Point10 {
 public:
  void start(std::uint8_t* item) { put(item + 12, std::uint16_t{0}); }
  void next(Decoder& in, std::uint8_t* item);

 private:
  SymbolModel changed_{64};
  std::vector<SymbolModel> bits_ = models(256, 256), class_ = models(256, 256), user_ = models(256, 256);
  std::vector<SymbolModel> angle_ = models(2, 256);
  IntegerModel dx_{32, 2}, dy_{32, 22}, z_{32, 20}, intensity_{16, 4}, source_{16, 1};
  std::array<RunningMedian, 16> median_x_, median_y_;
  std::array<std::uint16_t, 16> last_intensity_{};
  std::array<std::int32_t, 8> last_z_{};
};

/// Version 1, of 2010.
class Point10First {
 public:
  void next(Decoder& in, std::uint8_t* item);

 private:
  std::int32_t median(const std::array<std::int32_t, 3>& last) const;

  SymbolModel changed_{64};
  std::vector<SymbolModel> bits_ = models(256, 256), class_ = models(256, 256), user_ = models(256, 256);
  IntegerModel dx_{32, 1}, dy_{32, 20}, z_{32, 20}, intensity_{16, 1}, angle_{8, 2}, source_{16, 1};
  std::array<std::int32_t, 3> last_dx_{}, last_dy_{};
  std::size_t oldest_ = 0;
};

}  // namespace sparsha::pipeline::laz
