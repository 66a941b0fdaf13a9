// What the graphics card is given of a piece of a scene: heights, slopes, baked light and tones, one value per node.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "base/threads/thread_pool.h"
#include "scene/depth_grid.h"
#include "scene/scene_fwd.h"
#include "viewer/surface/joints.h"

namespace sparsha::viewer {

/// Where the key light comes from, grid frame.
struct KeyLight {
  double azimuth_rad = 2.35619449019234493;  ///< from +x towards +y: 135 degrees is the upper left
  double elevation_rad = 0.52;               ///< above the lattice; low, so that it rakes

  /// Unit, towards the light.
  [[nodiscard]] Eigen::Vector3d direction() const {
    const double across = std::cos(elevation_rad);
    return {across * std::cos(azimuth_rad), across * std::sin(azimuth_rad), std::sin(elevation_rad)};
  }
};

/// A piece of one level, ready to draw. Vectors hold lattice.count() nodes, row 0 at the bottom.
struct ReliefData {
  scene::Lattice lattice;
  int level = 0;
  scene::Layers layers;             ///< as read
  bool envelope = false;            ///< heights are the envelope's (texture switched off)
  std::vector<float> height_m;      ///< relative to lattice.origin_m.z; unknown nodes continued
  std::vector<std::uint8_t> known;  ///< 1 where a height is measured or filled
  Joints joints;                    ///< which neighbours belong to one surface
  std::vector<float> slope;         ///< dz/dx and dz/dy of each node, interleaved
  std::vector<std::uint8_t> tone;   ///< four bytes per node: sky light, curvature (128 flat), known, filled
  double rms_slope = 0.0;           ///< of known nodes
  double height_min_m = 0.0;        ///< grid frame, of known nodes
  double height_max_m = 0.0;
  bool any_filled = false;
  bool any_unknown = false;
  double border_known = 0.0;  ///< share of the border's nodes that are known

  /// Height of the drawn surface at (x, y) of the grid frame, grid frame; clamped to the lattice.
  [[nodiscard]] double height_at(double x_m, double y_m) const;
};

/// Reads nothing; all work is on `layers`. `noise_m` keeps noise from being drawn as form. Cost: about 0.2 us per node
/// and thread.
[[nodiscard]] ReliefData prepare_relief(scene::Layers layers, int level, bool envelope, double noise_m,
                                        ThreadPool& pool);

/// The key light's share at each node, 0 to 255; not `soft`: of a light without extent, at a fifth of the cost.
[[nodiscard]] std::vector<std::uint8_t> bake_shadow(const ReliefData& relief, const KeyLight& light, ThreadPool& pool,
                                                    bool soft = true);

/// The finest level of which no side exceeds `limit` nodes, or the coarsest.
[[nodiscard]] int level_within(const scene::SceneDescription& description, int limit);

}  // namespace sparsha::viewer
