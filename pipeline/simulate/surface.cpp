// Closed forms of the known surfaces.
#include "pipeline/simulate/surface.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.h"
#include "pipeline/simulate/forms.h"
#include "pipeline/simulate/noise_field.h"
#include "pipeline/simulate/relief.h"
#include "pipeline/simulate/statue.h"

namespace sparsha::pipeline {
namespace {

constexpr std::uint64_t kBackSeed = 0xBAC4;

}  // namespace

Surface::Surface(const SurfaceConfig& config) : config_(config) {
  if (!(config.width_m > 0.0) || !(config.height_m > 0.0)) {
    throw usage_error("the surface has no area", "expected a width and a height above 0");
  }
  if (const auto* bars = std::get_if<BarsForm>(&config.form); bars != nullptr && !(bars->width_m < bars->pitch_m)) {
    throw usage_error("the bars are as wide as their pitch", "expected width_mm below pitch_mm");
  }
  if (const auto* hall = std::get_if<HallForm>(&config.form);
      hall != nullptr && !(3.0 * std::max(hall->major_m, hall->minor_m) < config.width_m / (hall->minor + 1))) {
    throw usage_error("the pillars leave no room between them", "expected fewer or thinner pillars, or a wider hall");
  }
  if (is_body() && config.back.kind != BackConfig::Kind::none) {
    throw usage_error("a statue has its own back", "expected no `back`");
  }
  if (const auto* relief = std::get_if<ReliefForm>(&config.form)) {
    relief_ = draw_relief(*relief, config.width_m, config.height_m);
  }
  if (config.back.kind == BackConfig::Kind::rough && -config.back.depth_m + config.back.roughness_m >= z_range()[0]) {
    throw usage_error("the back comes out of the front", "expected a greater back depth_mm");
  }
}

double Surface::z(double x, double y) const {
  struct Height {
    const Surface& surface;
    double x, y;
    double operator()(const PlaneForm& f) const { return f.slope_x * x + f.slope_y * y; }
    double operator()(const SinusoidForm& f) const { return form_z(f, x, y); }
    double operator()(const AccuracyForm& f) const { return form_z(f, x, y); }
    double operator()(const BarsForm& f) const { return form_z(f, x, y); }
    double operator()(const ReliefForm&) const { return relief_z(*surface.relief_, x, y); }
    double operator()(const FacadeForm& f) const { return form_z(f, x, y); }
    double operator()(const HallForm& f) const {
      return hall_z(f, surface.config_.width_m, surface.config_.height_m, x, y);
    }
    // Beside the figure it is as deep as its back.
    double operator()(const StatueForm&) const {
      const double depth = statue_depth_m(surface.config_.height_m);
      const auto far = meet_statue(surface.config_.width_m, surface.config_.height_m, {x, y, depth}, {0.0, 0.0, -1.0});
      return depth - std::min(far.value_or(2.0 * depth), 2.0 * depth);
    }
  };
  return std::visit(Height{*this, x, y}, config_.form);
}

double Surface::back_z(double x, double y) const {
  const BackConfig& back = config_.back;
  if (back.kind == BackConfig::Kind::parallel) return z(x, y) - back.depth_m;
  const double size = 0.08;  // metres a lump
  return -back.depth_m + back.roughness_m * fractal_noise(kBackSeed, x / size, y / size, 3, 0.5);
}

double Surface::step_distance_m(double x, double y) const {
  if (const auto* f = std::get_if<AccuracyForm>(&config_.form)) return form_step_distance(*f, x, y);
  if (const auto* f = std::get_if<BarsForm>(&config_.form)) return form_step_distance(*f, x, y);
  if (const auto* f = std::get_if<FacadeForm>(&config_.form)) return form_step_distance(*f, x, y);
  if (const auto* f = std::get_if<HallForm>(&config_.form))
    return hall_step_distance(*f, config_.width_m, config_.height_m, x, y);
  return std::numeric_limits<double>::infinity();
}

double Surface::crease_distance_m(double x, double y) const {
  double distance = step_distance_m(x, y);
  if (const auto* f = std::get_if<AccuracyForm>(&config_.form)) {
    distance = std::min(distance, form_groove_distance(*f, x, y));
  }
  return distance;
}

std::array<double, 2> Surface::z_range() const {
  struct Range {
    const SurfaceConfig& c;
    std::array<double, 2> operator()(const PlaneForm& f) const {
      const double x = f.slope_x * c.width_m;
      const double y = f.slope_y * c.height_m;
      return {std::min(x, 0.0) + std::min(y, 0.0), std::max(x, 0.0) + std::max(y, 0.0)};
    }
    std::array<double, 2> operator()(const SinusoidForm& f) const { return {-f.amplitude_m, f.amplitude_m}; }
    std::array<double, 2> operator()(const AccuracyForm& f) const { return form_range(f); }
    std::array<double, 2> operator()(const BarsForm& f) const { return {0.0, f.bar_m}; }
    std::array<double, 2> operator()(const ReliefForm& f) const { return relief_range(f); }
    std::array<double, 2> operator()(const FacadeForm& f) const { return form_range(f); }
    std::array<double, 2> operator()(const HallForm& f) const { return form_range(f); }
    std::array<double, 2> operator()(const StatueForm&) const {
      return {-statue_depth_m(c.height_m), statue_depth_m(c.height_m)};
    }
  };
  return std::visit(Range{config_}, config_.form);
}

double Surface::reflectance(double x, double y) const {
  if (relief_) return relief_reflectance(*relief_, x, y);
  const double size = 0.05 * std::max(config_.width_m, config_.height_m);
  return std::clamp(0.6 + 0.3 * fractal_noise(0xC01, x / size, y / size, 3, 0.5), 0.0, 1.0);
}

}  // namespace sparsha::pipeline
