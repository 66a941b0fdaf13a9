// The triangles of a plate: top, four walls and bottom, closed and turned outwards.
#pragma once

#include <cstdint>
#include <string>

#include "pipeline/replica/print_file.h"
#include "pipeline/replica/replica.h"

namespace sparsha::pipeline {

/// Vertices by number: the plate's nodes row by row, the middles of its cells row by row, its border's feet on the
/// bottom counter-clockwise from the lower left corner, the bottom's middle. A cell's middle has the mean of its
/// corners, so that four triangles hold exactly what the bilinear cell does.
class Solid : public PrintedMesh {
 public:
  explicit Solid(const ReplicaPlate& plate);

  [[nodiscard]] std::string name() const override { return "relief"; }
  [[nodiscard]] std::uint32_t vertices() const override { return middle_ + 1; }
  [[nodiscard]] std::uint64_t triangles() const override;
  [[nodiscard]] PointMm vertex(std::uint32_t number) const override;
  void for_each_triangle(const ForTriangle& triangle, const ForShare& row) const override;

 private:
  /// The node above the k-th foot.
  [[nodiscard]] std::uint32_t rim(std::uint32_t k) const;

  const ReplicaPlate& plate_;
  std::uint32_t nx_, ny_;
  std::uint32_t cells_, feet_, middle_;  // first numbers
};

}  // namespace sparsha::pipeline
