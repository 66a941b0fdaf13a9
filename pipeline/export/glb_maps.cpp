#include "pipeline/export/glb_maps.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <utility>

#include "base/png/png.h"
#include "scene/area/region_frame.h"
#include "scene/area/regions.h"
#include "scene/frame/workspace.h"
#include "scene/material/friction_law.h"
#include "scene/scene.h"

namespace sparsha::pipeline {
namespace {

using Value = std::function<double(const scene::Layers&, std::size_t node)>;

/// Calls use(layers, rows) for bands of level 0 from the top down.
template <typename Use>
void for_each_band(const scene::Scene& scene, Progress& progress, const Use& use) {
  constexpr int kRows = 256;
  const scene::Lattice& lattice = scene.description().levels.at(0);
  for (int end = lattice.ny; end > 0;) {
    const int rows = std::min(kRows, end);
    progress.at(1.0 - static_cast<double>(end) / lattice.ny);
    use(scene.read(0, 0, end - rows, lattice.nx, rows), rows);
    end -= rows;
  }
}

HapticMap draw(const scene::Scene& scene, HapticMap map, const Value& value, Progress& progress) {
  const scene::Lattice& lattice = scene.description().levels.at(0);
  PngFormat format;
  format.width = lattice.nx;
  format.height = lattice.ny;
  format.pixel = PngFormat::Pixel::rgb8;
  PngWriter writer(format, [&](std::span<const std::byte> bytes) {
    map.png.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  });
  const auto nx = static_cast<std::size_t>(lattice.nx);
  std::vector<std::uint8_t> row(3 * nx);
  for_each_band(scene, progress, [&](const scene::Layers& layers, int rows) {
    for (int j = rows - 1; j >= 0; --j) {
      for (std::size_t i = 0; i < nx; ++i) {
        const double share = (value(layers, static_cast<std::size_t>(j) * nx + i) - map.least) / (map.most - map.least);
        const auto grey = static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(share, 0.0, 1.0)));
        std::fill_n(row.begin() + static_cast<std::ptrdiff_t>(3 * i), 3, grey);
      }
      writer.write_row(row);
    }
  });
  writer.finish();
  return map;
}

/// Of the scene, and of its parts that have one of their own, as friction is laid over them.
class Stiffness {
 public:
  explicit Stiffness(const scene::SceneDescription& description) : scene_(description) {
    most_ = description.config.haptics.stiffness_n_per_m;
    for (std::size_t k = 0; k < description.config.parts.size(); ++k) {
      const std::optional<double>& own = description.config.parts[k].touch.stiffness_n_per_m;
      if (!own) continue;
      parts_.emplace_back(scene::area_of(description, k), *own);
      most_ = std::max(most_, *own);
    }
  }
  [[nodiscard]] double most() const { return most_; }
  [[nodiscard]] double at(const scene::Layers& layers, std::size_t node) const {
    double stiffness = scene_.config.haptics.stiffness_n_per_m;
    if (parts_.empty()) return stiffness;
    const scene::Lattice& lattice = layers.grid.lattice;
    const auto nx = static_cast<std::size_t>(lattice.nx);
    const double height_m = static_cast<double>(layers.grid.height_m[node]);
    Eigen::Vector4d place(lattice.x_m(static_cast<int>(node % nx)), lattice.y_m(static_cast<int>(node / nx)),
                          lattice.origin_m.z() + (std::isfinite(height_m) ? height_m : 0.0), 1.0);
    if (scene_.region_from_grid) place = *scene_.region_from_grid * place;
    for (auto part = parts_.rbegin(); part != parts_.rend(); ++part)
      stiffness +=
          (part->second - stiffness) * part->first.share_inside(Eigen::Vector3d(place.head<3>()), scene::kBorder_m);
    return stiffness;
  }

 private:
  const scene::SceneDescription& scene_;
  double most_ = 0.0;
  std::vector<std::pair<scene::Area, double>> parts_;
};

double greatest(const scene::Scene& scene, const Value& value, Progress& progress) {
  double most = 0.0;
  for_each_band(scene, progress, [&](const scene::Layers& layers, int) {
    for (std::size_t k = 0; k < layers.grid.height_m.size(); ++k) most = std::max(most, std::abs(value(layers, k)));
  });
  return most > 0.0 ? most : 1.0;
}

}  // namespace

std::vector<HapticMap> haptic_maps(const scene::Scene& scene, Progress& progress) {
  const scene::SceneDescription& description = scene.description();
  std::vector<HapticMap> maps;
  const Stiffness stiffness(description);
  maps.push_back(draw(
      scene, {"stiffness", "stiffness", "N/m", 0.0, stiffness.most(), {}},
      [&](const scene::Layers& layers, std::size_t k) { return stiffness.at(layers, k); }, progress));
  if (description.config.friction) {
    const scene::FrictionLaw law(description, 1.0, scene::kDeskWorkspace_m);
    const Value dynamic = [&](const scene::Layers& layers, std::size_t k) {
      return static_cast<double>(law.dynamic(layers, k));
    };
    const Value at_rest = [&](const scene::Layers& layers, std::size_t k) {
      return static_cast<double>(law.at_rest(layers, k, law.dynamic(layers, k)));
    };
    const double most = greatest(scene, at_rest, progress);
    maps.push_back(draw(scene, {"friction", "dynamic", "1", 0.0, most, {}}, dynamic, progress));
    maps.push_back(draw(scene, {"friction", "static", "1", 0.0, most, {}}, at_rest, progress));
  }
  if (description.has_envelope) {
    const Value relief = [](const scene::Layers& layers, std::size_t k) {
      const double over = static_cast<double>(layers.grid.height_m[k]) - static_cast<double>(layers.envelope_m[k]);
      return std::isfinite(over) ? over : 0.0;
    };
    const double most = greatest(scene, relief, progress);
    maps.push_back(
        draw(scene, {"vibrotactileTexture", "height over the envelope", "m", -most, most, {}}, relief, progress));
  }
  return maps;
}

}  // namespace sparsha::pipeline
