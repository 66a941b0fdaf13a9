// Scenes in memory.
#include "scene/scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "base/error.h"
#include "scene/area/regions.h"
#include "scene/ground/window_lattice.h"

namespace sparsha::scene {
namespace {

template <typename Value>
void copy_window(const std::vector<Value>& from, const Lattice& level, int i0, int j0, int nx, int ny, Value outside,
                 std::vector<Value>& to) {
  if (from.empty()) return;
  to.assign(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny), outside);
  const int i_begin = std::max(i0, 0);
  const int i_end = std::min(i0 + nx, level.nx);
  if (i_begin >= i_end) return;
  for (int j = std::max(j0, 0); j < std::min(j0 + ny, level.ny); ++j) {
    const auto source = from.begin() + static_cast<std::ptrdiff_t>(level.index(i_begin, j));
    const auto target = to.begin() + (static_cast<std::ptrdiff_t>(j - j0) * nx + (i_begin - i0));
    std::copy(source, source + (i_end - i_begin), target);
  }
}

class MemoryScene final : public Scene {
 public:
  MemoryScene(SceneDescription description, std::vector<Layers> levels)
      : description_(std::move(description)), levels_(std::move(levels)) {}

  [[nodiscard]] const SceneDescription& description() const override { return description_; }
  [[nodiscard]] std::filesystem::path folder() const override { return {}; }
  [[nodiscard]] const Layers* in_memory(int level) const override {
    return &levels_.at(static_cast<std::size_t>(level));
  }

  [[nodiscard]] Layers read(int level, int i0, int j0, int nx, int ny) const override {
    const Layers& from = levels_.at(static_cast<std::size_t>(level));
    const Lattice& lattice = from.grid.lattice;
    Layers to;
    to.grid.lattice = window_lattice(lattice, i0, j0, nx, ny);
    copy_window(from.grid.height_m, lattice, i0, j0, nx, ny, kUnknownHeight, to.grid.height_m);
    copy_window(from.grid.state, lattice, i0, j0, nx, ny, NodeState::unknown, to.grid.state);
    copy_window(from.envelope_m, lattice, i0, j0, nx, ny, kUnknownHeight, to.envelope_m);
    copy_window(from.curvature_per_m, lattice, i0, j0, nx, ny, 0.0F, to.curvature_per_m);
    copy_window(from.mean_curvature_per_m, lattice, i0, j0, nx, ny, 0.0F, to.mean_curvature_per_m);
    copy_window(from.gaussian_curvature_per_m2, lattice, i0, j0, nx, ny, 0.0F, to.gaussian_curvature_per_m2);
    copy_window(from.colour_rgba, lattice, i0, j0, nx, ny, std::uint32_t{0}, to.colour_rgba);
    copy_window(from.intensity, lattice, i0, j0, nx, ny, kUnknownHeight, to.intensity);
    return to;
  }

 private:
  SceneDescription description_;
  std::vector<Layers> levels_;
};

class DescribedScene final : public Scene {
 public:
  DescribedScene(ScenePointer scene, SceneDescription description)
      : scene_(std::move(scene)), description_(std::move(description)) {}

  [[nodiscard]] const SceneDescription& description() const override { return description_; }
  [[nodiscard]] std::filesystem::path folder() const override { return scene_->folder(); }
  [[nodiscard]] const Layers* in_memory(int level) const override { return scene_->in_memory(level); }
  [[nodiscard]] Layers read(int level, int i0, int j0, int nx, int ny) const override {
    return scene_->read(level, i0, j0, nx, ny);
  }
  [[nodiscard]] const ScenePointer& base() const { return scene_; }

 private:
  ScenePointer scene_;
  SceneDescription description_;
};

void set_height_range(const DepthGrid& grid, SceneDescription& description) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t n = 0; n < grid.height_m.size(); ++n) {
    if (grid.state[n] == NodeState::unknown) continue;
    low = std::min(low, static_cast<double>(grid.height_m[n]));
    high = std::max(high, static_cast<double>(grid.height_m[n]));
  }
  if (low > high) return;
  description.height_min_m = grid.lattice.origin_m.z() + low;
  description.height_max_m = grid.lattice.origin_m.z() + high;
}

bool same_lattice(const Lattice& a, const Lattice& b) {
  return a.nx == b.nx && a.ny == b.ny && a.spacing_m == b.spacing_m && a.origin_m == b.origin_m;
}

}  // namespace

ScenePointer with_description(ScenePointer scene, SceneDescription description) {
  if (!std::ranges::equal(scene->description().levels, description.levels, same_lattice))
    throw Error(ErrorKind::failure, {}, "the levels do not match the scene's description");
  // Edited many times, it is not wrapped many times.
  if (const auto* described = dynamic_cast<const DescribedScene*>(scene.get())) scene = described->base();
  make_areas(description);
  return std::make_shared<DescribedScene>(std::move(scene), std::move(description));
}

bool same_scans(const SceneDescription& a, const SceneDescription& b) {
  const auto names = [](const SceneDescription& scene) {
    std::vector<std::string> all;
    for (const ScanSource& source : scene.sources) all.push_back(source.sha256);
    std::ranges::sort(all);
    return all;
  };
  return !a.sources.empty() && names(a) == names(b);
}

bool same_ground(const SceneDescription& a, const SceneDescription& b) {
  return same_scans(a, b) && std::ranges::equal(a.levels, b.levels, same_lattice);
}

Layers Scene::read_level(int level) const {
  const Lattice& lattice = description().levels.at(static_cast<std::size_t>(level));
  return read(level, 0, 0, lattice.nx, lattice.ny);
}

ScenePointer make_scene(SceneDescription description, std::vector<Layers> levels) {
  bool matches = !levels.empty() && levels.size() == description.levels.size();
  for (std::size_t l = 0; matches && l < levels.size(); ++l) {
    const Lattice& promised = description.levels[l];
    const Layers& layers = levels[l];
    const auto fits = [&](bool promised_layer, std::size_t size) {
      return size == (promised_layer ? promised.count() : 0);
    };
    matches = layers.grid.lattice.nx == promised.nx && layers.grid.lattice.ny == promised.ny && promised.nx > 0 &&
              promised.ny > 0 && fits(true, layers.grid.height_m.size()) && fits(true, layers.grid.state.size()) &&
              fits(description.has_envelope, layers.envelope_m.size()) &&
              fits(description.has_curvature, layers.curvature_per_m.size()) &&
              fits(description.has_paper_curvatures, layers.mean_curvature_per_m.size()) &&
              fits(description.has_paper_curvatures, layers.gaussian_curvature_per_m2.size()) &&
              fits(description.has_colour, layers.colour_rgba.size()) &&
              fits(description.has_intensity, layers.intensity.size());
  }
  if (!matches) throw Error(ErrorKind::failure, {}, "the layers do not match the scene's description");
  if (description.height_min_m == 0.0 && description.height_max_m == 0.0)
    set_height_range(levels.front().grid, description);
  make_areas(description);
  return std::make_shared<MemoryScene>(std::move(description), std::move(levels));
}

}  // namespace sparsha::scene
