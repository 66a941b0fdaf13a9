// A terrestrial scanner: beams at multiples of one angular step in azimuth and elevation. What a beam meets first is
// recorded, what lies behind is not.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

#include "base/error.h"
#include "pipeline/simulate/frames.h"
#include "pipeline/simulate/generate.h"
#include "pipeline/simulate/plain_math.h"
#include "pipeline/simulate/raycast.h"
#include "pipeline/simulate/statue.h"

namespace sparsha::pipeline {
namespace {

constexpr std::int64_t kColumnsAtOnce = 64;
constexpr std::int64_t kBeamsAtOnce = 4'000'000;
constexpr std::int64_t kMostElevations = 10'000'000;

/// Beam numbers (azimuth, elevation) that cover the solid, inclusive.
struct FieldOfView {
  std::int64_t azimuth_low, azimuth_high, elevation_low, elevation_high;
};

class Station {
 public:
  Station(const SimulationConfig& config, const Surface& surface, std::size_t index, ThreadPool& pool)
      : config_(config),
        surface_(surface),
        station_(std::get<ScannerConfig>(config.scan).stations.at(index)),
        index_(index),
        behind_(!surface.is_body() && station_.position_m.z() < 0.0),
        axes_(local_from_station_rotation(station_)),
        scan_from_grid_(grid_from_scan_rotation(config).transpose()),
        step_turns_(station_.step_rad / (2.0 * std::numbers::pi)) {
    if (surface.is_body()) {
      if (statue_distance_m(surface.width_m(), surface.height_m(), station_.position_m) <= 0.0) {
        throw usage_error("a station stands inside the statue", "expected it outside");
      }
      return;
    }
    if (behind_ && surface.config().back.kind == BackConfig::Kind::none) {
      throw usage_error("a station stands behind a surface without a back",
                        "expected position_m with z above the surface");
    }
    caster_.emplace([&](double x, double y) { return behind_ ? -surface.back_z(x, y) : surface.z(x, y); },
                    surface.width_m(), surface.height_m(), pool);
    if ((behind_ ? -1.0 : 1.0) * station_.position_m.z() <= caster_->highest_m()) {
      throw usage_error("a station stands inside the solid", "expected it farther from the surface");
    }
  }

  [[nodiscard]] FieldOfView field_of_view() const;

  /// Appends what the beams of one azimuth record, from below upwards. Throws Cancelled.
  void scan_column(const FieldOfView& view, std::int64_t azimuth, std::vector<SimulatedPoint>& points,
                   const Progress& progress) const {
    for (std::int64_t elevation = view.elevation_low; elevation <= view.elevation_high; ++elevation) {
      if ((elevation & 1023) == 0) progress.throw_if_cancelled();
      const double e = static_cast<double>(elevation) * step_turns_;
      const double a = static_cast<double>(azimuth) * step_turns_;
      const double level = plain::cos_turns(e);
      const Eigen::Vector3d direction = axes_.col(0) * (level * plain::sin_turns(a)) +
                                        axes_.col(1) * (level * plain::cos_turns(a)) +
                                        axes_.col(2) * plain::sin_turns(e);
      // Each beam's numbers depend on its own two angles, not on where the field of view begins.
      Random random(
          config_.seed, (static_cast<std::uint64_t>(Stream::beam) << 32U) + index_,
          (static_cast<std::uint64_t>(azimuth) << 32U) ^ (static_cast<std::uint64_t>(elevation) & 0xFFFFFFFFU));
      record(direction, random, points);
    }
  }

 private:
  void record(const Eigen::Vector3d& direction, Random& random, std::vector<SimulatedPoint>& points) const {
    if (!caster_) return record_body(direction, random, points);
    const double side = behind_ ? -1.0 : 1.0;
    const Eigen::Vector3d mirror(1.0, 1.0, side);
    if (side * direction.z() >= 0.0) return;
    const auto hit = caster_->cast(station_.position_m.cwiseProduct(mirror), direction.cwiseProduct(mirror));
    if (!hit) return;
    Eigen::Vector3d at = station_.position_m + hit->distance_m * direction;
    if (hit->on_flank && !flank_is_solid(at)) return;
    SimulatedPoint point;
    point.is_front = !behind_ && !hit->on_flank;
    double cosine = -side * direction.z();
    if ((config_.intensity || config_.colour) && point.is_front) {
      const Eigen::Vector3d normal = surface_normal(surface_, at.x(), at.y());
      cosine = -(normal.x() * direction.x() + normal.y() * direction.y() + normal.z() * direction.z());
    }
    shade_point(config_, surface_, at.x(), at.y(), cosine, point);
    at += range_error(config_, random, point.is_outlier) * direction;
    point.position_m = to_scan(at);
    points.push_back(point);
    if (!behind_ && surface_.config().back.kind != BackConfig::Kind::none) add_back(random, points);
  }

  void record_body(const Eigen::Vector3d& direction, Random& random, std::vector<SimulatedPoint>& points) const {
    const auto far = meet_statue(surface_.width_m(), surface_.height_m(), station_.position_m, direction);
    if (!far) return;
    Eigen::Vector3d at = station_.position_m + *far * direction;
    SimulatedPoint point;
    shade_point(config_, surface_, at.x(), at.y(), 1.0, point);
    at += range_error(config_, random, point.is_outlier) * direction;
    point.position_m = to_scan(at);
    points.push_back(point);
  }

