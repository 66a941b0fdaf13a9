// Heights that grids and surveys write where they have none: -9999, Surfer's 1.70141e38 and the like.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

namespace sparsha::pipeline {

/// Counts such values in a file. Values that no coordinate can have are no data at once; others, such as -9999, when
/// they stand there in bulk, far from all other heights.
class NoDataValues {
 public:
  /// True for a value that may be one; then the file has to be looked at.
  [[nodiscard]] static bool is_candidate(double z) { return std::abs(z) >= kSmallest && is_listed(z); }

  /// Each height of the file, once.
  void add(double z);
  /// After the last one.
  void decide();
  /// Whether a height is no data; after decide().
  [[nodiscard]] bool contains(double z) const;

 private:
  [[nodiscard]] static bool is_listed(double z);

  static constexpr double kSmallest = 9999.0;
  static constexpr std::array<double, 14> kValues = {-9999.0,  -99999.0, -999999.0, 9999.0,   99999.0,
                                                     999999.0, -32768.0, -32767.0,  -9999.99, -9999.9,
                                                     9999.99,  9999.9,   1e10,      -1e10};
  std::array<std::uint64_t, kValues.size()> counts_{};
  std::array<bool, kValues.size()> found_{};
  double low_ = 0.0;
  double high_ = 0.0;
  bool any_ = false;
};

}  // namespace sparsha::pipeline
