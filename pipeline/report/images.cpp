// Every picture is a field of one value per pixel, painted through a colour map; unknown pixels are hatched.
#include "pipeline/report/images.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>

#include "base/numbers/statistics.h"
#include "base/text/text.h"
#include "pipeline/report/filter_picture.h"
#include "pipeline/report/shading.h"
#include "pipeline/report/six_views.h"
#include "scene/frame/workspace.h"
#include "scene/material/friction_law.h"
#include "scene/scene.h"

namespace sparsha::pipeline {
namespace {

constexpr int kMaxSide = 1024;   // pixels
constexpr int kHatchPeriod = 8;  // pixels
constexpr double kMillimetres = 1000;
constexpr std::size_t kQuantileSample = 1U << 16;
constexpr double kSamplesPerSpot = 4;  // of the error map: samples that one spot should average

/// Means of a layer over the nodes of each pixel; value(n) is NaN where node n has none.
template <typename Value>
Field reduce(const scene::Lattice& lattice, const Value& value) {
  const int factor = nodes_per_pixel(lattice);
  Field field((lattice.nx + factor - 1) / factor, (lattice.ny + factor - 1) / factor);
  for (int row = 0; row < field.height; ++row) {
    // The top pixel row holds the last node rows.
    const int j1 = lattice.ny - row * factor, j0 = std::max(0, j1 - factor);
    for (int column = 0; column < field.width; ++column) {
      if (factor == 1) {
        field.at(column, row) = value(lattice.index(column, j0));
        continue;
      }
      double sum = 0;
      int count = 0;
      for (int j = j0; j < j1; ++j)
        for (int i = column * factor; i < std::min(lattice.nx, (column + 1) * factor); ++i) {
          const float v = value(lattice.index(i, j));
          if (std::isnan(v)) continue;
          sum += v;
          ++count;
        }
      if (count > 0) field.at(column, row) = static_cast<float>(sum / count);
    }
  }
  return field;
}

/// Means of the errors of the nodes of each pixel.
Field reduce(const scene::Lattice& lattice, const NodeErrors& errors) {
  const int factor = nodes_per_pixel(lattice);
  Field field((lattice.nx + factor - 1) / factor, (lattice.ny + factor - 1) / factor);
  std::vector<double> sum(field.values.size());
  std::vector<int> count(field.values.size());
  const auto nx = static_cast<std::uint64_t>(lattice.nx);
  for (std::size_t k = 0; k < errors.node.size(); ++k) {
    const int i = static_cast<int>(errors.node[k] % nx), j = static_cast<int>(errors.node[k] / nx);
    const int row = (lattice.ny - 1 - j) / factor;
    const auto pixel =
        static_cast<std::size_t>(row) * static_cast<std::size_t>(field.width) + static_cast<std::size_t>(i / factor);
    sum[pixel] += errors.error_m[k];
    ++count[pixel];
  }
  for (std::size_t n = 0; n < sum.size(); ++n)
    if (count[n] > 0) field.values[n] = static_cast<float>(sum[n] / count[n]);
  return field;
}

/// Value below which `fraction` of the known pixels lie, from a regular sample of them: it ends a legend, no more.
double quantile(const Field& field, double fraction) {
  std::vector<float> known;
  const std::size_t step = field.values.size() / kQuantileSample + 1;
  for (std::size_t n = 0; n < field.values.size(); n += step)
    if (!std::isnan(field.values[n])) known.push_back(field.values[n]);
  if (known.empty()) return 0;
  return static_cast<double>(sparsha::quantile(known, fraction));
}

std::uint8_t hatch(int column, int row) { return (column + row) % kHatchPeriod < kHatchPeriod / 2 ? 0 : 255; }

/// Pixels from values; `low` and `high` in the field's own unit.
void paint(Picture& picture, const Field& field, double low, double high) {
  picture.width = field.width;
  picture.height = field.height;
  picture.pixels.resize(field.values.size());
  const double scale = 253 / (high > low ? high - low : 1);
  std::size_t n = 0;
  for (int row = 0; row < field.height; ++row)
    for (int column = 0; column < field.width; ++column, ++n) {
      const double level = (field.values[n] - low) * scale;
      picture.pixels[n] = std::isnan(field.values[n]) ? hatch(column, row)
                                                      : static_cast<std::uint8_t>(1.5 + std::clamp(level, 0.0, 253.0));
    }
}

Picture relief(const Field& heights, double pixel_m) {
  Picture picture;
  picture.name = "relief";
  picture.title = "Shaded relief";
  picture.map = ColourMap::relief;
  picture.legend = Picture::Legend::none;
  const Shading shading = shade(heights, pixel_m);
  picture.caption = fmt::format(
      "The measured surface lit from the upper left, as under raking light; slopes are drawn {:.2g} times as steep as "
      "they "
      "are.",
      shading.exaggeration);
  picture.alternative = "The object's surface in raking light from the upper left.";
  paint(picture, shading.light, 0, 1);
  return picture;
}

Picture all_around(const scene::Charts& charts) {
  Picture picture;
  picture.name = "around";
  picture.title = "All around";
  picture.map = ColourMap::relief;
  picture.legend = Picture::Legend::none;
  picture.caption =
      "The whole object from its six sides. Above: from the left, from the front, from the right; below: from above, "
      "from behind, from below. Where the object has stripes, no scan saw it.";
  picture.alternative = "The whole object in six views: left, front, right, above, behind, below.";
  const SixViews views = six_views(charts);
  picture.width_m = views.width_m;
  paint(picture, views.light, 0, 1);
  return picture;
}

std::string direction_text(const Eigen::Vector3d& d) {
  return fmt::format("[{:.4g}, {:.4g}, {:.4g}]", d.x() + 0.0, d.y() + 0.0, d.z() + 0.0);
}

Picture sides(const Report& report) {
  constexpr int kColumns = 3;
  Picture picture;
  picture.name = "sides";
  picture.title = "Sides to choose from";
  picture.map = ColourMap::relief;
  picture.legend = Picture::Legend::none;
  picture.caption =
      "The points from six sides. This scene shows the front; another side is built with the line after its name.";
  std::string row;
  for (std::size_t k = 0; k < report.sides.size(); ++k) {
    const Report::Side& side = report.sides[k];
    row += fmt::format("{}{}", k % kColumns == 0 ? (k == 0 ? "Above: " : "; below: ") : ", ", side.name);
    picture.caption +=
        fmt::format(" {}: orientation: {{look_from: {}, up: {}}}{}", side.name, direction_text(side.look_from),
                    direction_text(side.up), k + 1 < report.sides.size() ? ";" : ".");
  }
  picture.alternative = fmt::format("The object from six sides. {}.", row);
  picture.caption += fmt::format(" {}.", row);
  const int width = report.sides.front().width;
  const int rows = (static_cast<int>(report.sides.size()) + kColumns - 1) / kColumns;
  Field light(kColumns * width, rows * width);
  for (std::size_t k = 0; k < report.sides.size(); ++k) {
    const int left = static_cast<int>(k) % kColumns * width;
    const int top = static_cast<int>(k) / kColumns * width;
    for (int y = 0; y < width; ++y) {
      for (int x = 0; x < width; ++x) {
        const std::uint8_t grey = report.sides[k].grey[static_cast<std::size_t>(y * width + x)];
        if (grey != Report::kNoSurface) light.at(left + x, top + y) = static_cast<float>(grey) / 255.0F;
      }
    }
  }
  picture.width_m = light.width * report.side_pixel_m;
  paint(picture, light, 0, 1);
  return picture;
}

Picture height(const Field& heights) {
  Picture picture;
  picture.name = "height";
  picture.title = "Height";
  picture.map = ColourMap::height;
  picture.unit = "mm";
  const double low = quantile(heights, 0.0005), high = quantile(heights, 0.9995);
  picture.high = (high - low) * kMillimetres;
  picture.clipped = true;
  picture.caption = "Distance towards the viewer, from dark blue (farthest) to light yellow (nearest).";
  picture.alternative = fmt::format("Height map of the object; heights span {:.3g} mm.", picture.high);
  paint(picture, heights, low, high);
  return picture;
}

Picture texture(const scene::Layers& base) {
  Picture picture;
  picture.name = "texture";
  picture.title = "Surface texture";
  picture.map = ColourMap::texture;
  picture.unit = "mm";
  const Field field =
      reduce(base.grid.lattice, [&](std::size_t n) { return base.grid.height_m[n] - base.envelope_m[n]; });
  Field magnitude = field;
  for (float& v : magnitude.values) v = std::abs(v);
  const double most = std::max(quantile(magnitude, 0.99), 1e-9);
  picture.low = -most * kMillimetres;
  picture.high = most * kMillimetres;
  picture.clipped = true;
  picture.caption = "What stands out from the smoothed form (brown) or lies below it (blue): tool marks, grain, wear.";
  picture.alternative =
      fmt::format("Map of the fine texture; 99 % of it lies within {:.2g} mm of the smoothed form.", picture.high);
  paint(picture, field, -most, most);
  return picture;
}

Picture friction(const scene::Layers& base, const scene::SceneDescription& scene) {
  Picture picture;
  picture.name = "friction";
  picture.title = "Friction";
  picture.map = ColourMap::friction;
  const scene::FrictionConfig& config = *scene.config.friction;
  const double scale = scene::level_scale(scene.config.levels.window, base.grid.lattice, scene::kDeskWorkspace_m);
  const scene::FrictionLaw law(scene, scale, scene::kDeskWorkspace_m);
  const Field field = reduce(base.grid.lattice, [&](std::size_t n) {
    return std::isnan(base.grid.height_m[n]) ? scene::kUnknownHeight : law.dynamic(base, n);
  });
  picture.high = config.mu_max;
  picture.caption =
      config.law == scene::FrictionConfig::Law::paper
          ? fmt::format(
                "Coefficient of sliding friction that the hand feels with a device whose "
                "workspace is {} wide, from pale (smooth) to dark (rough); under the paper's law "
                "other devices feel other coefficients.",
                length_text(scene::kDeskWorkspace_m, TextStyle::typeset))
          : std::string("Coefficient of sliding friction that the hand feels, from pale (smooth) to dark (rough).");
  picture.alternative =
      fmt::format("Map of the friction coefficient; its median is {:.2f}, its 95th percentile {:.2f}.",
                  quantile(field, 0.5), quantile(field, 0.95));
  paint(picture, field, 0, config.mu_max);
  return picture;
}

Picture coverage(const scene::DepthGrid& grid, const Report& report) {
  Picture picture;
  picture.name = "coverage";
  picture.title = "Coverage";
  picture.legend = Picture::Legend::states;
  picture.caption =
      "Where heights were measured, where small gaps were filled from their surroundings, and where nothing is known.";
  picture.alternative = fmt::format(
      "Map of coverage: {:.1f} % of the nodes are measured, {:.1f} % filled, {:.1f} % unknown.", 100 * report.coverage,
      100 * report.filled_fraction, 100 * (1 - report.coverage - report.filled_fraction));
  const Field field = reduce(grid.lattice, [&](std::size_t n) {
    if (grid.state[n] == scene::NodeState::unknown) return scene::kUnknownHeight;
    return grid.state[n] == scene::NodeState::measured ? 0.0F : 1.0F;
  });
  paint(picture, field, 0, 1);
  for (std::size_t k = 1; k < 255; ++k) picture.palette[k] = k < 128 ? kMeasuredColour : kFilledColour;
  picture.palette[0] = kHatchLight;
  picture.palette[255] = kHatchDark;
  return picture;
}

Picture error(const Field& heights, const scene::Lattice& lattice, const CheckResult& check) {
  Picture picture;
  picture.name = "error";
  picture.title = "Error";
  picture.map = ColourMap::error;
  picture.unit = "mm";
  Field field = reduce(lattice, check.node_errors);
  const auto sampled = static_cast<double>(
      std::count_if(field.values.begin(), field.values.end(), [](float v) { return !std::isnan(v); }));
  if (sampled > 0) {
    const double pixels = static_cast<double>(field.values.size());
    const int radius = static_cast<int>(std::ceil(std::sqrt(kSamplesPerSpot * pixels / sampled) / 2)) - 1;
    field = average_about(field, std::clamp(radius, 0, 64));
    for (std::size_t n = 0; n < field.values.size(); ++n)
      if (std::isnan(heights.values[n])) field.values[n] = scene::kUnknownHeight;
  }
  const double most = std::max(check.cloud_to_surface.p95_m, 1e-9);
  picture.high = most * kMillimetres;
  picture.clipped = true;
  picture.caption =
      fmt::format("Mean distance between {} and the surface about each place, from pale (small) to dark (large).",
                  words_of(check.against));
  picture.alternative = fmt::format(
      "Map of the distance between {0} and the surface; {1} within {2:.2g} mm, 95 % within {3:.2g} mm.",
      words_of(check.against), half_of(check.against), check.cloud_to_surface.median_m * kMillimetres, picture.high);
  paint(picture, field, 0, most);
  return picture;
}

}  // namespace

int nodes_per_pixel(const scene::Lattice& lattice) {
  return std::max(1, (std::max(lattice.nx, lattice.ny) + kMaxSide - 1) / kMaxSide);
}

std::vector<Picture> make_pictures(const scene::Layers& base, const scene::SceneDescription& scene,
                                   const Report& report, ThreadPool& pool) {
  const scene::Lattice& lattice = base.grid.lattice;
  const Field heights = reduce(lattice, [&](std::size_t n) { return base.grid.height_m[n]; });
  std::vector<std::function<Picture()>> makers;
  makers.emplace_back([&] { return relief(heights, nodes_per_pixel(lattice) * lattice.spacing_m); });
  if (scene.charts && scene.charts->measured_nodes() > 0)
    makers.emplace_back([&] { return all_around(*scene.charts); });
  if (!report.sides.empty()) makers.emplace_back([&] { return sides(report); });
  makers.emplace_back([&] { return height(heights); });
  if (!base.envelope_m.empty()) makers.emplace_back([&] { return texture(base); });
  if (scene.config.friction) makers.emplace_back([&] { return friction(base, scene); });
  makers.emplace_back([&] { return coverage(base.grid, report); });
  if (report.check && report.check->cloud_to_surface.samples > 0)
    makers.emplace_back([&] { return error(heights, lattice, *report.check); });
  if (has_filter_picture(report)) makers.emplace_back([&] { return filter_picture(scene, report); });
  std::vector<Picture> pictures(makers.size());
  pool.for_ranges(makers.size(), 1, [&](std::size_t k, std::size_t) {
    pictures[k] = makers[k]();
    const Picture::Legend legend = pictures[k].legend;
    if (legend != Picture::Legend::states && legend != Picture::Legend::entries)
      pictures[k].palette = palette_of(pictures[k].map);
  });
  return pictures;
}

}  // namespace sparsha::pipeline
