#include "pipeline/replica/solid.h"

namespace sparsha::pipeline {

Solid::Solid(const ReplicaPlate& plate)
    : plate_(plate),
      nx_(static_cast<std::uint32_t>(plate.nx)),
      ny_(static_cast<std::uint32_t>(plate.ny)),
      cells_(nx_ * ny_),
      feet_(cells_ + (nx_ - 1) * (ny_ - 1)),
      middle_(feet_ + 2 * (nx_ + ny_) - 4) {}

std::uint64_t Solid::triangles() const { return 4ULL * (nx_ - 1) * (ny_ - 1) + 3ULL * (middle_ - feet_); }

std::uint32_t Solid::rim(std::uint32_t k) const {
  if (k < nx_ - 1) return k;
  k -= nx_ - 1;
  if (k < ny_ - 1) return k * nx_ + nx_ - 1;
  k -= ny_ - 1;
  if (k < nx_ - 1) return (ny_ - 1) * nx_ + (nx_ - 1 - k);
  k -= nx_ - 1;
  return (ny_ - 1 - k) * nx_;
}

PointMm Solid::vertex(std::uint32_t number) const {
  const auto place = [this](double i, double j, double z) -> PointMm {
    return {static_cast<float>(i * plate_.spacing_mm), static_cast<float>(j * plate_.spacing_mm),
            static_cast<float>(z)};
  };
  if (number < cells_) return place(number % nx_, number / nx_, plate_.height_mm[number]);
  if (number < feet_) {
    const std::uint32_t cell = number - cells_;
    const auto i = static_cast<int>(cell % (nx_ - 1));
    const auto j = static_cast<int>(cell / (nx_ - 1));
    const double mean =
        0.25 * (static_cast<double>(plate_.at(i, j)) + static_cast<double>(plate_.at(i + 1, j)) +
                static_cast<double>(plate_.at(i, j + 1)) + static_cast<double>(plate_.at(i + 1, j + 1)));
    return place(i + 0.5, j + 0.5, mean);
  }
  if (number < middle_) {
    const std::uint32_t above = rim(number - feet_);
    return place(above % nx_, above / nx_, 0.0);
  }
  return place(0.5 * (nx_ - 1), 0.5 * (ny_ - 1), 0.0);
}

void Solid::for_each_triangle(const ForTriangle& triangle, const ForShare& row) const {
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

}  // namespace sparsha::pipeline
