// The two ways to make points, behind generate_file().
#pragma once

#include <cstdint>

#include "base/threads/context.h"
#include "pipeline/simulate/random.h"
#include "pipeline/simulate/simulate.h"

namespace sparsha::pipeline {

/// Points an orthographic camera sees.
void sample_file(const SimulationConfig& config, const Surface& surface, std::size_t index, const Context& context,
                 const SimulatedPointSink& sink);
/// Points a station's beams meet.
void scan_station(const SimulationConfig& config, const Surface& surface, std::size_t index, const Context& context,
                  const SimulatedPointSink& sink);

/// Signed error along the beam: Gaussian noise, and for an outlier up to the spread either way.
[[nodiscard]] double range_error(const SimulationConfig& config, Random& random, bool& is_outlier);
/// Intensity and colour of stone at (x, y) lit along the beam, `cosine` between beam and normal.
void shade_point(const SimulationConfig& config, const Surface& surface, double x, double y, double cosine,
                 SimulatedPoint& point);
/// Upward unit normal of the front, by central differences.
[[nodiscard]] Eigen::Vector3d surface_normal(const Surface& surface, double x, double y);

/// Random streams; each has its own numbers.
enum class Stream : std::uint64_t { front = 1, back = 2, beam = 3 };

}  // namespace sparsha::pipeline
