// An object's points as they look from a side: heights on a small raster of pixels, and the relief on it.
#pragma once

#include <vector>

#include <Eigen/Core>

#include "scene/config/orientation.h"

namespace sparsha::pipeline {

/// Points thinned evenly, about the middle of their box, in pixels: lengths of 1/150 of the object, or the distance
/// between its points where they are sparser.
struct EvenPoints {
  std::vector<Eigen::Vector3d> points;
  double pixel_m = 0.0;
  int half = 0;  ///< pixels from the middle to the edge of a picture that holds them from any side
};

/// Depends on the set of points alone, not on their order. Without points where they have no extent.
[[nodiscard]] EvenPoints even_points(const std::vector<Eigen::Vector3d>& surface_m);

/// What is seen from a side, without perspective. Rows from the bottom up.
struct SidePicture {
  int side = 0;               ///< pixels: the picture is a square
  std::vector<float> height;  ///< towards the viewer, pixels; NaN where nothing is
  [[nodiscard]] std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(side) + static_cast<std::size_t>(x);
  }
};

/// `look_from` and `up` are of length 1 and at right angles.
[[nodiscard]] SidePicture picture_from(const EvenPoints& object, const Eigen::Vector3d& look_from,
                                       const Eigen::Vector3d& up);

/// Where an object may be looked at from: unit directions to the 26 faces, edges and corners of a cube.
[[nodiscard]] std::vector<Eigen::Vector3d> sides_all_around();

/// Share of the points that no others hide from that side, 0 to 1: nearly 1 for what was scanned from there alone.
[[nodiscard]] double seen_share(const EvenPoints& object, const SidePicture& picture, const Eigen::Vector3d& look_from,
                                const Eigen::Vector3d& up);
/// The share from which an object counts as scanned from one side.
inline constexpr double kOneSided = 0.75;

/// Carving on the surface seen: heights over their surroundings without steps, at the scale of eyes and mouths on a
/// bust, within -1 and 1 pixel; 0 where nothing is.
[[nodiscard]] std::vector<float> relief_of(const SidePicture& picture);
/// The same at another scale: standard deviations of the two Gaussians, pixels, and the most that counts.
[[nodiscard]] std::vector<float> relief_of(const SidePicture& picture, double fine_px, double coarse_px, float most);

}  // namespace sparsha::pipeline
