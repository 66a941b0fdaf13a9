// Second derivatives of a texture at nodes whose window is not whole: beside steps, unknown nodes and borders, from the
// nodes of the own layer alone.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <optional>

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

/// Noise of a texture, metres.
struct TextureNoise {
  double node_m;  ///< of one node
  double bend_m;  ///< white noise that would give second derivatives the noise that they have: an envelope takes of it
};

/// a[0] + a[1] x + a[2] y + a[3] x^2 + a[4] x y + a[5] y^2 above a node's value, x and y in scales of its fit.
using Quadratic = std::array<double, 6>;

/// A quartic under a Gaussian twice as wide as a whole window's, whose cubic and quartic terms are held to those that a
/// quadric in the tangent plane has, as far as the noise asks for: ridge regression, averaged over six strengths by how
/// well each explains the window (its marginal likelihood). Smooth surfaces get a wide quadratic, which on one side
/// carries little more noise than a whole window does; where curvature changes towards the border, or noise is low, the
/// fit follows it. Where the wide quartic leaves more than noise, a narrower one takes its place.
class OwnLayerFit {
 public:
  /// `scale`: of the Gaussian, spacings of `spacing_m`; `whole`: gain of a whole window, which ends at 2.5 scales.
  OwnLayerFit(double scale, double spacing_m, const NoiseGain& whole);

  /// Every how many nodes the fit looks: wide windows are thinned.
  [[nodiscard]] int stride() const { return stride_; }

  /// At node (i, j), in metres per spacing (squared). False where fewer than 6 nodes of the layer are in the window or
  /// these stand so that noise would grow more than kMostGain times beyond that of a whole window. `links` have
  /// stride().
  [[nodiscard]] bool fit(const TextureView& texture, const SurfaceLinks& links, int i, int j, const TextureNoise& noise,
                         Derivatives& result, NoiseGain& gain);

  /// A quadratic alone, under a Gaussian 1.5 times as wide as a whole window's; nothing where the nodes do not tell it.
  [[nodiscard]] std::optional<Quadratic> quadratic(const TextureView& texture, const SurfaceLinks& links, int i, int j);
  /// The window that the last fit looked at, of radius() * stride() nodes either way.
  [[nodiscard]] const LayerWindow& window() const { return window_; }
  [[nodiscard]] int radius() const { return radius_; }

 private:
  static constexpr int kColumns = 2 * LayerWindow::kMostRadius + 1;
  static constexpr std::size_t kPowers = 9;  // 0 to 8: a quartic's normal equations

  /// A Gaussian's weights by column (or row), and their sums over runs of columns.
  struct Weights {
    Weights(double scale, int stride, int radius, double width, double reach);
    int radius;
    std::array<double, kColumns> weight{}, place{};
    std::array<std::array<double, 5>, kColumns> data{};  // times powers of the place
    // Over columns before k: weights times powers of the place, then squared weights so.
    std::array<std::array<double, 2 * kPowers>, kColumns + 1> before{};
  };
  struct Fitted {
    Derivatives derivatives;
    NoiseGain gain;
  };
  struct Quartic {
    Fitted fitted;
    double least_gain = 0;  ///< NoiseGain::rms() of the quadratic terms alone
    double misfit_2 = 0;    ///< mean square of what the fit leaves, as if its terms had cost it nothing; 0: cannot tell
  };
  template <std::size_t Degree>
  struct Sums;

  template <std::size_t Degree>
  [[nodiscard]] Sums<Degree> sums(const Weights& weights, const TextureView& texture, int i, int j) const;
  [[nodiscard]] std::optional<Fitted> fit_quadratic(const Weights& weights, const TextureView& texture, int i, int j,
                                                    Quadratic& quadratic) const;
  [[nodiscard]] std::optional<Quartic> fit_quartic(const Weights& weights, const TextureView& texture, int i, int j,
                                                   double noise_m) const;
  [[nodiscard]] double missing_share() const;

  double scale_, spacing_m_;
  int stride_, radius_;
  NoiseGain whole_;
  std::shared_ptr<const Weights> quadratic_, as_whole_, wide_, narrow_;
  LayerWindow window_;
};

}  // namespace sparsha::pipeline
