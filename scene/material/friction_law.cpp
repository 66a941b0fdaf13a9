#include "scene/material/friction_law.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "scene/area/regions.h"
#include "scene/scene.h"

namespace sparsha::scene {
namespace {

/// One value of an optional layer; NaN where the scene has none.
double value_at(const std::vector<float>& layer, std::size_t node) {
  return static_cast<double>(layer.empty() ? kUnknownHeight : layer[node]);
}

}  // namespace

FrictionLaw::FrictionLaw(const SceneDescription& scene, double scale, double workspace_m)
    : config_(*scene.config.friction),
      c_m_(scene.friction_c_m),
      scale_(scale),
      radius_m_(0.5 * workspace_m),
      scene_(scene) {
  for (std::size_t k = 0; k < scene.config.parts.size(); ++k) {
    const PartConfig& part = scene.config.parts[k];
    if (!part.touch.mu_dynamic) continue;
    const double mu = *part.touch.mu_dynamic;
    parts_.push_back({area_of(scene, k), mu, part.touch.mu_static.value_or(std::max(config_.mu_static, mu))});
  }
}

// Grid frame; what is not known lies at the grid's own zero.
Eigen::Vector3d FrictionLaw::place_of(const Layers& layers, std::size_t node) const {
  const Lattice& lattice = layers.grid.lattice;
  const auto nx = static_cast<std::size_t>(lattice.nx);
  const double height_m = static_cast<double>(layers.grid.height_m[node]);
  return {lattice.x_m(static_cast<int>(node % nx)), lattice.y_m(static_cast<int>(node / nx)),
          lattice.origin_m.z() + (std::isfinite(height_m) ? height_m : 0.0)};
}

double FrictionLaw::with_parts(const Eigen::Vector3d& place_m, double mu, double Part::*own) const {
  Eigen::Vector3d place = place_m;
  if (scene_.region_from_grid) place = (*scene_.region_from_grid * place_m.homogeneous()).head<3>();
  for (auto part = parts_.rbegin(); part != parts_.rend(); ++part)
    mu += ((*part).*own - mu) * part->area.share_inside(place, kBorder_m / scale_);
  return mu;
}

double FrictionLaw::of_curvature(double curvature_per_m) const {
  return std::isfinite(curvature_per_m) ? config_.mu_0 + c_m_ * curvature_per_m : config_.mu_0;
}

float FrictionLaw::dynamic(const Layers& layers, std::size_t node) const {
  double mu = config_.mu_0;
  if (config_.law == FrictionConfig::Law::curvature) {
    mu = of_curvature(value_at(layers.curvature_per_m, node));
  } else if (config_.law == FrictionConfig::Law::paper) {
    const double mean = value_at(layers.mean_curvature_per_m, node) / scale_;
    const double gaussian = value_at(layers.gaussian_curvature_per_m2, node) / (scale_ * scale_);
    if (std::isfinite(mean) && std::isfinite(gaussian)) mu = 1.0 / (radius_m_ * std::hypot(mean, gaussian));
  }
  mu = std::clamp(mu, 0.0, config_.mu_max);
  if (!parts_.empty()) mu = with_parts(place_of(layers, node), mu, &Part::mu_dynamic);
  return static_cast<float>(mu);
}

float FrictionLaw::at_rest(const Layers& layers, std::size_t node, float dynamic) const {
  double mu = config_.mu_static;
  if (!parts_.empty()) mu = with_parts(place_of(layers, node), mu, &Part::mu_static);
  return std::max(static_cast<float>(mu), dynamic);
}

FrictionLaw::Coefficients FrictionLaw::at(const Eigen::Vector3d& place_m, double curvature_per_m) const {
  double mu = config_.law == FrictionConfig::Law::curvature ? of_curvature(curvature_per_m) : config_.mu_0;
  mu = std::clamp(mu, 0.0, config_.mu_max);
  double rest = config_.mu_static;
  if (!parts_.empty()) {
    mu = with_parts(place_m, mu, &Part::mu_dynamic);
    rest = with_parts(place_m, rest, &Part::mu_static);
  }
  return {static_cast<float>(mu), std::max(static_cast<float>(rest), static_cast<float>(mu))};
}

}  // namespace sparsha::scene
