// What LAS points have beside places, colours and intensities: classes, flags, times, and the numbers that programs add
// to them ("extra bytes").
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/scan/formats/las/header.h"
#include "pipeline/scan/scalar.h"

namespace sparsha::pipeline::las {

/// Where a point record has a number.
struct PointField {
  std::string name;
  std::size_t offset = 0;  ///< bytes
  ScalarType type = ScalarType::u8;
  unsigned shift = 0;  ///< of some bits of a byte
  unsigned mask = 0;   ///< 0: all of the number
  double scale = 1.0;
  double bias = 0.0;
  std::optional<double> no_data{};  ///< before scaling

  [[nodiscard]] std::size_t end() const { return offset + size_of(type); }
  /// NaN where there is none.
  [[nodiscard]] double value(const char* point) const;
};

/// By the format and the record of extra bytes, as far as that fits.
[[nodiscard]] std::vector<PointField> point_fields(const Header& header);

/// At the end of each record, of which no record of the header says what they are.
[[nodiscard]] std::size_t undescribed_bytes(const Header& header);

}  // namespace sparsha::pipeline::las
