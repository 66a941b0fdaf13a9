// Robust local plane or quadric through a few points, evaluated at the origin of their coordinates.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace sparsha::pipeline {

/// A point as a node sees it.
struct NodePoint {
  float z;     ///< metres
  float u, v;  ///< from the node, in spacings
};

struct LocalFit {
  double height_m = 0.0;
  double slope_u_m = 0.0, slope_v_m = 0.0;  ///< metres per spacing
  double loss = 0.0;                        ///< weighted mean of Tukey's, 0 to 1; 0 when the residuals are noise
  std::size_t support = 0;                  ///< points with weight
};

struct LocalFitRule {
  double radius = 1.5;     ///< of the compact kernel (1 - r^2/R^2)^2, spacings
  double noise_m = 0.0;    ///< standard deviation
  double spacing_m = 1.0;  ///< a slope of 1.5 is one standard deviation of the prior that keeps thin supports sane
};

/// Scale of residuals: the noise, but no less than a hundredth of the spacing, below which form decides what fits.
[[nodiscard]] double residual_scale(double noise_m, double spacing_m);

/// Weight of the slopes' prior in the normal equations, for slopes in metres per spacing.
[[nodiscard]] double slope_ridge(double scale_m, double spacing_m);

/// `scratch` is resized as needed. Without support the height is NaN.
[[nodiscard]] LocalFit fit_locally(std::span<const NodePoint> points, const LocalFitRule& rule,
                                   std::vector<float>& scratch);

/// Standard deviation of heights about a quadric through all points, robust (median absolute residual); negative when
/// there are fewer than twelve points.
[[nodiscard]] double residual_scale_m(std::span<const NodePoint> points, std::vector<double>& scratch);

}  // namespace sparsha::pipeline
