// Colour modes. A value of each node goes through a colour map; scan colours are taken as they are.
#include "viewer/surface/paint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "base/numbers/statistics.h"
#include "scene/frame/workspace.h"
#include "scene/material/friction_law.h"
#include "scene/scene.h"
#include "viewer/surface/layer_blur.h"

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

Paint coverage(const ReliefData& relief) {
  Paint paint;
  const std::size_t count = relief.lattice.count();
  paint.rgba.assign(4 * count, 255);
  std::size_t measured = 0, filled = 0;
  for (std::size_t k = 0; k < count; ++k) {
    const scene::NodeState state = relief.layers.grid.state[k];
    const bool is_filled = state == scene::NodeState::filled;
    filled += is_filled ? 1 : 0;
    measured += state != scene::NodeState::unknown && !is_filled ? 1 : 0;
    const auto& colour = is_filled ? kFilledColour : kMeasuredColour;
    std::copy(colour.begin(), colour.end(), paint.rgba.begin() + static_cast<std::ptrdiff_t>(4 * k));
  }
  paint.legend.title = name_of(ColourMode::coverage);
  paint.legend.swatches = {coverage_swatch("measured", measured, count, kMeasuredColour),
                           coverage_swatch("filled", filled, count, kFilledColour)};
  return paint;
}

/// What the maps are computed from.
struct Source {
  const ReliefData& relief;
  const scene::SceneDescription& description;
  double workspace_m;
};

/// `value(k)` of every known node.
template <class Value>
std::vector<double> each(const ReliefData& relief, const Value& value) {
  std::vector<double> values(relief.lattice.count(), kNone);
  for (std::size_t k = 0; k < values.size(); ++k)
    if (relief.known[k] != 0) values[k] = value(k);
  return values;
}

/// Below, at and above zero, of the same size.
void set_about_zero(Legend& own, double high) {
  own.map = ColourMap::diverging;
  own.high = std::max(high, 1e-6);
  own.low = -own.high;
}

// What each map shows of the nodes; `own` gets unit and range, within which all but 2 % lie.

std::vector<double> heights(const Source& source, Legend& own) {
  const auto& [relief, description, workspace_m] = source;
  own.unit = "mm";
  const bool whole = description.height_max_m > description.height_min_m;
  const double bottom_m = whole ? description.height_min_m : relief.height_min_m;
  const double top_m = whole ? description.height_max_m : relief.height_max_m;
  own.high = std::max(1e3 * (top_m - bottom_m), 1e-6);
  const double shift_m = relief.lattice.origin_m.z() - bottom_m;
  const std::vector<float>& height_m = relief.height_m;
  return each(relief, [&](std::size_t k) { return 1e3 * (height_m[k] + shift_m); });
}

std::vector<double> slopes(const Source& source, Legend& own) {
  const ReliefData& relief = source.relief;
  own.unit = "\xC2\xB0";
  std::vector<double> values = each(relief, [&](std::size_t k) {
    const double slope = std::hypot(relief.slope[2 * k], relief.slope[2 * k + 1]);
    return std::atan(slope) * 180.0 / std::numbers::pi;
  });
  own.high = std::clamp(typical(values, 0.98), 1.0, 90.0);
  return values;
}

/// Half the Laplacian of heights freed of noise, on each node's own surface; ridges positive.
std::vector<double> curvatures(const Source& source, Legend& own) {
  const ReliefData& relief = source.relief;
  own.unit = "1/m";
  const double spacing_m = relief.lattice.spacing_m;
  std::vector<double> values = laplacian_on_layers(relief, 2);
  for (double& value : values) value *= -0.5 / (spacing_m * spacing_m);
  set_about_zero(own, typical(values, 0.98));
  return values;
}

std::vector<double> local_relief(const Source& source, Legend& own) {
  const ReliefData& relief = source.relief;
  own.unit = "mm";
  constexpr int kPieces = 40;  // of the longer side: what is wider is form, not inscription
  const int longer = std::max(relief.lattice.nx, relief.lattice.ny);
  const std::vector<float> form = blur_on_layers(relief, std::max(2, longer / kPieces));
  std::vector<double> values =
      each(relief, [&](std::size_t k) { return 1e3 * (static_cast<double>(relief.height_m[k]) - form[k]); });
  // Rims and steps stand out by far more than any inscription: the middle half tells the range.
  set_about_zero(own, 4.0 * typical(values, 0.5));
  return values;
}

/// One pit that sees nothing of the sky must not make all else look alike.
std::vector<double> sky_seen(const Source& source, Legend& own) {
  own.unit = "%";
  std::vector<double> values =
      each(source.relief, [&](std::size_t k) { return 100.0 * source.relief.tone[4 * k] / 255.0; });
  own.high = 100.0;
  own.low = std::min(100.0 * (1.0 - 1.0 / 256.0), typical(values, 0.02));
  return values;
}

std::vector<double> errors(const Source& source, Legend& own) {
  own.unit = "mm";
  const scene::CheckMap& map = *source.description.check_map;
  own.high = std::max(1e3 * map.high_m, 1e-6);
  const scene::Lattice& lattice = source.relief.lattice;
  const auto columns = static_cast<std::size_t>(lattice.nx);
  return each(source.relief, [&](std::size_t k) {
    const int i = static_cast<int>(k % columns), j = static_cast<int>(k / columns);
    return 1e3 * static_cast<double>(map.at(lattice.x_m(i), lattice.y_m(j)));
  });
}

