// The power law of measured heights against heights made with a known one.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <vector>

#include "scene/material/measured_spectrum.h"
#include "tests/support/scenes.h"

namespace sparsha::scene {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

/// Waves in the plane whose heights along any straight line have the two-sided density level * (q / from)^-exponent,
/// from a wave per stone to a fifth of a node's wavelength: what nodes cannot resolve is there too.
class FractalStone {
 public:
  FractalStone(const HeightSpectrum& law, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const auto uniform = [&] { return std::generate_canonical<double, 53>(random); };
    constexpr int kWaves = 500;
    const double p = law.exponent;
    // A density over the plane of c q^-(p + 1) integrates along a line to c q^-p times this.
    const double line = std::sqrt(std::numbers::pi) * std::tgamma(0.5 * p) / std::tgamma(0.5 * (p + 1.0));
    const double c = law.level_m3 * std::pow(law.from_per_m, p) / line;
    const double lowest = law.from_per_m / 40.0;
    const double octaves = std::log(law.from_per_m * 1.6 / lowest);
    for (int k = 0; k < kWaves; ++k) {
      const double q = lowest * std::exp(octaves * (k + uniform()) / kWaves);
      const double variance = c * std::pow(q, -p - 1.0) * kTurn * q * q * octaves / kWaves;
      const double heading = kTurn * uniform();
      waves_.push_back(
          {kTurn * q * std::cos(heading), kTurn * q * std::sin(heading), kTurn * uniform(), std::sqrt(2.0 * variance)});
    }
  }
  double operator()(double x, double y) const {
    double z = 0.0;
    for (const Wave& wave : waves_) z += wave.amplitude_m * std::cos(wave.x * x + wave.y * y + wave.phase);
    return z;
  }

 private:
  struct Wave {
    double x, y, phase, amplitude_m;
  };
  std::vector<Wave> waves_;
};

TEST(HeightSpectrum, OfAStoneIsTheLawThatItWasMadeWith) {
  for (const double exponent : {1.8, 2.6}) {
    const double spacing_m = 0.0008;
    const HeightSpectrum law{4e-14, exponent, 0.5 / spacing_m};
    const FractalStone stone(law, 3);
    const auto scene = sparsha::test::scene_of(stone, 161, 160 * spacing_m, 161);
    const HeightSpectrum found = measure_spectrum(*scene);
    // Continued by an octave: there the two must still agree.
    const double there = 10.0 * std::log10(found.level_m3 / law.level_m3 * std::pow(2.0, exponent - found.exponent));
    std::printf("made q^-%.1f, found q^-%.2f, %+.1f dB at twice the resolution\n", exponent, found.exponent, there);
    EXPECT_NEAR(found.exponent, exponent, 0.5);
    EXPECT_LE(std::abs(there), 3.0);
    EXPECT_DOUBLE_EQ(found.from_per_m, law.from_per_m);
  }
}

TEST(HeightSpectrum, OfNoiseAndOfALevelPlaneContinuesNothing) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> noise(0.0, 1e-4);
  const auto rough = sparsha::test::scene_of([&](double, double) { return noise(random); }, 129, 0.1, 129);
  EXPECT_EQ(measure_spectrum(*rough).level_m3, 0.0);
  const auto level = sparsha::test::scene_of([](double, double) { return 0.25; }, 129, 0.1, 129);
  EXPECT_EQ(measure_spectrum(*level).level_m3, 0.0);
  const auto small = sparsha::test::scene_of(sparsha::test::hills_m, 17, 0.1, 17);
  EXPECT_EQ(measure_spectrum(*small).level_m3, 0.0);
  const auto unknown = sparsha::test::scene_of([](double, double) { return std::nan(""); }, 129, 0.1, 129);
  EXPECT_EQ(measure_spectrum(*unknown).level_m3, 0.0);
}

}  // namespace
}  // namespace sparsha::scene
