// Reads and writes the block `unroll`.
#include "scene/config/unroll.h"

#include <cmath>
#include <numbers>
#include <string>

#include <fmt/format.h>
#include <Eigen/LU>

#include "base/text/text.h"
#include "base/yaml/yaml.h"
#include "scene/config/config.h"
#include "scene/config/reader.h"
#include "scene/frame/unrolling.h"

namespace sparsha::scene {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

std::string list(const Eigen::Vector3d& v) {
  return "[" + exact_text(v.x()) + ", " + exact_text(v.y()) + ", " + exact_text(v.z()) + "]";
}

// What means something else, or nothing, on an unrolled mantle.
void require_unrolled_alone(const yaml::Node& node, const Config& config) {
  if (config.around) throw yaml::error_at(node, "unroll and around exclude each other", "one of them");
  if (config.grid.bounds_m)
    throw yaml::error_at(node, "grid.bounds_m is not for an unrolled object", "the filter 'crop', or no bounds_m");
  const OrientationConfig& orientation = config.orientation;
  const Eigen::Matrix3d turn = orientation.scan_to_grid.topLeftCorner<3, 3>();
  if (orientation.face || orientation.regions_scan_to_grid || !(turn * turn.transpose()).isIdentity(1e-6) ||
      turn.determinant() < 0.0) {
    throw yaml::error_at(node, "an unrolled object is only turned by its orientation, by look_from or angles",
                         "no face, scale, mirror image or regions_matrix");
  }
}

}  // namespace

UnrollConfig parse_unroll(const yaml::Node& node, const Config& before) {
  require_unrolled_alone(node, before);
  UnrollConfig unroll;
  if (node.kind == yaml::Node::Kind::null) return unroll;
  yaml::MapReader keys(node, "unroll");
  int shape = 0;
  keys.read_choice("shape", shape, {"auto", "cylinder", "cone"});
  unroll.shape = static_cast<UnrollConfig::Shape>(shape);
  if (const yaml::Node* axis = keys.optional("axis");
      axis != nullptr && !(axis->is_scalar() && axis->scalar == "auto")) {
    if (!axis->is_sequence()) throw yaml::error_at(*axis, "axis is no direction", "auto or three numbers");
    unroll.axis = vector(*axis);
    if (!(unroll.axis->norm() > 0.0))
      throw yaml::error_at(*axis, "axis has no direction", "a vector that is not 0 0 0");
  }
  if (const yaml::Node* centre = keys.optional("centre_m")) {
    unroll.centre_m = vector(*centre);
    if (!unroll.axis)
      throw yaml::error_at(*centre, "centre_m is given without axis", "axis: [x, y, z] beside it, or neither");
  }
  read_number(keys, "radius_m", unroll.radius_m, kSmallest, kAny);
  if (const yaml::Node* slope = keys.optional("slope_deg")) {
    if (unroll.shape != UnrollConfig::Shape::cone)
      throw yaml::error_at(*slope, "slope_deg is of a cone", "shape: cone beside it");
    std::optional<double> degrees;
    read_number(keys, "slope_deg", degrees, -Unrolling::kMostSlope_deg, Unrolling::kMostSlope_deg);
    if (std::abs(*degrees) < Unrolling::kLeastSlope_deg)
      throw yaml::error_at(*slope, "a cone of this slope_deg is a cylinder", "shape: cylinder");
    unroll.slope_rad = kDegree * *degrees;
  }
  keys.finish();
  return unroll;
}

std::string unroll_text(const UnrollConfig& unroll) {
  const char* const shape = unroll.shape == UnrollConfig::Shape::cylinder ? "cylinder"
                            : unroll.shape == UnrollConfig::Shape::cone   ? "cone"
                                                                          : "auto";
  std::string text = "unroll: {axis: " + (unroll.axis ? list(*unroll.axis) : std::string("auto"));
  if (unroll.centre_m) text += ", centre_m: " + list(*unroll.centre_m);
  text += std::string(", shape: ") + shape;
  if (unroll.radius_m) text += ", radius_m: " + exact_text(*unroll.radius_m);
  if (unroll.slope_rad) text += ", slope_deg: " + exact_text(*unroll.slope_rad / kDegree);
  return text + "}\n";
}

}  // namespace sparsha::scene