/// As the hand meets it in level 0's window.
std::vector<double> friction(const Source& source, Legend& own) {
  const auto& [relief, description, workspace_m] = source;
  own.unit = "\xC2\xB5";
  own.high = std::max(description.config.friction->mu_max, 1e-6);
  const double scale = level_scale(description.config.levels.window, description.levels.front(), workspace_m);
  const scene::FrictionLaw law(description, scale, workspace_m);
  const scene::Layers& layers = relief.layers;
  return each(relief, [&](std::size_t k) { return static_cast<double>(law.dynamic(layers, k)); });
}

std::vector<double> texture(const Source& source, Legend& own) {
  const scene::Layers& layers = source.relief.layers;
  own.unit = "mm";
  std::vector<double> values = each(source.relief, [&](std::size_t k) {
    return 1e3 * (static_cast<double>(layers.grid.height_m[k]) - layers.envelope_m[k]);
  });
  set_about_zero(own, typical(values, 0.98));
  return values;
}

std::vector<double> values_of(const Source& source, ColourMode mode, Legend& own) {
  switch (mode) {
    case ColourMode::height:
      return heights(source, own);
    case ColourMode::slope:
      return slopes(source, own);
    case ColourMode::curvature:
      return curvatures(source, own);
    case ColourMode::local_relief:
      return local_relief(source, own);
    case ColourMode::sky_view:
      return sky_seen(source, own);
    case ColourMode::error:
      return errors(source, own);
    case ColourMode::friction:
      return friction(source, own);
    default:
      return texture(source, own);
  }
}

constexpr std::array kTitles{"Stone",
                             "Height",
                             "Scan",
                             "Friction",
                             "Texture",
                             "Slope",
                             "Curvature",
                             "Coverage",
                             "Local relief",
                             "Sky seen",
                             "Distance to the scan"};
static_assert(kTitles.size() == scene::ViewerConfig::kColourNames.size());

}  // namespace

bool has_mode(const scene::SceneDescription& description, ColourMode mode) {
  switch (mode) {
    case ColourMode::scan:
      return description.has_colour || description.has_intensity;
    case ColourMode::friction:
      return description.config.friction.has_value();
    case ColourMode::texture:
      return description.has_envelope;
    case ColourMode::error:
      return description.check_map != nullptr;
    default:
      return true;
  }
}

Legend::Swatch coverage_swatch(const char* name, std::size_t count, std::size_t of,
                               const std::array<std::uint8_t, 3>& colour) {
  const double share = static_cast<double>(count) / static_cast<double>(std::max<std::size_t>(of, 1));
  return {fmt::format("{} {:.1f} %", name, 100.0 * share), colour};
}

Paint paint_as_scanned(const std::vector<std::uint32_t>& colour_rgba, const std::vector<float>& intensity) {
  Paint paint;
  const std::size_t count = std::max(colour_rgba.size(), intensity.size());
  paint.rgba.assign(4 * count, 0);
  if (!colour_rgba.empty()) {
    paint.legend.title = "Colour as scanned";
    for (std::size_t k = 0; k < count; ++k) {
      const std::uint32_t rgba = colour_rgba[k];
      for (unsigned c = 0; c < 3; ++c) paint.rgba[4 * k + c] = static_cast<std::uint8_t>(rgba >> (8 * c));
      paint.rgba[4 * k + 3] = rgba == 0 ? 0 : 255;
    }
    return paint;
  }
  paint.legend.title = "Intensity as scanned";
  const std::vector<double> values(intensity.begin(), intensity.end());
  const double low = typical(values, 0.01), high = std::max(typical(values, 0.99), low + 1e-12);
  for (std::size_t k = 0; k < count; ++k) {
    if (!std::isfinite(values[k])) continue;
    const double share = std::clamp((values[k] - low) / (high - low), 0.0, 1.0);
    for (std::size_t c = 0; c < 3; ++c) paint.rgba[4 * k + c] = static_cast<std::uint8_t>(40.0 + 215.0 * share);
    paint.rgba[4 * k + 3] = 255;
  }
  return paint;
}

const char* name_of(ColourMode mode) { return kTitles[static_cast<std::size_t>(mode)]; }

ColourMode next_mode(const scene::SceneDescription& description, ColourMode mode, int step) {
  constexpr int kCount = static_cast<int>(kTitles.size());
  for (int tries = 1; tries <= kCount; ++tries) {
    const auto next = static_cast<ColourMode>((static_cast<int>(mode) + step * tries + kCount * kCount) % kCount);
    if (has_mode(description, next)) return next;
  }
  return ColourMode::relief;
}

Paint paint_relief(const ReliefData& relief, const scene::SceneDescription& description, ColourMode mode,
                   double workspace_m, const Legend* legend) {
  if (mode == ColourMode::relief || !has_mode(description, mode)) return {};
  if (mode == ColourMode::scan) return paint_as_scanned(relief.layers.colour_rgba, relief.layers.intensity);
  if (mode == ColourMode::coverage) return coverage(relief);

  const std::size_t count = relief.lattice.count();
  Paint paint;
  Legend& own = paint.legend;
  own.title = name_of(mode);
  own.scale = true;
  const std::vector<double> values = values_of({relief, description, workspace_m}, mode, own);
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
