// Colour modes. A value of each node goes through a colour map; scan colours are taken as they are.
#include "viewer/surface/paint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "base/statistics.h"
#include "scene/friction_law.h"
#include "scene/workspace.h"

namespace sparsha::viewer {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
/// The share-th quantile of finite magnitudes, from about 16000 samples.
double typical(const std::vector<double>& values, double share) {
  std::vector<double> some;
  const std::size_t stride = std::max<std::size_t>(1, values.size() / 16384);
  for (std::size_t k = 0; k < values.size(); k += stride)
    if (std::isfinite(values[k])) some.push_back(std::abs(values[k]));
  return some.empty() ? 0.0 : quantile(some, share);
}

Paint scan_colours(const ReliefData& relief) {
  Paint paint;
  const std::size_t count = relief.lattice.count();
  paint.rgba.assign(4 * count, 0);
  if (!relief.layers.colour_rgba.empty()) {
    paint.legend.title = "Colour as scanned";
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t rgba = relief.layers.colour_rgba[k];
      for (unsigned c = 0; c < 3; ++c) paint.rgba[4 * k + c] = static_cast<std::uint8_t>(rgba >> (8 * c));
      paint.rgba[4 * k + 3] = rgba == 0 ? 0 : 255;
    }
    return paint;
  }
  paint.legend.title = "Intensity as scanned";
  std::vector<double> values(relief.layers.intensity.begin(), relief.layers.intensity.end());
  const double low = typical(values, 0.01), high = std::max(typical(values, 0.99), low + 1e-12);
  for (std::size_t k = 0; k < count; ++k) {
    if (!std::isfinite(values[k])) continue;
    const double share = std::clamp((values[k] - low) / (high - low), 0.0, 1.0);
    for (std::size_t c = 0; c < 3; ++c) paint.rgba[4 * k + c] = static_cast<std::uint8_t>(40.0 + 215.0 * share);
    paint.rgba[4 * k + 3] = 255;
  }
  return paint;
}

}  // namespace

bool has_mode(const pipeline::SceneDescription& description, ColourMode mode) {
  switch (mode) {
    case ColourMode::relief:
    case ColourMode::height:
      return true;
    case ColourMode::scan:
      return description.has_colour || description.has_intensity;
    case ColourMode::friction:
      return description.config.friction.has_value();
    case ColourMode::texture:
      return description.has_envelope;
  }
  return false;
}

const char* name_of(ColourMode mode) {
  switch (mode) {
    case ColourMode::relief:
      return "Stone";
    case ColourMode::height:
      return "Height";
    case ColourMode::scan:
      return "Scan";
    case ColourMode::friction:
      return "Friction";
    case ColourMode::texture:
      return "Texture";
  }
  return "";
}

ColourMode next_mode(const pipeline::SceneDescription& description, ColourMode mode) {
  constexpr std::array kOrder{ColourMode::relief, ColourMode::height, ColourMode::scan, ColourMode::friction,
                              ColourMode::texture};
  const auto at = static_cast<std::size_t>(std::ranges::find(kOrder, mode) - kOrder.begin());
  for (std::size_t step = 1; step <= kOrder.size(); ++step) {
    const ColourMode next = kOrder[(at + step) % kOrder.size()];
    if (has_mode(description, next)) return next;
  }
  return ColourMode::relief;
}

Paint paint_relief(const ReliefData& relief, const pipeline::SceneDescription& description, ColourMode mode,
                   const Legend* legend) {
  if (mode == ColourMode::relief || !has_mode(description, mode)) return {};
  if (mode == ColourMode::scan) return scan_colours(relief);

  const std::size_t count = relief.lattice.count();
  std::vector<double> values(count, kNone);
  Paint paint;
  Legend& own = paint.legend;
  own.title = name_of(mode);
  own.scale = true;
  if (mode == ColourMode::height) {
    own.unit = "mm";
    const bool whole = description.height_max_m > description.height_min_m;
    const double bottom_m = whole ? description.height_min_m : relief.height_min_m;
    const double top_m = whole ? description.height_max_m : relief.height_max_m;
    for (std::size_t k = 0; k < count; ++k)
      values[k] = 1e3 * (relief.height_m[k] + relief.lattice.origin_m.z() - bottom_m);
    own.high = std::max(1e3 * (top_m - bottom_m), 1e-6);
  } else if (mode == ColourMode::friction) {
    own.unit = "\xC2\xB5";
    own.high = std::max(description.config.friction->mu_max, 1e-6);
    // As the hand meets it in level 0's window.
    const double scale =
        level_scale(description.config.levels.window, description.levels.front(), pipeline::kDeskWorkspaceM);
    const pipeline::FrictionLaw law(description, scale, pipeline::kDeskWorkspaceM);
    for (std::size_t k = 0; k < count; ++k) values[k] = static_cast<double>(law.dynamic(relief.layers, k));
  } else {
    own.unit = "mm";
    own.map = ColourMap::diverging;
    for (std::size_t k = 0; k < count; ++k)
      values[k] = 1e3 * (static_cast<double>(relief.layers.grid.height_m[k]) - relief.layers.envelope_m[k]);
    own.high = std::max(typical(values, 0.98), 1e-6);
    own.low = -own.high;
  }
  if (legend != nullptr) own = *legend;

  constexpr std::size_t kSteps = 1024;
  std::array<std::array<std::uint8_t, 3>, kSteps> table{};
  for (std::size_t s = 0; s < kSteps; ++s) table[s] = colour_of(own.map, static_cast<double>(s) / (kSteps - 1));
  const std::array<std::uint8_t, 3> none = colour_of(own.map, kNone);
  paint.rgba.resize(4 * count);
  for (std::size_t k = 0; k < count; ++k) {
    const double t = (values[k] - own.low) / (own.high - own.low);
    const auto& colour =
        std::isfinite(t) ? table[static_cast<std::size_t>(std::clamp(t, 0.0, 1.0) * (kSteps - 1))] : none;
    std::copy(colour.begin(), colour.end(), paint.rgba.begin() + static_cast<std::ptrdiff_t>(4 * k));
    paint.rgba[4 * k + 3] = 255;
  }
  return paint;
}

}  // namespace sparsha::viewer
