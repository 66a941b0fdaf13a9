// Gradient noise on a hashed lattice (Perlin 2002): smooth, seeded, the same bits everywhere.
#pragma once

#include <cstdint>

namespace sparsha::pipeline {

/// About -0.7 to 0.7, zero at integers, twice differentiable; one feature per unit.
[[nodiscard]] double gradient_noise(std::uint64_t seed, double x, double y);

/// Octaves of gradient noise, each of half the size and `gain` times the height of the one before.
[[nodiscard]] double fractal_noise(std::uint64_t seed, double x, double y, int octaves, double gain);

}  // namespace sparsha::pipeline
