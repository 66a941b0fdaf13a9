// What both ways of making points share, and the whole scan in memory.
#include "pipeline/simulate/generate.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace sparsha::pipeline {

double range_error(const SimulationConfig& config, Random& random, bool& is_outlier) {
  is_outlier = random.uniform() < config.outlier_fraction;
  double error = config.noise_m * random.normal();
  if (is_outlier) error += random.uniform(-config.outlier_spread_m, config.outlier_spread_m);
  return error;
}

Eigen::Vector3d surface_normal(const Surface& surface, double x, double y) {
  const double d = 1e-4 * std::max(surface.width_m(), surface.height_m());
  const double slope_x = (surface.z(x + d, y) - surface.z(x - d, y)) / (2.0 * d);
  const double slope_y = (surface.z(x, y + d) - surface.z(x, y - d)) / (2.0 * d);
  const double length = std::sqrt(1.0 + slope_x * slope_x + slope_y * slope_y);
  return {-slope_x / length, -slope_y / length, 1.0 / length};
}

void shade_point(const SimulationConfig& config, const Surface& surface, double x, double y, double cosine,
                 SimulatedPoint& point) {
  if (!config.intensity && !config.colour) return;
  const double reflectance = surface.reflectance(x, y);
  point.intensity = static_cast<float>(std::clamp(reflectance * std::max(0.05, cosine), 0.0, 1.0));
  const auto channel = [&](double share) {
    return static_cast<std::uint32_t>(std::clamp(255.0 * share * (0.6 + 0.6 * (reflectance - 0.25)), 0.0, 255.0));
  };
  point.rgba = 0xFF000000U | channel(0.66) << 16U | channel(0.86) << 8U | channel(1.05);  // sandstone
}

std::size_t file_count(const SimulationConfig& config) {
  if (const auto* sampler = std::get_if<SamplerConfig>(&config.scan)) return static_cast<std::size_t>(sampler->files);
  return std::get<ScannerConfig>(config.scan).stations.size();
}

void generate_file(const SimulationConfig& config, const Surface& surface, std::size_t index, const Context& context,
                   const SimulatedPointSink& sink) {
  if (std::holds_alternative<SamplerConfig>(config.scan)) {
    sample_file(config, surface, index, context, sink);
  } else {
    scan_station(config, surface, index, context, sink);
  }
}

SimulatedScan generate(const SimulationConfig& config, ThreadPool& pool) {
  const Surface surface(config.surface);
  Progress progress;
  SimulatedScan scan;
  for (std::size_t file = 0; file < file_count(config); ++file) {
    generate_file(config, surface, file, {pool, progress}, [&](std::span<const SimulatedPoint> points) {
      for (const SimulatedPoint& point : points) {
        scan.points_m.push_back(point.position_m);
        scan.is_front.push_back(point.is_front ? 1 : 0);
        scan.is_outlier.push_back(point.is_outlier ? 1 : 0);
        scan.station.push_back(static_cast<std::uint32_t>(file));
        if (config.colour) scan.rgba.push_back(point.rgba);
        if (config.intensity) scan.intensity.push_back(point.intensity);
      }
    });
  }
  return scan;
}

SimulatedScan generate(const SimulationConfig& config) {
  ThreadPool pool;
  return generate(config, pool);
}

}  // namespace sparsha::pipeline
