// The first column of a table without names, taken as x: whether it is rather a number, a time or an angle.
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <unordered_map>

#include "pipeline/scan/formats/text/time_column.h"

namespace sparsha::pipeline {

class FirstColumn {
 public:
  /// One row's point, in the file's order, and the value behind it; not a number when there is none.
  void add(double x, double y, double z, double next) {
    if (rows_ > 0) step(x, y, z);
    if (rows_++ == 0) first_ = x;
    whole_ = whole_ && is_whole(x);
    rest_whole_ = rest_whole_ && is_whole(y) && is_whole(z);
    x_.add(x);
    y_.add(y);
    z_.add(z);
    if (whole_) count_value(x);
    any_next_ = any_next_ || !std::isnan(next);
    fractions_ += !is_whole(y) && !is_whole(z) && !std::isnan(next) && !is_whole(next) ? 1 : 0;
    time_.add({x, y, z, next});
    last_x_ = x;
    last_y_ = y;
    last_z_ = z;
  }

  /// One sentence with the remedy; empty when x may well be x. `more_behind_z`: colours or normals stand directly
  /// behind.
  [[nodiscard]] std::string doubt(bool more_behind_z) const;

 private:
  struct Range {
    double low = std::numeric_limits<double>::infinity();
    double high = -low;
    double way = 0.0;  ///< sum of the steps' magnitudes
    void add(double v) {
      low = v < low ? v : low;
      high = v > high ? v : high;
    }
    [[nodiscard]] double size() const { return high - low; }
  };
  static bool is_whole(double v) {
    return v == static_cast<double>(static_cast<std::int64_t>(v < 9e15 && v > -9e15 ? v : 0.5));
  }
  void step(double x, double y, double z);
  void count_value(double x);
  [[nodiscard]] bool is_number() const;
  [[nodiscard]] bool is_constant() const;
  [[nodiscard]] bool is_group() const;
  [[nodiscard]] bool is_even_time() const;
  [[nodiscard]] bool is_time() const;
  [[nodiscard]] bool is_angle() const;

  std::uint64_t rows_ = 0;
  bool whole_ = true;
  bool rest_whole_ = true;
  bool rising_ = true;
  std::uint64_t falls_ = 0;      ///< steps down
  std::uint64_t fractions_ = 0;  ///< rows whose three values behind x are all fractions
  std::uint64_t even_ = 0;       ///< steps like the first one
  double first_ = 0.0, first_step_ = 0.0;
  bool any_next_ = false;  ///< columns behind z
  TimeColumn time_;
  double last_x_ = 0.0, last_y_ = 0.0, last_z_ = 0.0;
  Range x_, y_, z_;
  /// How often some of the whole values came, chosen by their hashes, so that it is counted for good.
  std::unordered_map<std::int64_t, std::uint64_t> values_;
  std::uint64_t threshold_ = ~std::uint64_t{0};
};

}  // namespace sparsha::pipeline
