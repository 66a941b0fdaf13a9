// Values of vertices through colour maps; colours of the front view by its nearest node.
#include "viewer/object/paint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include "base/numbers/statistics.h"
#include "scene/material/friction_law.h"
#include "scene/scene.h"
#include "scene/solid/envelope.h"
#include "scene/solid/surface_nodes.h"

namespace sparsha::viewer {
namespace {

/// Size of the values that all but 2 % have, from about 16000 samples.
double usual(const std::vector<double>& values) {
  std::vector<double> some;
  const std::size_t stride = std::max<std::size_t>(1, values.size() / 16384);
  for (std::size_t k = 0; k < values.size(); k += stride) some.push_back(std::abs(values[k]));
  return quantile(some, 0.98);
}

/// Of the object's box, spacings.
double longest_side(const ObjectMesh& mesh) {
  Eigen::AlignedBox3f box;
  for (const Eigen::Vector3f& place : mesh.place) box.extend(place);
  return std::max(1.0, static_cast<double>(box.sizes().maxCoeff()));
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

/// Millimetres of metres, and the size that all but 2 % of the known ones have.
std::vector<double> in_mm(const std::vector<float>& values_m, double& high) {
  std::vector<double> values(values_m.begin(), values_m.end()), known;
  for (double& value : values) value *= 1e3;
  std::ranges::copy_if(values, std::back_inserter(known), [](double value) { return std::isfinite(value); });
  high = std::max(known.empty() ? 0.0 : usual(known), 1e-6);
  return values;
}

std::vector<double> textures(const ObjectView& object, Legend& legend) {
  std::vector<double> values = in_mm(object.finest().texture_m, legend.high);
  legend.unit = "mm";
  legend.map = ColourMap::diverging;
  legend.low = -legend.high;
  return values;
}

std::vector<double> errors(const ObjectView& object, Legend& legend) {
  std::vector<double> values = in_mm(object.finest().error_m, legend.high);
  legend.unit = "mm";
  return values;
}

/// How far the surface lies before its form: the mean of what is about a place, along its normal. As wide as that of a
/// front view: two means over a fortieth of the object to either side.
std::vector<double> local_relief(const ObjectView& object, const scene::Charts& charts, Legend& legend) {
  constexpr double kSigma = 0.816 / 40.0;
  const ObjectMesh& mesh = object.finest();
  const double sigma_m = kSigma * charts.spacing_m * longest_side(mesh);
  const scene::Envelope form(sigma_m, std::numeric_limits<double>::infinity());
  const double reach_m = std::max(scene::Envelope::reach_m(sigma_m), charts.spacing_m);
  const scene::SurfaceNodes nodes(charts, reach_m, scene::SurfaceNodes::stride_within(reach_m, charts.spacing_m),
                                  [](const scene::Sheet&, std::size_t) { return 0.0; });
  const auto place_m = [&](std::size_t v) { return Eigen::Vector3d(charts.spacing_m * mesh.place[v].cast<double>()); };
  std::vector<std::pair<std::uint64_t, std::size_t>> order(mesh.place.size());
  for (std::size_t v = 0; v < order.size(); ++v) order[v] = {scene::SurfaceNodes::key_of(nodes.cube_of(place_m(v))), v};
  std::sort(order.begin(), order.end());
  std::vector<double> values(mesh.place.size());
  std::vector<scene::SurfaceNode> about;
  for (std::size_t k = 0; k < order.size(); ++k) {
    const std::size_t v = order[k].second;
    if (k == 0 || order[k].first != order[k - 1].first) nodes.near(nodes.cube_of(place_m(v)), about);
    values[v] = 1e3 * form(place_m(v), mesh.normal[v].cast<double>(), about);
  }
  legend.unit = "mm";
  legend.map = ColourMap::diverging;
  std::vector<double> sizes = values;
  for (double& size : sizes) size = std::abs(size);
  legend.high = std::max(4.0 * median(sizes), 1e-6);
  legend.low = -legend.high;
  return values;
}

Paint coverage(const ObjectView& object) {
  const std::vector<bool>& measured = object.finest().measured;
  Paint paint;
  for (const bool is_measured : measured) {
    const auto& colour = is_measured ? kMeasuredColour : kFilledColour;
    paint.rgba.insert(paint.rgba.end(), {colour[0], colour[1], colour[2], 255});
  }
  const auto count = static_cast<std::size_t>(std::count(measured.begin(), measured.end(), true));
  paint.legend.title = name_of(ColourMode::coverage);
  paint.legend.swatches = {coverage_swatch("measured", count, measured.size(), kMeasuredColour),
                           coverage_swatch("continued", measured.size() - count, measured.size(), kFilledColour)};
  return paint;
}

/// As a hand feels it that has the whole object in the workspace.
std::vector<double> frictions(const ObjectView& object, const ObjectSource& source, Legend& legend) {
  const ObjectMesh& mesh = object.finest();
  const double size_m = object.spacing_m() * longest_side(mesh);
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
    case ColourMode::coverage:
    case ColourMode::sky_view:
      return true;
    case ColourMode::local_relief:
      return source.description.charts != nullptr;
    case ColourMode::scan:
      return !object.finest().colour_rgba.empty() || !object.finest().intensity.empty();
    case ColourMode::texture:
      return !object.finest().texture_m.empty();
    case ColourMode::error:
      return !object.finest().error_m.empty();
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
    case ColourMode::local_relief:
      return local_relief(object, *source.description.charts, legend);
    case ColourMode::texture:
      return textures(object, legend);
    case ColourMode::error:
      return errors(object, legend);
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
  if (mode == ColourMode::coverage) return coverage(object);
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
