// Grain: the texture's measured spectrum continued above what the scan resolves. Invented, not measured. Heights in
// metres of the stone, a function of the place on it alone.
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "haptics/effects/height_spectrum.h"

namespace sparsha::haptics {

/// Third-octave bands of one tile of waves, each turned and shifted in a way of its own, so that no path repeats.
/// Immutable; made off the servo thread (the first one takes some 40 ms, for the tile that all share).
class GrainField {
 public:
  static constexpr int kBands = 18;  // six octaves

  GrainField() = default;
  explicit GrainField(const HeightSpectrum& spectrum);

  [[nodiscard]] bool silent() const noexcept { return bands_ == 0; }
  /// Shortest waves of a band, cycles per metre of the stone.
  [[nodiscard]] double highest_per_m(int band) const noexcept { return band_[index(band)].highest_per_m; }
  [[nodiscard]] int bands() const noexcept { return bands_; }

  struct Value {
    double height_m = 0.0;
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();
  };
  /// Of one band at a place, metres. No allocation.
  [[nodiscard]] Value at(int band, double x_m, double y_m) const noexcept;
  /// Standard deviation of a band's heights.
  [[nodiscard]] double deviation_m(int band) const noexcept { return band_[index(band)].deviation_m; }

 private:
  static std::size_t index(int band) noexcept { return static_cast<std::size_t>(band); }
  struct Band {
    double highest_per_m = 0.0;
    double deviation_m = 0.0;
    double per_m = 0.0;  // nodes of the tile per metre
    double cosine = 1.0;
    double sine = 0.0;
    double shift_x = 0.0;
    double shift_y = 0.0;
  };
  std::array<Band, kBands> band_{};
  int bands_ = 0;
  const float* tile_ = nullptr;  // of static storage
};

/// The force of the grain under a hand that slides: press times slope, along the surface. As the potential
/// press * height has just this slope, what it gives to the hand it has taken before.
class Grain {
 public:
  struct Input {
    double period_s = 0.001;  ///< since the last tick
    double nominal_period_s = 0.001;
    Eigen::Vector2d place_m = Eigen::Vector2d::Zero();  ///< on the stone, frame of its parts and sounds
    Eigen::Vector3d moved_m = Eigen::Vector3d::Zero();  ///< of the proxy in contact since the last tick, device frame
    double scale = 1.0;                                 ///< device metres per metre of the stone
    bool contact = false;                               ///< in this tick and the last
  };
  struct Output {
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();  ///< of the stone's grain where it is touched, faded by speed
    double deviation_m = 0.0;                         ///< standard deviation of its heights, metres of the stone
  };
  /// Servo thread only; no allocation.
  [[nodiscard]] Output update(const Input& input, const GrainField& field) noexcept;
  void reset() noexcept { *this = Grain(); }

 private:
  Eigen::Vector3d slow_m_per_s_ = Eigen::Vector3d::Zero();  // of the proxy, low-passed
  Eigen::Vector3d fast_m_per_s_ = Eigen::Vector3d::Zero();
  double period_s_ = 0.0;
};

}  // namespace sparsha::haptics
