// Values of vertices through colour maps; colours of the front view by its nearest node.
#include "viewer/object/paint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include "base/numbers/statistics.h"
#include "scene/material/friction_law.h"
#include "scene/scene.h"

namespace sparsha::viewer {
namespace {

/// Size of the values that all but 2 % have, from about 16000 samples.
double usual(const std::vector<double>& values) {
  std::vector<double> some;
  const std::size_t stride = std::max<std::size_t>(1, values.size() / 16384);
  for (std::size_t k = 0; k < values.size(); k += stride) some.push_back(std::abs(values[k]));
  return quantile(some, 0.98);
}

std::vector<double> heights(const ObjectView& object, Legend& legend) {
  std::vector<double> values(object.finest().place.size());
  for (std::size_t v = 0; v < values.size(); ++v) values[v] = 1e3 * object.place_m(v).z();
  const double low = *std::ranges::min_element(values);
  for (double& value : values) value -= low;
  legend.unit = "mm";
  legend.high = std::max(*std::ranges::max_element(values), 1e-6);
  return values;
}

/// From the direction of the front: up to a right angle on what faces it, more behind.
std::vector<double> slopes(const ObjectView& object, Legend& legend) {
  const std::vector<Eigen::Vector3f>& normal = object.finest().normal;
  std::vector<double> values(normal.size());
  for (std::size_t v = 0; v < values.size(); ++v)
    values[v] = std::acos(std::clamp(static_cast<double>(normal[v].z()), -1.0, 1.0)) * 180.0 / std::numbers::pi;
  legend.unit = "\xC2\xB0";
  legend.high = std::clamp(usual(values), 1.0, 180.0);
  return values;
}

std::vector<double> curvatures(const ObjectView& object, Legend& legend) {
  std::vector<double> values(object.finest().curvature.begin(), object.finest().curvature.end());
  for (double& value : values) value /= object.spacing_m();
  legend.unit = "1/m";
  legend.map = ColourMap::diverging;
  legend.high = std::max(usual(values), 1e-6);
  legend.low = -legend.high;
  return values;
}

std::vector<double> sky_seen(const ObjectView& object, Legend& legend) {
  std::vector<double> values(object.finest().sky.begin(), object.finest().sky.end());
  for (double& value : values) value *= 100.0;
  legend.unit = "%";
  legend.high = 100.0;
  return values;
}

/// The front view's node that lies on the object's surface at a place, if one does.
std::optional<std::size_t> front_node(const ReliefData& front, const Eigen::Vector3d& place_m, double near_m) {
  const scene::Lattice& lattice = front.lattice;
  const double i = std::round((place_m.x() - lattice.origin_m.x()) / lattice.spacing_m);
  const double j = std::round((place_m.y() - lattice.origin_m.y()) / lattice.spacing_m);
  if (!(i >= 0.0 && j >= 0.0 && i < lattice.nx && j < lattice.ny)) return std::nullopt;
  const std::size_t k = lattice.index(static_cast<int>(i), static_cast<int>(j));
  const double steep = std::hypot(front.slope[2 * k], front.slope[2 * k + 1]);
  const double off_m = std::abs(front.height_at(place_m.x(), place_m.y()) - place_m.z());
  if (front.known[k] == 0 || off_m > near_m * std::sqrt(1.0 + steep * steep)) return std::nullopt;
  return k;
}

std::vector<double> textures(const ObjectView& object, Legend& legend) {
  std::vector<double> values(object.finest().texture_m.begin(), object.finest().texture_m.end()), known;
  for (double& value : values) value *= 1e3;
  std::ranges::copy_if(values, std::back_inserter(known), [](double value) { return std::isfinite(value); });
  legend.unit = "mm";
  legend.map = ColourMap::diverging;
  legend.high = std::max(known.empty() ? 0.0 : usual(known), 1e-6);
  legend.low = -legend.high;
  return values;
}

/// As a hand feels it that has the whole object in the workspace.
std::vector<double> frictions(const ObjectView& object, const ObjectSource& source, Legend& legend) {
  const ObjectMesh& mesh = object.finest();
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& place : mesh.place) box.extend(place);
  const double size_m = object.spacing_m() * std::max(1.0, static_cast<double>(box.sizes().maxCoeff()));
  const scene::FrictionLaw law(source.description, source.workspace_m / size_m, source.workspace_m);
  std::vector<double> values(mesh.place.size());
  for (std::size_t v = 0; v < values.size(); ++v) {
    const float bend = mesh.bend_per_m.empty() ? std::numeric_limits<float>::quiet_NaN() : mesh.bend_per_m[v];
    values[v] = static_cast<double>(law.at(object.place_m(v), static_cast<double>(bend)).mu_dynamic);
  }
  legend.unit = "\xC2\xB5";
  legend.high = std::max(source.description.config.friction->mu_max, 1e-6);
  return values;
}

bool is_own(const ObjectView& object, const ObjectSource& source, ColourMode mode) {
  switch (mode) {
    case ColourMode::height:
    case ColourMode::slope:
    case ColourMode::curvature:
    case ColourMode::sky_view:
      return true;
    case ColourMode::scan:
      return !object.finest().colour_rgba.empty() || !object.finest().intensity.empty();
    case ColourMode::texture:
      return !object.finest().texture_m.empty();
    case ColourMode::friction:
      return source.description.config.friction.has_value();
    default:
      return false;
  }
}

std::vector<double> values_of(const ObjectView& object, const ObjectSource& source, ColourMode mode, Legend& legend) {
  switch (mode) {
    case ColourMode::height:
      return heights(object, legend);
    case ColourMode::slope:
      return slopes(object, legend);
    case ColourMode::curvature:
      return curvatures(object, legend);
    case ColourMode::texture:
      return textures(object, legend);
    case ColourMode::friction:
      return frictions(object, source, legend);
    default:
      return sky_seen(object, legend);
  }
}

/// The colours of the front where the object is that front.
Paint front_colours(const ObjectView& object, const ObjectSource& source) {
  if (source.front_paint.rgba.empty()) return {};
  Paint paint;
  const std::size_t count = object.finest().place.size();
  paint.rgba.assign(4 * count, 0);
  paint.legend = source.front_paint.legend;
  paint.legend.title += " (front)";
  const double near_m = 1.5 * std::max(object.spacing_m(), source.front.lattice.spacing_m);
  for (std::size_t v = 0; v < count; ++v) {
    if (object.finest().normal[v].z() <= 0.0F) continue;
    const auto node = front_node(source.front, object.place_m(v), near_m);
    if (!node) continue;
    const auto from = source.front_paint.rgba.begin() + static_cast<std::ptrdiff_t>(4 * *node);
    std::copy(from, from + 4, paint.rgba.begin() + static_cast<std::ptrdiff_t>(4 * v));
  }
  return paint;
}

}  // namespace

Paint paint_object(const ObjectView& object, const ObjectSource& source, ColourMode mode) {
  if (mode == ColourMode::relief) return {};
  if (!is_own(object, source, mode)) return front_colours(object, source);
  if (mode == ColourMode::scan) return paint_as_scanned(object.finest().colour_rgba, object.finest().intensity);
  Paint paint;
  const std::size_t count = object.finest().place.size();
  paint.rgba.assign(4 * count, 0);
  Legend& legend = paint.legend;
  legend.title = name_of(mode);
  legend.scale = true;
  const std::vector<double> values = values_of(object, source, mode, legend);
  for (std::size_t v = 0; v < count; ++v) {
    if (!std::isfinite(values[v])) continue;
    const auto colour = colour_of(legend.map, (values[v] - legend.low) / (legend.high - legend.low));
    std::copy(colour.begin(), colour.end(), paint.rgba.begin() + static_cast<std::ptrdiff_t>(4 * v));
    paint.rgba[4 * v + 3] = 255;
  }
  return paint;
}

}  // namespace sparsha::viewer
