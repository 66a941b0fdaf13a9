// Colour and intensity of whole objects: of each node's side of the surface, whatever lies on the other one.
#pragma once

#include <Eigen/Core>

#include "base/threads/context.h"
#include "pipeline/scan/cloud.h"
#include "scene/charts.h"

namespace sparsha::pipeline {

/// Which attributes are wanted, and how the points lie on the surface.
struct AttributeRule {
  bool colour = false;
  bool intensity = false;
  double point_spacing_m = 0.0;
  double noise_m = 0.0;  ///< across the surface
};

/// Sets Sheet::colour_rgba and Sheet::intensity of all sheets where they are asked for and the cloud has them. A node
/// has the mean of the points in its four cells that lie on its tangent plane, by bilinear weights: a point counts for
/// the planes that are no more than half a point spacing farther from it than its nearest one, so that the two faces of
/// a wall keep their own colours. Nodes without points, up to two point spacings from one that has a value, take the
/// mean of their neighbours. Depends neither on threads nor on the points' order.
void add_attributes(scene::Charts& charts, const Cloud& cloud, const Eigen::Matrix4d& scan_to_grid,
                    const AttributeRule& rule, const Context& context);

}  // namespace sparsha::pipeline
