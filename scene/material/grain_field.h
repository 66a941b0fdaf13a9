// Grain: the texture's measured spectrum continued above what the scan resolves. Invented, not measured. Heights in
// metres of the stone, a function of the place on it alone: what is felt of it is what is heard.
#pragma once

#include <array>
#include <cstddef>

#include <Eigen/Core>

#include "scene/material/height_spectrum.h"

namespace sparsha::scene {

/// Third-octave bands of one tile of waves, each turned and shifted in a way of its own, so that no path repeats.
/// Immutable; not made on real-time threads (the first one takes some 40 ms, for the tile that all share).
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
  /// The height alone, at a quarter of the cost.
  [[nodiscard]] double height_m(int band, double x_m, double y_m) const noexcept;
  /// On a surface in space: of what lies over the three planes of the axes, each by its share.
  [[nodiscard]] double height_m(int band, const Eigen::Vector3d& place_m, const Eigen::Vector3d& shares) const noexcept;
  /// The gradient of that, as far as it is along those planes.
  [[nodiscard]] Eigen::Vector3d slope(int band, const Eigen::Vector3d& place_m,
                                      const Eigen::Vector3d& shares) const noexcept;
  /// Of the planes x = 0, y = 0 and z = 0 where the surface has this normal: the more it faces along the axis. Their
  /// squares sum up to 1, as variances of heights that know nothing of each other do.
  [[nodiscard]] static Eigen::Vector3d shares(const Eigen::Vector3d& normal) noexcept;
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
  /// Where a place lies on a band's tile: the four nodes around it and their shares.
  struct Corners {
    std::array<const float*, 4> nodes;
    std::array<double, 4> shares;
  };
  [[nodiscard]] Corners corners(const Band& band, double x_m, double y_m) const noexcept;

  std::array<Band, kBands> band_{};
  int bands_ = 0;
  const float* tile_ = nullptr;  // of static storage
};

}  // namespace sparsha::scene
