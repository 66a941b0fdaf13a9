// The configuration's block `filters`: what is done to the points before they are projected, in order.
#pragma once

#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "base/error.h"

namespace sparsha::scene {

struct CropConfig {
  Eigen::Vector3d min_m;  ///< scan frame, after poses
  Eigen::Vector3d max_m;
};

struct VoxelConfig {
  double leaf_m = 0.0005;
};

struct OutlierConfig {
  enum class Method { fast, pcl };
  int neighbours = 8;
  double sigma = 2.0;
  Method method = Method::fast;
};

/// Keeps points that have at least `neighbours` others within the radius; the others are outliers.
struct RadiusOutlierConfig {
  enum class Method { fast, pcl };
  double radius_m = 0.005;
  int neighbours = 4;
  Method method = Method::fast;
};

/// Keeps points from `min_m` to `max_m` along an axis of the scan frame, borders included.
struct PassConfig {
  int axis = 2;  ///< 0 x, 1 y, 2 z
  double min_m = -std::numeric_limits<double>::infinity();
  double max_m = std::numeric_limits<double>::infinity();
};

/// Takes away the largest plane whose normal lies within `max_angle_deg` of `normal`, and what lies beyond it.
struct RemovePlaneConfig {
  enum class Side { below, above, both };  ///< both: the plane alone
  double distance_m = 0.005;
  Side side = Side::below;
  Eigen::Vector3d normal{0, 0, 1};  ///< scan frame, any length but 0; from below to above
  double max_angle_deg = 15.0;
};

/// Keeps one group of points, each within `tolerance_m` of another of the group.
struct KeepConfig {
  enum class Method { fast, pcl };
  std::optional<Eigen::Vector3d> nearest_to_m;  ///< scan frame; absent: the largest
  double tolerance_m = 0.01;
  Method method = Method::fast;
};

/// Moves points to the polynomial that fits their neighbours within the radius (moving least squares).
struct SmoothConfig {
  enum class Method { fast, pcl };
  double radius_m = 0.003;
  int order = 2;  ///< 1: a plane
  Method method = Method::fast;
};

/// Leaves at most so many points in every cube with the grid's spacing as its side.
struct ThinConfig {
  int points_per_node = 4;
};

/// Keeps points of which the file says a value from `min` to `max`, borders included.
struct FieldConfig {
  std::string name;  ///< as `info` lists it: "confidence", "opacity", "quality", "intensity"
  double min = -std::numeric_limits<double>::infinity();
  double max = std::numeric_limits<double>::infinity();
};

/// Keeps points by their class, 0 to 255: the listed ones, or all but the listed ones. One of the lists is empty.
struct ClassesConfig {
  std::vector<int> keep;
  std::vector<int> drop;
};

/// One entry of `filters`.
struct FilterConfig
    : std::variant<CropConfig, VoxelConfig, OutlierConfig, RadiusOutlierConfig, PassConfig, RemovePlaneConfig,
                   KeepConfig, SmoothConfig, ThinConfig, FieldConfig, ClassesConfig> {
  using variant::variant;
  Place place;  ///< of its key in the configuration, for errors that the data show; empty when it was not read
};

/// The filter's key in a configuration, e.g. "remove_plane".
[[nodiscard]] std::string filter_name(const FilterConfig& filter);

}  // namespace sparsha::scene
