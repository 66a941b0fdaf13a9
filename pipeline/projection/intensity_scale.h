// Intensities as integers, whose sums depend on no order.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

namespace sparsha::pipeline {

class IntensityScale {
 public:
  /// `largest`: magnitude of a finite intensity, see largest_magnitude().
  explicit IntensityScale(float largest) : per_one_(largest > 0.0F ? 16777216.0 / static_cast<double>(largest) : 1.0) {}
  /// Nothing of an intensity that is not finite.
  [[nodiscard]] std::optional<std::int64_t> of(float intensity) const;
  /// The intensity of such an integer, or of a mean of several.
  [[nodiscard]] float back(double value) const { return static_cast<float>(value / per_one_); }

 private:
  double per_one_;
};

/// Largest magnitude of the finite ones; 0 when there is none.
[[nodiscard]] float largest_magnitude(const float* values, std::size_t count);

}  // namespace sparsha::pipeline
