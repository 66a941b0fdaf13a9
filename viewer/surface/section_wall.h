// The cut face of a section plane: stone from the surface down to the slab's underside.
#pragma once

#include <functional>

#include <Eigen/Core>

#include "viewer/camera/camera.h"
#include "viewer/gl/objects.h"

namespace sparsha::viewer {

/// World coordinates. What lies where normal . p > offset is left out.
struct CutPlane {
  Eigen::Vector3d normal = -Eigen::Vector3d::UnitY();  ///< unit
  double offset = 0.0;
  bool operator==(const CutPlane&) const = default;
};

/// Needs a current context for its whole life.
class SectionWall {
 public:
  SectionWall();
  /// Height of the surface at x, y; NaN where there is none. World coordinates.
  using Height = std::function<double(double x, double y)>;

  /// Draws into the bound framebuffer and viewport, against its depths. `box`: xmin ymin xmax ymax of the surface.
  /// Nothing for a plane that is not upright. `pixel`: framebuffer pixels per pixel of the picture.
  void draw(const CutPlane& plane, const Eigen::Vector4d& box, double floor_z, const Height& height, const View& view,
            bool plain, int pixel);

 private:
  gl::Program program_;
  gl::Name vertex_array_;
  gl::Name buffer_;
};

}  // namespace sparsha::viewer
