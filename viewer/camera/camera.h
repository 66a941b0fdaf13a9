// Where the picture is seen from. World coordinates: the scene shifted to its middle and scaled to about unit size, so
// that single precision on the graphics card is enough.
#pragma once

#include <optional>

#include <Eigen/Core>

#include "scene/charts.h"
#include "scene/scene_fwd.h"

namespace sparsha::viewer {

/// Grid frame to world and back.
struct Stage {
  Eigen::Vector3d anchor_m = Eigen::Vector3d::Zero();  ///< grid point at the world's origin
  double unit_m = 1.0;                                 ///< grid metres per world unit
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  ///< grid axes to the world's: of a whole object in the hand

  [[nodiscard]] Eigen::Vector3d to_world(const Eigen::Vector3d& grid_m) const {
    return turn * (grid_m - anchor_m) / unit_m;
  }
  [[nodiscard]] Eigen::Vector3d to_grid_m(const Eigen::Vector3d& world) const {
    return turn.transpose() * world * unit_m + anchor_m;
  }
};
/// The middle of level 0, or of the whole object where there is one; one world unit is the longer side.
[[nodiscard]] Stage stage_of(const scene::SceneDescription& description);
/// True of a scene with charts: a whole object, seen from all sides.
[[nodiscard]] bool is_whole(const scene::SceneDescription& description);
/// A box about a whole object, grid frame, metres: low and high corner. Loose by a few spacings. Requires charts.
struct ObjectBox {
  Eigen::Vector3d low_m, high_m;
};
[[nodiscard]] ObjectBox bounds_of(const scene::Charts& charts);

/// A rectangle of the window in pixels, origin at the TOP left.
struct Rect {
  int x = 0;
  int y = 0;
  int width = 0;
  int height = 0;
  [[nodiscard]] bool contains(double px, double py) const {
    return px >= x && py >= y && px < x + width && py < y + height;
  }
  [[nodiscard]] bool operator==(const Rect&) const = default;
};

/// Turntable camera: looks at `target` from `distance`, tilted from straight above, turned about z, or about y.
struct Camera {
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  ///< world
  bool upright = false;      ///< turned about y, as what stands is seen by a visitor who walks round it
  double turn_rad = 0.0;     ///< about z or y; 0: the world's x points right
  double tilt_rad = 0.0;     ///< 0 looks straight at the relief, along -z
  double distance = 3.0;     ///< world
  double field_rad = 0.5;    ///< vertical field of view; 0: parallel projection
  double half_height = 0.5;  ///< world, of a parallel projection
  double reach = 2.5;        ///< world units around the target that may hold something to see

  /// Columns: the camera's right, up and backwards directions in the world.
  [[nodiscard]] Eigen::Matrix3d axes() const;
};

/// A camera in a rectangle: ready-made matrices. Pixels count from the rectangle's top left.
struct View {
  Eigen::Matrix4d projection = Eigen::Matrix4d::Identity();  ///< world to clip
  Eigen::Matrix4d inverse = Eigen::Matrix4d::Identity();     ///< clip to world
  Eigen::Vector3d eye = Eigen::Vector3d::Zero();             ///< world
  Eigen::Vector3d focus = Eigen::Vector3d::Zero();           ///< world: what the camera looks at
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();        ///< Camera::axes()
  /// Of a depth z, -1 to 1: the distance along the line of sight is depth[1] / (z + depth[0]) with perspective, else
  /// (depth[1] - z) / depth[0].
  Eigen::Vector2d depth = Eigen::Vector2d::Zero();
  bool parallel = false;
  int width = 1;
  int height = 1;

  struct Ray {
    Eigen::Vector3d origin;
    Eigen::Vector3d direction;  ///< unit
  };
  /// Nothing when the point is behind the camera.
  [[nodiscard]] std::optional<Eigen::Vector2d> to_pixel(const Eigen::Vector3d& world) const;
  [[nodiscard]] Ray ray(double x, double y) const;
  /// Where the pixel's ray meets the plane z = `height` of the world; nothing when it does not.
  [[nodiscard]] std::optional<Eigen::Vector3d> on_plane(double x, double y, double world_z) const;
  /// Pixels that one world unit across the line of sight takes at that point.
  [[nodiscard]] double pixels_per_unit(const Eigen::Vector3d& world) const;
  /// True when the box surely lies outside one side of what the camera sees. World.
  [[nodiscard]] bool misses(const Eigen::Vector3d& low, const Eigen::Vector3d& high) const;
};

/// Is stone with this outward normal at this place (grid frame) seen from behind? Never with a zero normal.
[[nodiscard]] bool looks_away(const View& view, const Stage& stage, const Eigen::Vector3d& grid_m,
                              const Eigen::Vector3d& normal);

/// `eye_shift`: world distance of this eye to the right of the middle (0: one eye), with an off-axis frustum whose zero
/// parallax lies at `convergence` times the camera's distance.
[[nodiscard]] View make_view(const Camera& camera, int width, int height, double eye_shift = 0.0,
                             double convergence = 1.0);

}  // namespace sparsha::viewer
