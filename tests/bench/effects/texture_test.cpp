// The measure of texture is right on signals whose spectra are known, and every method on its own truth.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "bench/effects/texture.h"
#include "bench/effects/wavelet.h"

namespace sparsha::bench {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

std::vector<double> tones(double low, double middle, double high, double phase) {
  std::vector<double> signal;
  for (int tick = 0; tick < 4096; ++tick) {
    const double t = 0.001 * tick;
    signal.push_back(low * std::sin(kTurn * 6.0 * t + phase) + middle * std::sin(kTurn * 18.0 * t + phase) +
                     high * std::sin(kTurn * 70.0 * t + phase));
  }
  return signal;
}

TEST(TextureSpectra, GainsOfKnownTonesAreFoundBandByBand) {
  TextureRow row;
  compare_spectra(tones(0.5, 2.0, 0.0, 0.0), tones(1.0, 1.0, 1.0, 0.0), 0.001, row);
  EXPECT_NEAR(row.gain[0], 0.5, 1e-3);
  EXPECT_NEAR(row.gain[1], 2.0, 1e-3);
  EXPECT_NEAR(row.gain[2], 0.0, 1e-3);
  EXPECT_NEAR(row.coherence[0], 1.0, 1e-3);
  EXPECT_NEAR(row.coherence[1], 1.0, 1e-3);
  // Amplitudes off by 0.5, 1 and 1 of three ones.
  EXPECT_NEAR(row.spectrum_error, std::sqrt((0.25 + 1.0 + 1.0) / 3.0), 1e-2);
}

TEST(TextureSpectra, APhaseOfSixtyDegreesHalvesTheCoherenceAndLeavesTheAmplitudes) {
  TextureRow row;
  compare_spectra(tones(1.0, 1.0, 1.0, kTurn / 6.0), tones(1.0, 1.0, 1.0, 0.0), 0.001, row);
  for (const double gain : row.gain) EXPECT_NEAR(gain, 1.0, 1e-2);
  for (const double coherence : row.coherence) EXPECT_NEAR(coherence, 0.5, 1e-2);
  EXPECT_LT(row.spectrum_error, 0.02);
}

TEST(TextureWavelets, TheTransformKeepsEnergyAndIsUndoneByItsInverse) {
  std::mt19937 random(5);
  std::vector<double> samples;
  double energy = 0.0;
  for (int n = 0; n < 1024; ++n) {
    samples.push_back(static_cast<double>(random()) * 0x1p-32 - 0.5);
    energy += samples.back() * samples.back();
  }
  const std::vector<double> coefficients = wavelet_transform(samples);
  double kept = 0.0;
  for (const double c : coefficients) kept += c * c;
  EXPECT_NEAR(kept, energy, 1e-12 * energy);
  const std::vector<double> back = inverse_wavelet_transform(coefficients);
  for (std::size_t n = 0; n < samples.size(); ++n) EXPECT_NEAR(back[n], samples[n], 1e-13);
}

TEST(TextureWavelets, ALineHasNoDetailAwayFromItsEnds) {
  std::vector<double> line;
  for (int n = 0; n < 64; ++n) line.push_back(0.25 * n);
  const std::vector<double> coefficients = wavelet_transform(line);
  // Two vanishing moments; the last detail of the finest level spans the jump from the end to the beginning.
  for (std::size_t n = 32; n < 63; ++n) EXPECT_NEAR(coefficients[n], 0.0, 1e-12);
  EXPECT_GT(std::abs(coefficients[63]), 1.0);
}

TEST(Texture, TheTrueForceLeadsToTheNearestPointOfTheProfile) {
  const Profile profile;
  const TextureStroke stroke;
  for (int tick = 0; tick < stroke.ticks; tick += 37) {
    const Eigen::Vector2d hand = stroke.hand(tick);
    const double found = true_force_m(profile, hand).norm();
    double nearest = 1.0;
    for (int n = -2000; n <= 2000; ++n) {
      const double x = hand.x() + 5e-7 * n;
      nearest = std::min(nearest, (Eigen::Vector2d(x, profile.height(x)) - hand).norm());
    }
    EXPECT_LE(found, nearest + 1e-12) << tick;
    EXPECT_GE(found, nearest - 1e-8) << tick;
  }
}

TEST(Texture, EveryMethodIsNearerToTheProfileTheMoreItStores) {
  const std::vector<TextureRow> rows = texture_rows();
  const TextureRow* before = nullptr;
  for (const TextureRow& row : rows) {
    std::printf(
        "%-9s %-30s gain %.3f %.3f %.3f coherence %.3f %.3f %.3f spectrum %.3f lateral %.3f force %.3f %zu "
        "numbers %.0f ns\n",
        row.method.c_str(), row.setting.c_str(), row.gain[0], row.gain[1], row.gain[2], row.coherence[0],
        row.coherence[1], row.coherence[2], row.spectrum_error, row.lateral, row.force_error, row.numbers,
        row.tick_p50_ns);
    if (before != nullptr && before->method == row.method) {
      const bool more = row.numbers > before->numbers;
      EXPECT_LE(more ? row.spectrum_error : before->spectrum_error,
                (more ? before->spectrum_error : row.spectrum_error) + 1e-3)
          << row.method << ", " << row.setting;
    }
    before = &row;
  }
  // An eighth of the shortest wave between nodes: heights within (2 pi / 8)^2 / 8 of an amplitude.
  EXPECT_LT(rows.front().spectrum_error, 0.01);
  EXPECT_NEAR(rows.front().lateral, 1.0, 0.05);
  EXPECT_LT(rows.front().force_error, 0.05);
}

}  // namespace
}  // namespace sparsha::bench
