// Values of vertices through colour maps; colours of the front view by its nearest node.
#include "viewer/object/paint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "base/numbers/statistics.h"

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

}  // namespace

Paint paint_object(const ObjectView& object, const ReliefData& front, const Paint& front_paint, ColourMode mode) {
  if (mode == ColourMode::relief) return {};
  const std::size_t count = object.finest().place.size();
  Paint paint;
  paint.rgba.assign(4 * count, 0);
  if (mode != ColourMode::height && mode != ColourMode::curvature && mode != ColourMode::sky_view) {
    if (front_paint.rgba.empty()) return {};
    paint.legend = front_paint.legend;
    paint.legend.title += " (front)";
    const double near_m = 1.5 * std::max(object.spacing_m(), front.lattice.spacing_m);
    for (std::size_t v = 0; v < count; ++v) {
      if (object.finest().normal[v].z() <= 0.0F) continue;
      const auto node = front_node(front, object.place_m(v), near_m);
      if (!node) continue;
      const auto from = front_paint.rgba.begin() + static_cast<std::ptrdiff_t>(4 * *node);
      std::copy(from, from + 4, paint.rgba.begin() + static_cast<std::ptrdiff_t>(4 * v));
    }
    return paint;
  }
  Legend& legend = paint.legend;
  legend.title = name_of(mode);
  legend.scale = true;
  const std::vector<double> values = mode == ColourMode::height      ? heights(object, legend)
                                     : mode == ColourMode::curvature ? curvatures(object, legend)
                                                                     : sky_seen(object, legend);
  for (std::size_t v = 0; v < count; ++v) {
    const auto colour = colour_of(legend.map, (values[v] - legend.low) / (legend.high - legend.low));
    std::copy(colour.begin(), colour.end(), paint.rgba.begin() + static_cast<std::ptrdiff_t>(4 * v));
    paint.rgba[4 * v + 3] = 255;
  }
  return paint;
}

}  // namespace sparsha::viewer
