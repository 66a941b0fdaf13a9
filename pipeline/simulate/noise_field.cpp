// Perlin's improved noise with hashed unit gradients.
#include "pipeline/simulate/noise_field.h"

#include <array>
#include <cmath>

#include "base/numbers/hash.h"

namespace sparsha::pipeline {
namespace {

constexpr double kDiagonal = 0.70710678118654752;
constexpr std::array<std::array<double, 2>, 8> kGradients{{{1, 0},
                                                           {kDiagonal, kDiagonal},
                                                           {0, 1},
                                                           {-kDiagonal, kDiagonal},
                                                           {-1, 0},
                                                           {-kDiagonal, -kDiagonal},
                                                           {0, -1},
                                                           {kDiagonal, -kDiagonal}}};

double corner(std::uint64_t seed, std::int64_t i, std::int64_t j, double dx, double dy) {
  const auto column = static_cast<std::uint64_t>(i) * kGoldenStep;
  const auto row = static_cast<std::uint64_t>(j) * 0xC2B2AE3D27D4EB4FULL;
  const auto& gradient = kGradients[mix_bits(seed + column + row) >> 61];
  return gradient[0] * dx + gradient[1] * dy;
}

double fade(double t) { return t * t * t * (t * (t * 6.0 - 15.0) + 10.0); }

}  // namespace

double gradient_noise(std::uint64_t seed, double x, double y) {
  const double fx = std::floor(x);
  const double fy = std::floor(y);
  const auto i = static_cast<std::int64_t>(fx);
  const auto j = static_cast<std::int64_t>(fy);
  const double dx = x - fx;
  const double dy = y - fy;
  const double u = fade(dx);
  const double v = fade(dy);
  const double low = corner(seed, i, j, dx, dy) * (1.0 - u) + corner(seed, i + 1, j, dx - 1.0, dy) * u;
  const double high =
      corner(seed, i, j + 1, dx, dy - 1.0) * (1.0 - u) + corner(seed, i + 1, j + 1, dx - 1.0, dy - 1.0) * u;
  return low * (1.0 - v) + high * v;
}

double fractal_noise(std::uint64_t seed, double x, double y, int octaves, double gain) {
  double sum = 0.0;
  double amplitude = 1.0;
  for (int octave = 0; octave < octaves; ++octave) {
    sum += amplitude * gradient_noise(seed + static_cast<std::uint64_t>(octave), x, y);
    x *= 2.0;
    y *= 2.0;
    amplitude *= gain;
  }
  return sum;
}

}  // namespace sparsha::pipeline
