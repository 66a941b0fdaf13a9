// The first column of a table without names, taken as x: whether it is rather a number, a time or an angle.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <unordered_map>

namespace sparsha::pipeline {

class FirstColumn {
 public:
  /// One row's point, in the file's order.
  void add(double x, double y, double z) {
    if (rows_ > 0) step(x, y, z);
    if (rows_++ == 0) first_ = x;
    whole_ = whole_ && is_whole(x);
    rest_whole_ = rest_whole_ && is_whole(y) && is_whole(z);
    x_.add(x);
    y_.add(y);
    z_.add(z);
    if (whole_) count_value(x);
    last_x_ = x;
    last_y_ = y;
    last_z_ = z;
  }

  /// One sentence with the remedy; empty when x may well be x.
  [[nodiscard]] std::string doubt() const;

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
  [[nodiscard]] bool is_time() const;
  [[nodiscard]] bool is_angle() const;

  std::uint64_t rows_ = 0;
  bool whole_ = true;
  bool rest_whole_ = true;
  bool rising_ = true;
  std::uint64_t falls_ = 0;  ///< steps down
  std::uint64_t even_ = 0;   ///< steps like the first one
  double first_ = 0.0, first_step_ = 0.0;
  double last_x_ = 0.0, last_y_ = 0.0, last_z_ = 0.0;
  Range x_, y_, z_;
  /// How often some of the whole values came, chosen by their hashes, so that it is counted for good.
  std::unordered_map<std::int64_t, std::uint64_t> values_;
  std::uint64_t threshold_ = ~std::uint64_t{0};
};

}  // namespace sparsha::pipeline
