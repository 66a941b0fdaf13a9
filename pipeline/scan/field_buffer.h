// Values of fields, point by point, for a block that holds some of another block's points.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace sparsha::pipeline {

/// The fields of some points of a block.
class FieldBuffer {
 public:
  void begin(std::span<const std::span<const float>> fields) {
    values_.resize(fields.size());
    for (std::vector<float>& values : values_) values.clear();
  }
  void add(std::span<const std::span<const float>> fields, std::size_t point) {
    for (std::size_t k = 0; k < fields.size(); ++k) {
      if (!fields[k].empty()) values_[k].push_back(fields[k][point]);
    }
  }
  /// Good until the next begin().
  [[nodiscard]] std::span<const std::span<const float>> spans() {
    spans_.assign(values_.begin(), values_.end());
    return spans_;
  }

 private:
  std::vector<std::vector<float>> values_;
  std::vector<std::span<const float>> spans_;
};

}  // namespace sparsha::pipeline
