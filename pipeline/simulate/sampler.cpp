// The orthographic sampler: exactly the asked number of points, each a function of the seed and its own number.
#include <algorithm>
#include <cmath>
#include <vector>

#include "pipeline/simulate/frames.h"
#include "pipeline/simulate/generate.h"
#include "pipeline/simulate/plain_math.h"

namespace sparsha::pipeline {
namespace {

constexpr std::uint64_t kBlock = 1U << 16;  // front points a block
constexpr std::uint64_t kGrain = 1U << 11;  // front points a thread takes at once

class Sampler {
 public:
  Sampler(const SimulationConfig& config, const Surface& surface)
      : config_(config),
        sampler_(std::get<SamplerConfig>(config.scan)),
        surface_(surface),
        scan_from_grid_(grid_from_scan_rotation(config).transpose()),
        back_density_(surface.config().back.kind == BackConfig::Kind::none ? 0.0 : surface.config().back.density) {
    const double cell = std::max(surface.width_m(), surface.height_m()) / (config.nodes - 1);
    const double nodes = surface.width_m() * surface.height_m() / (cell * cell);
    count_ = static_cast<std::uint64_t>(std::floor(sampler_.points_per_node * nodes + 0.5));
    log_ratio_ = plain::log(sampler_.density_ratio);
  }

  [[nodiscard]] std::uint64_t count() const { return count_; }
  /// Back points before front point k; they stand between the front points, so that a file has no front half.
  [[nodiscard]] std::uint64_t backs_before(std::uint64_t k) const {
    return static_cast<std::uint64_t>(std::floor(static_cast<double>(k) * back_density_));
  }

  [[nodiscard]] SimulatedPoint point(Stream stream, std::uint64_t k) const {
    Random random(config_.seed, static_cast<std::uint64_t>(stream), k);
    const double u = random.uniform();
    // Inverse of the cumulated exponential density.
    const double share = log_ratio_ == 0.0 ? u : plain::log(1.0 + u * (sampler_.density_ratio - 1.0)) / log_ratio_;
    const double x = surface_.width_m() * share;
    const double y = surface_.height_m() * random.uniform();
    SimulatedPoint point;
    point.is_front = stream == Stream::front;
    const double z = point.is_front ? surface_.z(x, y) : surface_.back_z(x, y);
    const Eigen::Vector3d local(x, y, z + range_error(config_, random, point.is_outlier));
    point.position_m = scan_from_grid_ * local + config_.origin_m;
    if (config_.intensity || config_.colour) {
      shade_point(config_, surface_, x, y, surface_normal(surface_, x, y).z(), point);
    }
    return point;
  }

 private:
  const SimulationConfig& config_;
  const SamplerConfig& sampler_;
  const Surface& surface_;
  Eigen::Matrix3d scan_from_grid_;
  double back_density_;
  std::uint64_t count_ = 0;
  double log_ratio_ = 0.0;
};

}  // namespace

void sample_file(const SimulationConfig& config, const Surface& surface, std::size_t index, const Context& context,
                 const SimulatedPointSink& sink) {
  const Sampler sampler(config, surface);
  const auto files = static_cast<std::uint64_t>(std::get<SamplerConfig>(config.scan).files);
  const std::uint64_t begin = sampler.count() * index / files;
  const std::uint64_t end = sampler.count() * (index + 1) / files;
  std::vector<SimulatedPoint> block;
  for (std::uint64_t first = begin; first < end; first += kBlock) {
    context.progress.at(static_cast<double>(first - begin) / static_cast<double>(end - begin));
    const std::uint64_t last = std::min(end, first + kBlock);
    const auto place = [&](std::uint64_t k) {
      return (k - first) + sampler.backs_before(k) - sampler.backs_before(first);
    };
    block.resize(place(last));
    context.pool.for_ranges(last - first, kGrain, [&](std::size_t low, std::size_t high) {
      for (std::uint64_t k = first + low; k < first + high; ++k) {
        std::uint64_t at = place(k);
        block[at++] = sampler.point(Stream::front, k);
        for (std::uint64_t b = sampler.backs_before(k); b < sampler.backs_before(k + 1); ++b) {
          block[at++] = sampler.point(Stream::back, b);
        }
      }
    });
    sink(block);
  }
}

}  // namespace sparsha::pipeline
