// The list of views, and small pictures of them.
#include "tests/viewer/views.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "tests/viewer/relief_scene.h"

namespace sparsha::viewer::test {
namespace {

std::vector<Action> times(Action action, int count) {
  return std::vector<Action>(static_cast<std::size_t>(count), action);
}

}  // namespace

std::vector<NamedView> all_views() {
  std::vector<NamedView> views{{"first", {}},
                               {"turned", times(Action::turn_left, 8)},
                               {"tilted", times(Action::tilt_down, 12)},
                               {"parallel and tilted", times(Action::tilt_down, 12)},
                               {"closer", times(Action::closer, 4)},
                               {"outline", {Action::outline}},
                               {"filled", {Action::filled}},
                               {"contrast", {Action::contrast}},
                               {"anaglyph", {Action::stereo}},
                               {"anaglyph in grey", times(Action::stereo, 2)},
                               {"side by side", times(Action::stereo, 3)},
                               {"eyes swapped", {Action::stereo, Action::swap_eyes}},
                               {"sky light", {Action::look}},
                               {"clay", times(Action::look, 2)},
                               {"clay, tilted", times(Action::look, 2)},
                               {"edges of depth", times(Action::look, 3)},
                               {"contours", {Action::contours_finer}},
                               {"finer contours", times(Action::contours_finer, 2)},
                               {"section", {Action::section}}};
  const std::vector<Action> tilt = times(Action::tilt_down, 10);
  views[3].actions.push_back(Action::orthographic);
  views[14].actions.insert(views[14].actions.end(), tilt.begin(), tilt.end());
  views[18].actions.insert(views[18].actions.end(), tilt.begin(), tilt.end());
  for (int preset = 1; preset <= 5; ++preset)
    views.push_back({"light " + std::to_string(preset), times(Action::light_preset, preset)});
  for (int map = 1; map < static_cast<int>(scene::ViewerConfig::kColourNames.size()); ++map)
    views.push_back({scene::ViewerConfig::kColourNames[static_cast<std::size_t>(map)], times(Action::colour, map)});
  return views;
}

scene::ScenePointer exhibit() {
  const auto edit = [](scene::SceneDescription& description) {
    description.has_envelope = description.has_colour = description.has_curvature = true;
    description.config.friction.emplace();
    description.friction_c_m = 0.01;
    auto map = std::make_shared<scene::CheckMap>();
    map->lattice = {40, 40, 0.01, {0.005, 0.005, 0.0}};
    for (int j = 0; j < 40; ++j)
      for (int i = 0; i < 40; ++i)
        map->error_m.push_back(1e-4F * static_cast<float>(1.0 + std::sin(0.3 * i) * std::cos(0.25 * j)));
    map->high_m = 2e-4;
    description.check_map = map;
  };
  const auto layers = [](scene::Layers& l) {
    const scene::Lattice& lattice = l.grid.lattice;
    l.envelope_m.resize(lattice.count());
    l.curvature_per_m.resize(lattice.count());
    l.colour_rgba.resize(lattice.count());
    for (int j = 0; j < lattice.ny; ++j)
      for (int i = 0; i < lattice.nx; ++i) {
        const std::size_t k = lattice.index(i, j);
        const double x = i * lattice.spacing_m, y = j * lattice.spacing_m;
        l.envelope_m[k] = l.grid.height_m[k] - static_cast<float>(0.0003 * std::sin(400.0 * x) * std::sin(300.0 * y));
        l.curvature_per_m[k] = static_cast<float>(30.0 + 30.0 * std::sin(60.0 * x));
        const auto byte = [](double share) { return static_cast<std::uint32_t>(60.0 + 180.0 * share); };
        l.colour_rgba[k] =
            0xFF000000U | byte(0.5 + 0.5 * std::sin(40.0 * x)) | byte(x / 0.4) << 8U | byte(y / 0.4) << 16U;
        if (std::hypot(x - 0.30, y - 0.31) < 0.025 && l.grid.state[k] != scene::NodeState::unknown)
          l.grid.state[k] = scene::NodeState::filled;
      }
  };
  const auto height = [](double x_m, double y_m) {
    return std::hypot(x_m - 0.09, y_m - 0.10) < 0.03 ? std::numeric_limits<double>::quiet_NaN() : lotus(x_m, y_m);
  };
  return scene_of(height, {401, 401, 0.001, 2}, edit, layers);
}

Image draw_small(const scene::ScenePointer& scene, const NamedView& view) {
  constexpr int kFactor = 4, kWidth = kFactor * kSmallWidth, kHeight = kFactor * kSmallHeight;
  Studio studio(scene);
  haptics::State state = touching(*scene, 0.24, 0.22, studio.picture().height_at(0.24, 0.22), 0.2, 0.2);
  state.level = 1;
  state.window = {0, 0, 201, 201};
  state.scale = 0.25;
  studio.shoot_bare(state, kWidth, kHeight);
  for (const Action action : view.actions) studio.act(action);
  studio.settle(state, kWidth, kHeight);
  studio.shoot_bare(state, kWidth, kHeight);  // reads the finer piece
  const Image large = studio.shoot_bare(state, kWidth, kHeight);
  Image small{kSmallWidth, kSmallHeight, std::vector<unsigned char>(4U * kSmallWidth * kSmallHeight, 255)};
  for (int y = 0; y < kSmallHeight; ++y)
    for (int x = 0; x < kSmallWidth; ++x) {
      Pixel sum;
      for (int b = 0; b < kFactor; ++b)
        for (int a = 0; a < kFactor; ++a) {
          const Pixel p = large.at(kFactor * x + a, kFactor * y + b);
          sum = {sum.r + p.r, sum.g + p.g, sum.b + p.b};
        }
      unsigned char* out = small.rgba.data() + 4 * (y * kSmallWidth + x);
      constexpr int kCount = kFactor * kFactor;
      out[0] = static_cast<unsigned char>((sum.r + kCount / 2) / kCount);
      out[1] = static_cast<unsigned char>((sum.g + kCount / 2) / kCount);
      out[2] = static_cast<unsigned char>((sum.b + kCount / 2) / kCount);
    }
  return small;
}

Image draw_sheet() {
  const std::vector<NamedView> views = all_views();
  const auto scene = exhibit();
  const int rows = (static_cast<int>(views.size()) + kSheetColumns - 1) / kSheetColumns;
  Image sheet{kSheetColumns * kSmallWidth, rows * kSmallHeight, {}};
  sheet.rgba.assign(4U * static_cast<std::size_t>(sheet.width) * static_cast<std::size_t>(sheet.height), 255);
  for (std::size_t k = 0; k < views.size(); ++k) {
    const Image small = draw_small(scene, views[k]);
    const auto column = static_cast<std::size_t>(k) % kSheetColumns, row = k / kSheetColumns;
    for (std::size_t y = 0; y < kSmallHeight; ++y)
      std::copy_n(small.rgba.begin() + static_cast<std::ptrdiff_t>(4 * y * kSmallWidth), 4 * kSmallWidth,
                  sheet.rgba.begin() + static_cast<std::ptrdiff_t>(
                                           4 * ((row * kSmallHeight + y) * static_cast<std::size_t>(sheet.width) +
                                                column * kSmallWidth)));
  }
  return sheet;
}

Image of_sheet(const Image& sheet, std::size_t view) {
  Image small{kSmallWidth, kSmallHeight, std::vector<unsigned char>(4U * kSmallWidth * kSmallHeight, 255)};
  const std::size_t column = view % kSheetColumns, row = view / kSheetColumns;
  for (std::size_t y = 0; y < kSmallHeight; ++y)
    std::copy_n(sheet.rgba.begin() +
                    static_cast<std::ptrdiff_t>(
                        4 * ((row * kSmallHeight + y) * static_cast<std::size_t>(sheet.width) + column * kSmallWidth)),
                4 * kSmallWidth, small.rgba.begin() + static_cast<std::ptrdiff_t>(4 * y * kSmallWidth));
  return small;
}

}  // namespace sparsha::viewer::test
