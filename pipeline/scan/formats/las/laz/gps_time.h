// Times of points: 64-bit patterns of doubles, in up to four interleaved sequences.
#pragma once

#include <array>

#include "pipeline/scan/formats/las/laz/fields.h"
#include "pipeline/scan/formats/las/laz/integers.h"

namespace sparsha::pipeline::laz {

/// GPSTIME11 version 2, and the times of layered points, which lack the symbol "unchanged".
class GpsTime {
 public:
  explicit GpsTime(bool layered)
      : zero_(layered ? 5 : 6), multi_(layered ? 515 : 516), zero_shift_(layered ? 1 : 0), layered_(layered) {}
  void start(const std::uint8_t* item) { time_[0] = get<std::uint64_t>(item); }
  void next(Decoder& in, std::uint8_t* item);

 private:
  [[nodiscard]] bool step(Decoder& in);
  [[nodiscard]] bool step_by_multiple(Decoder& in);
  void advance(std::int32_t difference) { time_[last_] += static_cast<std::uint64_t>(std::int64_t{difference}); }
  void note_extreme(std::int32_t difference);
  void begin_sequence(Decoder& in);

  SymbolModel zero_, multi_;
  std::uint32_t zero_shift_;
  bool layered_;
  IntegerModel integers_{32, 9};
  std::array<std::uint64_t, 4> time_{};
  std::array<std::int32_t, 4> difference_{}, extremes_{};
  std::uint32_t last_ = 0, newest_ = 0;
};

/// GPSTIME11 version 1: one sequence.
class GpsTimeFirst {
 public:
  void next(Decoder& in, std::uint8_t* item);

 private:
  SymbolModel zero_{3}, multi_{512};
  IntegerModel integers_{32, 6};
  std::int32_t difference_ = 0, extremes_ = 0;
};

}  // namespace sparsha::pipeline::laz
