// Second derivatives of a texture at nodes whose window is not whole: beside steps, unknown nodes and borders, from the
// nodes of the own layer alone.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include "pipeline/layers/surface_links.h"

namespace sparsha::pipeline {

/// Derivatives of heights over spacings.
struct Derivatives {
  double h_x = 0, h_y = 0, h_xx = 0, h_xy = 0, h_yy = 0;
};

/// What unit white noise becomes in second derivatives.
struct NoiseGain {
  double bend_x = 0, bend_y = 0;  ///< variances of h_xx and of h_yy
  double twist = 0;               ///< variance of h_xy
  double covariance = 0;          ///< of h_xx and h_yy
  /// Of k: the mean square of the principal curvatures.
  [[nodiscard]] double rms() const { return (bend_x + bend_y) / 2 + twist; }
};

/// Texture f - f_b of a lattice, metres; the heights f themselves without an envelope.
struct TextureView {
  const float* height;
  const float* envelope;
  std::size_t row_nodes;
  [[nodiscard]] float at(std::size_t node) const {
    return envelope == nullptr ? height[node] : height[node] - envelope[node];
  }
};

/// a[0] + a[1] x + a[2] y + a[3] x^2 + a[4] x y + a[5] y^2 above a node's value, x and y in scales of its fit.
using Quadratic = std::array<double, 6>;

/// Three weighted fits, each of which counts as far as it differs from those before by more than noise, or what the fit
/// itself leaves of the surface, explains:
/// a quadratic under a Gaussian 1.5 times as wide as a whole window's, which on one side carries no more noise than
/// that does, but gives the curvature of a place inside; a cubic, which follows a curvature that changes towards the
/// border, and carries noise seven times over; a narrower cubic, nearly as true as a whole window, for clean surfaces.
class OwnLayerFit {
 public:
  /// `scale`: of the Gaussian, spacings; `whole`: gain of a whole window, which ends at 2.5 scales.
  OwnLayerFit(double scale, const NoiseGain& whole);

  /// Every how many nodes the fit looks: wide windows are thinned.
  [[nodiscard]] int stride() const { return stride_; }

  /// At node (i, j), in the texture's unit per spacing (squared). `noise` of the texture, its own unit. False where
  /// fewer than 6 nodes of the layer are in the window or these stand so that noise would grow more than kMostGain
  /// times beyond that of a whole window. `links` have stride(). About 2 us for a scale of 3 spacings.
  [[nodiscard]] bool fit(const TextureView& texture, const SurfaceLinks& links, int i, int j, double noise,
                         Derivatives& result, NoiseGain& gain);

  /// The quadratic alone; nothing where fit() would be false.
  [[nodiscard]] std::optional<Quadratic> quadratic(const TextureView& texture, const SurfaceLinks& links, int i, int j);
  /// The window that the last fit looked at, of radius() * stride() nodes either way.
  [[nodiscard]] const LayerWindow& window() const { return window_; }
  [[nodiscard]] int radius() const { return radius_; }

 private:
  static constexpr int kColumns = 2 * LayerWindow::kMostRadius + 1;
  static constexpr std::size_t kPowers = 7;  // 0 to 6: a cubic's normal equations

  /// A Gaussian's weights by column (or row), and their sums over runs of columns.
  struct Weights {
    Weights(double scale, int stride, int radius, double width);
    int radius;
    std::array<double, kColumns> weight{}, place{};
    std::array<std::array<double, 4>, kColumns> data{};  // times powers of the place
    // Over columns before k: weights times powers of the place, then squared weights so.
    std::array<std::array<double, 2 * kPowers>, kColumns + 1> before{};
  };

  [[nodiscard]] std::size_t missing_share(const Weights& weights) const;
  struct Fitted {
    Derivatives derivatives;
    NoiseGain gain;
    Quadratic quadratic{};
    double misfit_2 = 0;  ///< mean square of what the fit leaves, as if its terms had cost it nothing
  };
  [[nodiscard]] std::optional<Fitted> fit_quadratic(const TextureView& texture, const SurfaceLinks& links, int i,
                                                    int j);
  template <std::size_t Terms>
  [[nodiscard]] std::optional<Fitted> fit_terms(const Weights& weights, const TextureView& texture, int i, int j) const;

  double scale_;
  int stride_, radius_;
  NoiseGain whole_;
  // The quadratic's; the cubics', from those of whole windows to those of windows that miss half.
  std::shared_ptr<const Weights> quadratic_;
  std::shared_ptr<const std::vector<Weights>> cubic_, narrow_cubic_;
  LayerWindow window_;
};

}  // namespace sparsha::pipeline
