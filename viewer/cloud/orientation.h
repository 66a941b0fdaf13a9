// Turning an object by hand: turntable, free ball, faces, angles. All change the affine scan -> grid about the scan
// frame's zero; its scale stays.
#pragma once

#include <span>

#include <Eigen/Core>

namespace sparsha::viewer {

/// The scan's axis that points up on the object.
class UpAxis {
 public:
  /// By custom: z, else y.
  UpAxis(bool z_up) : axis_(z_up ? 2 : 1) {}  // NOLINT(google-explicit-constructor)
  UpAxis(int axis, bool down) : axis_(axis), down_(down) {}

  [[nodiscard]] Eigen::Vector3d direction() const { return (down_ ? -1.0 : 1.0) * Eigen::Vector3d::Unit(axis_); }
  /// What custom calls the front of what stands so: -y where z is up or down, else +z.
  [[nodiscard]] Eigen::Vector3d front() const;
  /// "x", "-z", ...
  [[nodiscard]] const char* name() const;
  bool operator==(const UpAxis&) const = default;

 private:
  int axis_;
  bool down_ = false;
};

/// y, z, x, -y, -z, -x.
[[nodiscard]] std::span<const UpAxis> all_up_axes();

/// As a visitor names the sides of an object that stands upright; front is -y where z is up, else +z.
enum class Face { front, back, left, right, top, bottom };
inline constexpr int kFaces = 6;

[[nodiscard]] const char* name_of(Face face);

/// The orientation that looks at that side, with the scale of `present`.
[[nodiscard]] Eigen::Matrix4d seen_from(Face face, UpAxis up, const Eigen::Matrix4d& present);
/// The orientation in which the scans were delivered, with the scale of `present`.
[[nodiscard]] Eigen::Matrix4d as_scanned(const Eigen::Matrix4d& present);

/// Turntable: `turn` about the object's upright axis, `tilt` about the picture's horizontal; radians, without limit.
[[nodiscard]] Eigen::Matrix4d turned(const Eigen::Matrix4d& scan_to_grid, UpAxis up, double turn, double tilt);
/// Free ball: rotations about the picture's x, y and z axes.
[[nodiscard]] Eigen::Matrix4d rolled(const Eigen::Matrix4d& scan_to_grid, double about_x, double about_y,
                                     double about_z);
/// Rolled so that the object's upright axis points up in the picture; where it points at the viewer, the axis of the
/// scan that is nearest to up.
[[nodiscard]] Eigen::Matrix4d upright(const Eigen::Matrix4d& scan_to_grid, UpAxis up);

/// `euler_deg` of a configuration: about fixed axes, x first. Of the rotation nearest to the orientation.
[[nodiscard]] Eigen::Vector3d euler_deg(const Eigen::Matrix4d& scan_to_grid);
[[nodiscard]] Eigen::Matrix4d with_euler(const Eigen::Vector3d& angles_deg, const Eigen::Matrix4d& present);

/// The cube root of the linear part's volume: grid metres per scan metre.
[[nodiscard]] double scale_of(const Eigen::Matrix4d& scan_to_grid);

}  // namespace sparsha::viewer
