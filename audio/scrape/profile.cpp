// Interpolates the nodes of a level to heights along a path.
#include "audio/scrape/profile.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/LU>

#include "audio/scrape/catmull_rom.h"
#include "audio/scrape/object_profile.h"
#include "scene/material/measured_spectrum.h"
#include "scene/scene.h"

namespace sparsha::audio {
namespace {

/// Waves per sample at which a band of the grain begins to fade, and from which it is gone.
constexpr double kWhole = 0.3;
constexpr double kGone = 0.4;
constexpr int kWidest = 1 << 14;  ///< nodes per side of a window

}  // namespace

ViewProfile::Window ViewProfile::window_of(const scene::SceneDescription& scene, const haptics::State& state) {
  const auto last = static_cast<std::uint64_t>(scene.levels.size()) - 1;
  Window window;
  window.level = static_cast<int>(std::min(state.level, last));
  const auto node = [](std::int64_t value) {
    return static_cast<int>(std::clamp<std::int64_t>(value, -1 << 28, 1 << 28));
  };
  window.i0 = node(state.window[0]);
  window.j0 = node(state.window[1]);
  window.nx = std::clamp(node(state.window[2]), 0, kWidest);
  window.ny = std::clamp(node(state.window[3]), 0, kWidest);
  window.scale = state.scale;
  window.texture = (state.flags & haptics::kFlagTexture) != 0;
  window.beyond = scene::beyond_of((state.flags & haptics::kFlagFalls) != 0, (state.flags & haptics::kFlagRim) != 0);
  while (window.level > 0 && 2 * std::max(window.nx, window.ny) <= kMostNodes) {
    --window.level;
    window.i0 *= 2;
    window.j0 *= 2;
    window.nx = 2 * window.nx - 1;
    window.ny = 2 * window.ny - 1;
  }
  return window;
}

ViewProfile::ViewProfile(const scene::Scene& scene, const Window& window,
                         std::shared_ptr<const scene::GrainField> grain)
    : grain_(scene.description(), std::move(grain)) {
  scene::TouchedHeights touched = scene::read_touched(scene, window);
  lattice_ = touched.lattice;
  margin_ = touched.margin;
  origin_m_ = lattice_.origin_m + margin_ * lattice_.spacing_m * Eigen::Vector3d(1.0, 1.0, 0.0);
  height_m_ = std::move(touched.height_m);
}

double ViewProfile::height_m(std::size_t /*sheet*/, const Eigen::Vector3d& place_m) const noexcept {
  const double x = place_m.x() / lattice_.spacing_m;
  const double y = place_m.y() / lattice_.spacing_m;
  if (!std::isfinite(x) || !std::isfinite(y)) return 0.0;
  const double across = margin_ + std::clamp(x, 0.0, lattice_.nx - 1.0 - 2.0 * margin_);
  const double along = margin_ + std::clamp(y, 0.0, lattice_.ny - 1.0 - 2.0 * margin_);
  const int i = static_cast<int>(across);
  const int j = static_cast<int>(along);
  const auto in_x = catmull_rom(across - i);
  const auto in_y = catmull_rom(along - j);
  double height = 0.0;
  for (int b = 0; b < 4; ++b) {
    const int row = std::clamp(j + b - 1, 0, lattice_.ny - 1);
    double sum = 0.0;
    for (int a = 0; a < 4; ++a)
      sum += in_x[static_cast<std::size_t>(a)] *
             static_cast<double>(height_m_[lattice_.index(std::clamp(i + a - 1, 0, lattice_.nx - 1), row)]);
    height += in_y[static_cast<std::size_t>(b)] * sum;
  }
  return height;
}

double ViewProfile::grain_m(std::size_t sheet, const Eigen::Vector3d& place_m, double per_sample_m,
                            double shortest_m) const noexcept {
  const Eigen::Vector3d on_stone_m(place_m.x(), place_m.y(), height_m(sheet, place_m));
  return grain_.height_m(origin_m_ + on_stone_m, nullptr, per_sample_m, shortest_m);
}

ProfileGrain::ProfileGrain(const scene::SceneDescription& scene, std::shared_ptr<const scene::GrainField> field)
    : field_(std::move(field)) {
  if (const auto& matrix = scene.region_from_grid) {
    region_from_grid_ = matrix->topRows<3>();
    enlarged_ = std::cbrt(std::abs(matrix->topLeftCorner<3, 3>().determinant()));
  }
}

double ProfileGrain::height_m(const Eigen::Vector3d& grid_m, const Eigen::Vector3d* normal, double per_sample_m,
                              double shortest_m) const noexcept {
  if (!field_ || field_->silent()) return 0.0;
  Eigen::Vector3d place_m = grid_m;
  Eigen::Vector3d shares = Eigen::Vector3d::UnitZ();
  if (region_from_grid_) place_m = region_from_grid_->leftCols<3>() * grid_m + region_from_grid_->col(3);
  if (normal != nullptr)
    shares = scene::GrainField::shares(region_from_grid_ ? Eigen::Vector3d(region_from_grid_->leftCols<3>() * *normal)
                                                         : *normal);
  double height = 0.0;
  for (int band = 0; band < field_->bands(); ++band) {
    const double highest_per_m = field_->highest_per_m(band) * enlarged_;  // per metre of the grid frame
    const double waves = highest_per_m * per_sample_m;
    if (waves >= kGone || highest_per_m * shortest_m > 1.0) break;
    const double weight = std::clamp((kGone - waves) / (kGone - kWhole), 0.0, 1.0);
    height += weight * field_->height_m(band, place_m, shares);
  }
  return height / enlarged_;
}

void ProfileReader::set_scene(scene::ScenePointer scene) {
  scene_ = std::move(scene);
  grain_.reset();
  window_.reset();
  textured_.reset();
}

std::shared_ptr<const Profile> ProfileReader::update(const haptics::State& state) {
  if (state.window[2] < 2 || state.window[3] < 2) return nullptr;  // no window yet
  const auto made_grain = [this] {
    if (with_grain_ && !grain_) grain_ = std::make_shared<const scene::GrainField>(scene::measure_spectrum(*scene_));
    return grain_;
  };
  if ((state.flags & haptics::kFlagAround) != 0 && scene_->description().charts) {
    const bool texture = (state.flags & haptics::kFlagTexture) != 0;
    window_.reset();
    if (textured_ == texture) return nullptr;
    textured_ = texture;
    return std::make_shared<const ObjectProfile>(scene_, texture, made_grain());
  }
  textured_.reset();
  const ViewProfile::Window window = ViewProfile::window_of(scene_->description(), state);
  if (window_ == window) return nullptr;
  window_ = window;
  return std::make_shared<const ViewProfile>(*scene_, window, made_grain());
}

}  // namespace sparsha::audio
