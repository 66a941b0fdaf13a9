// Rows of nine numbers without names: whether they are the corners of triangles, as some programs write meshes (.raw).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace sparsha::pipeline {

class TriangleRows {
 public:
  using Row = std::array<double, 9>;

  /// One row of nine numbers, in the file's order; the first ones are kept.
  void add(const Row& row) {
    constexpr std::size_t kMostRows = 4096;
    if (rows_.size() < kMostRows) rows_.push_back(row);
  }
  /// One sentence with the remedy; empty when the rows are no triangles.
  [[nodiscard]] std::string doubt() const;

 private:
  std::vector<Row> rows_;
};

}  // namespace sparsha::pipeline