  /// The back as other set-ups have recorded it: so many points a front point, anywhere on it.
  void add_back(Random& random, std::vector<SimulatedPoint>& points) const {
    const double density = surface_.config().back.density;
    auto count = static_cast<int>(std::floor(density));
    if (random.uniform() < density - count) ++count;
    for (int k = 0; k < count; ++k) {
      const double x = random.uniform(0.0, surface_.width_m());
      const double y = random.uniform(0.0, surface_.height_m());
      SimulatedPoint point;
      point.is_front = false;
      shade_point(config_, surface_, x, y, 1.0, point);
      const double z = surface_.back_z(x, y) - range_error(config_, random, point.is_outlier);
      point.position_m = to_scan({x, y, z});
      points.push_back(point);
    }
  }

  [[nodiscard]] bool flank_is_solid(const Eigen::Vector3d& at) const {
    if (surface_.config().back.kind == BackConfig::Kind::none) return false;
    return at.z() <= surface_.z(at.x(), at.y()) && at.z() >= surface_.back_z(at.x(), at.y());
  }

  [[nodiscard]] Eigen::Vector3d to_scan(const Eigen::Vector3d& local) const {
    return scan_from_grid_ * local + config_.origin_m;
  }

  const SimulationConfig& config_;
  const Surface& surface_;
  const StationConfig& station_;
  std::uint64_t index_;
  bool behind_;
  Eigen::Matrix3d axes_;
  Eigen::Matrix3d scan_from_grid_;
  double step_turns_;
  std::optional<HeightCaster> caster_;  ///< none for bodies
};

FieldOfView Station::field_of_view() const {
  const auto range = surface_.z_range();
  const BackConfig& back = surface_.config().back;
  const double low = back.kind == BackConfig::Kind::none ? range[0] : range[0] - back.depth_m - back.roughness_m;
  constexpr int kSamples = 16;
  double azimuth_low = 0.5, azimuth_high = -0.5, elevation_low = 0.5, elevation_high = -0.5;
  for (int i = 0; i <= kSamples; ++i) {
    for (int j = 0; j <= kSamples; ++j) {
      for (const double z : {low, range[1]}) {
        const Eigen::Vector3d corner(surface_.width_m() * i / kSamples, surface_.height_m() * j / kSamples, z);
        const Eigen::Vector3d ray = axes_.transpose() * (corner - station_.position_m);
        const double azimuth = plain::atan2_turns(ray.x(), ray.y());
        const double elevation = plain::atan2_turns(ray.z(), std::sqrt(ray.x() * ray.x() + ray.y() * ray.y()));
        azimuth_low = std::min(azimuth_low, azimuth);
        azimuth_high = std::max(azimuth_high, azimuth);
        elevation_low = std::min(elevation_low, elevation);
        elevation_high = std::max(elevation_high, elevation);
      }
    }
  }
  // The samples miss at most some hundredths of the extreme angles.
  const double margin = 0.02 * std::max(azimuth_high - azimuth_low, elevation_high - elevation_low);
  const auto beam = [&](double turns) { return static_cast<std::int64_t>(std::floor(turns / step_turns_)); };
  const FieldOfView view{beam(azimuth_low - margin), beam(azimuth_high + margin) + 1, beam(elevation_low - margin),
                         beam(elevation_high + margin) + 1};
  constexpr double kMostBeams = 4e9;
  const double beams = static_cast<double>(view.azimuth_high - view.azimuth_low) *
                       static_cast<double>(view.elevation_high - view.elevation_low);
  if (beams > kMostBeams || view.elevation_high - view.elevation_low > kMostElevations) {
    throw usage_error("a station has more than 4e9 beams, or 1e7 above each other", "expected a greater step_mrad");
  }
  return view;
}

}  // namespace

void scan_station(const SimulationConfig& config, const Surface& surface, std::size_t index, const Context& context,
                  const SimulatedPointSink& sink) {
  const Station station(config, surface, index, context.pool);
  const FieldOfView view = station.field_of_view();
  const std::int64_t elevations = view.elevation_high - view.elevation_low + 1;
  const std::int64_t at_once = std::clamp<std::int64_t>(kBeamsAtOnce / elevations, 1, kColumnsAtOnce);
  std::vector<std::vector<SimulatedPoint>> columns(static_cast<std::size_t>(at_once));
  for (std::int64_t first = view.azimuth_low; first <= view.azimuth_high; first += at_once) {
    context.progress.at(static_cast<double>(first - view.azimuth_low) /
                        static_cast<double>(view.azimuth_high + 1 - view.azimuth_low));
    const std::int64_t last = std::min(view.azimuth_high, first + at_once - 1);
    context.pool.for_ranges(static_cast<std::size_t>(last - first + 1), 1, [&](std::size_t begin, std::size_t end) {
      for (std::size_t c = begin; c < end; ++c) {
        columns[c].clear();
        station.scan_column(view, first + static_cast<std::int64_t>(c), columns[c], context.progress);
      }
    });
    for (std::size_t c = 0; c < static_cast<std::size_t>(last - first + 1); ++c) sink(columns[c]);
  }
}

}  // namespace sparsha::pipeline
