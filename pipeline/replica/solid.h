// The triangles of a plate: top, four walls and bottom, closed and turned outwards.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>

#include "base/progress.h"
#include "pipeline/replica/replica.h"

namespace sparsha::pipeline {

using PointMm = std::array<float, 3>;

/// Vertices by number: the plate's nodes row by row, the middles of its cells row by row, its border's feet on the
/// bottom counter-clockwise from the lower left corner, the bottom's middle. A cell's middle has the mean of its
/// corners, so that four triangles hold exactly what the bilinear cell does.
class Solid {
 public:
  explicit Solid(const ReplicaPlate& plate);

  [[nodiscard]] std::uint32_t vertices() const { return middle_ + 1; }
  [[nodiscard]] std::uint64_t triangles() const;
  [[nodiscard]] PointMm vertex(std::uint32_t number) const;
  /// Calls triangle(a, b, c), counter-clockwise seen from outside; row(share) now and then.
  template <typename Triangle, typename Row>
  void for_each_triangle(Triangle&& triangle, Row&& row) const {
    for (std::uint32_t j = 0; j + 1 < ny_; ++j) {
      if (j % 64 == 0) row(static_cast<double>(j) / ny_);
      for (std::uint32_t i = 0; i + 1 < nx_; ++i) {
        const std::uint32_t a = j * nx_ + i;
        const std::uint32_t middle = cells_ + j * (nx_ - 1) + i;
        triangle(a, a + 1, middle);
        triangle(a + 1, a + 1 + nx_, middle);
        triangle(a + 1 + nx_, a + nx_, middle);
        triangle(a + nx_, a, middle);
      }
    }
    const std::uint32_t around = middle_ - feet_;
    for (std::uint32_t k = 0; k < around; ++k) {
      const std::uint32_t next = (k + 1) % around;
      triangle(feet_ + k, feet_ + next, rim(next));
      triangle(feet_ + k, rim(next), rim(k));
      triangle(feet_ + next, feet_ + k, middle_);
    }
  }

 private:
  /// The node above the k-th foot.
  [[nodiscard]] std::uint32_t rim(std::uint32_t k) const;

  const ReplicaPlate& plate_;
  std::uint32_t nx_, ny_;
  std::uint32_t cells_, feet_, middle_;  // first numbers
};

void write_stl(const Solid& solid, const std::filesystem::path& file, const std::string& shown, Progress& progress);
void write_3mf(const Solid& solid, const std::filesystem::path& file, const std::string& shown, Progress& progress);

}  // namespace sparsha::pipeline
