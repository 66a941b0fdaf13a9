// The power law that the spectrum of measured heights follows, so that it can be continued above what a scan resolves.
#pragma once

#include <vector>

namespace sparsha::scene {

/// Power spectral density of heights along a straight line, two-sided: level_m3 * (q / from_per_m)^-exponent at q
/// cycles per metre. Beyond `from_per_m` the scan resolves nothing. Lengths in metres of the stone.
struct HeightSpectrum {
  double level_m3 = 0.0;  ///< 0: no spectrum is known, and nothing is continued
  double exponent = 0.0;
  double from_per_m = 0.0;
};

/// Nodes of a profile that the spectrum is fitted to.
inline constexpr int kLongestProfile = 128;
inline constexpr int kShortestProfile = 32;

/// Collects the periodograms of profiles and fits a line to the logarithms of their medians. Not for real-time threads.
class HeightSpectrumFit {
 public:
  /// `length`: nodes of each profile, a multiple of 4 from kShortestProfile to kLongestProfile; `spacing_m` between
  /// them.
  HeightSpectrumFit(int length, double spacing_m);
  /// `length` heights, metres, all measured. Mean and slope are taken away, a Hann window is laid over the rest.
  void add(const std::vector<double>& heights_m);
  /// Wavelengths from a 16th of the profiles' length to four nodes. A spectrum that falls more slowly than 1 / q is
  /// noise, and so is one of heights without any texture: level 0. Steeper than q^-4 counts as q^-4.
  [[nodiscard]] HeightSpectrum fit() const;

 private:
  int length_;
  double spacing_m_;
  int first_;  // of the fitted frequencies, in cycles per profile
  int last_;
  std::vector<double> window_;
  std::vector<double> cosine_;
  std::vector<std::vector<double>> densities_m3_;  // per frequency, one value per profile
};

}  // namespace sparsha::scene
