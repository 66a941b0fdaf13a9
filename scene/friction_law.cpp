#include "scene/friction_law.h"

#include <algorithm>
#include <cmath>

namespace sparsha::pipeline {
namespace {

/// One value of an optional layer; NaN where the scene has none.
double value_at(const std::vector<float>& layer, std::size_t node) {
  return static_cast<double>(layer.empty() ? kUnknownHeight : layer[node]);
}

}  // namespace

FrictionLaw::FrictionLaw(const SceneDescription& scene, double scale, double workspace_m)
    : config_(*scene.config.friction), c_m_(scene.friction_c_m), scale_(scale), radius_m_(0.5 * workspace_m) {}

float FrictionLaw::dynamic(const Layers& layers, std::size_t node) const {
  double mu = config_.mu_0;
  if (config_.law == FrictionConfig::Law::curvature) {
    const double curvature_per_m = value_at(layers.curvature_per_m, node);
    if (std::isfinite(curvature_per_m)) mu += c_m_ * curvature_per_m;
  } else if (config_.law == FrictionConfig::Law::paper) {
    const double mean = value_at(layers.mean_curvature_per_m, node) / scale_;
    const double gaussian = value_at(layers.gaussian_curvature_per_m2, node) / (scale_ * scale_);
    if (std::isfinite(mean) && std::isfinite(gaussian)) mu = 1.0 / (radius_m_ * std::hypot(mean, gaussian));
  }
  return static_cast<float>(std::clamp(mu, 0.0, config_.mu_max));
}

float FrictionLaw::at_rest(float dynamic) const { return std::max(static_cast<float>(config_.mu_static), dynamic); }

}  // namespace sparsha::pipeline
