// Closed objects whose surface is known: points uniform by area with their outward normals, and the height of the front
// as seen along -z, which shares no code with the sampling. For tests and benchmarks of the projection.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace sparsha::test {

/// A point of a surface and its outward unit normal.
struct SurfacePoint {
  Eigen::Vector3d position_m;
  Eigen::Vector3d normal;
};

/// Immutable; in the frame it is seen in: x right, y up, z towards the viewer, metres.
class ClosedObject {
 public:
  virtual ~ClosedObject() = default;
  [[nodiscard]] virtual double area_m2() const = 0;
  /// Uniform by area.
  [[nodiscard]] virtual SurfacePoint sample(std::mt19937_64& random) const = 0;
  /// Height of the surface that is seen first from +z; nothing outside the silhouette.
  [[nodiscard]] virtual std::optional<double> front_m(double x, double y) const = 0;
  /// Signed distance to the surface, negative inside; further away than a few percent of the object it may be less than
  /// the true one. NaN for meshes.
  [[nodiscard]] virtual double distance_m(const Eigen::Vector3d& /*place_m*/) const {
    return std::numeric_limits<double>::quiet_NaN();
  }
  /// Bounds in x and y: {xmin, ymin, xmax, ymax}.
  [[nodiscard]] virtual std::array<double, 4> bounds_m() const = 0;
};

using ObjectPtr = std::shared_ptr<const ClosedObject>;

/// Rotation that shows an object turned by `about_x` after `about_y`, degrees.
[[nodiscard]] Eigen::Matrix3d turned(double about_x_deg, double about_y_deg);

/// Analytic shapes of about 2 m; front heights by sphere tracing of their exact distance functions.
/// Ring of radius 1 and tube 0.4, its axis turned from the viewer.
[[nodiscard]] ObjectPtr make_torus(const Eigen::Matrix3d& view = turned(35.0, 15.0));
/// Radius 1, and half of that 1.2 m before it, aside of its centre.
[[nodiscard]] ObjectPtr make_two_spheres(const Eigen::Matrix3d& view = Eigen::Matrix3d::Identity());
/// A vessel with an open mouth and a wall of 0.06 m, about the y axis.
[[nodiscard]] ObjectPtr make_vase(const Eigen::Matrix3d& view);
/// A tube of radius 0.22 bent to a trefoil knot, which passes before itself three times.
[[nodiscard]] ObjectPtr make_knot(const Eigen::Matrix3d& view = turned(20.0, 0.0));

/// A disc of radius 1.04 and thickness 0.08 with a round edge: two flat sides that are near each other, and hardly any
/// flank between them.
[[nodiscard]] ObjectPtr make_coin(const Eigen::Matrix3d& view = turned(20.0, 25.0));

/// A box with sharp edges and these half sides, metres; about zero.
[[nodiscard]] ObjectPtr make_box(const Eigen::Vector3d& half_m, const Eigen::Matrix3d& view);

/// A cube with sides of twice `half_m` whose edges are cut at 45 degrees, `bevel_m` off either face; about zero.
/// Outside, before an edge, the distance is up to a twelfth less than the true one.
[[nodiscard]] ObjectPtr make_bevelled_cube(double half_m, double bevel_m, const Eigen::Matrix3d& view);

/// A mesh as it lies in a file, seen along its own -z; its front is the highest triangle over (x, y). Nothing when
/// there is no such file. Throws Error when it cannot be read or has no faces.
[[nodiscard]] ObjectPtr load_mesh_object(const std::filesystem::path& file);

struct NamedObject {
  std::string name;
  ObjectPtr object;
};
/// All analytic shapes, the vase from the side and obliquely from above.
[[nodiscard]] std::vector<NamedObject> analytic_objects();
/// The closed meshes of a collection of real scans that are there, named by file; none when `folder` is empty.
[[nodiscard]] std::vector<NamedObject> mesh_objects(const std::filesystem::path& folder);

}  // namespace sparsha::test
