// Pictures of the viewer for its page and for eyes: viewer_pictures OUT [SCENE...] draws every view and mode.
#include <array>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "base/png/png.h"
#include "tests/viewer/relief_scene.h"
#include "tests/viewer/studio.h"
#include "tests/viewer/views.h"

namespace sparsha::viewer::test {
namespace {

void save(const Image& image, const std::filesystem::path& file) {
  std::vector<std::uint8_t> rgb;
  for (std::size_t k = 0; k + 3 < image.rgba.size(); k += 4)
    rgb.insert(rgb.end(), {image.rgba[k], image.rgba[k + 1], image.rgba[k + 2]});
  PngFormat format;
  format.width = image.width;
  format.height = image.height;
  write_png(file, format, rgb);
}

/// A hand that presses on the middle of the scene, in the window of the overview.
haptics::State hand_on(const scene::Scene& scene, Picture& picture) {
  const scene::SceneDescription& description = scene.description();
  const std::size_t last = description.levels.size() - 1;
  const scene::Lattice& level = description.levels[last];
  const double x_m = level.origin_m.x() + 0.5 * (level.nx - 1) * level.spacing_m;
  const double y_m = level.origin_m.y() + 0.5 * (level.ny - 1) * level.spacing_m;
  haptics::State state = touching(scene, x_m, y_m, picture.height_at(x_m, y_m), x_m, y_m);
  state.level = last;
  state.window = {0, 0, level.nx, level.ny};
  state.scale = 0.1 / ((std::max(level.nx, level.ny) - 1) * level.spacing_m);
  state.hip_m[2] = state.proxy_m[2] - 0.002 / state.scale;
  return state;
}

/// Measures, a pin and parts, set as a person does: by keys and clicks.
void draw_marks(const scene::ScenePointer& scene, const std::filesystem::path& folder, const std::string& name) {
  haptics::AnnouncementBoard board;
  Connections connections;
  connections.announcements = &board;
  connections.save_parts = [](const std::vector<scene::PartConfig>&) { return true; };
  Studio studio(scene, {}, connections);
  const haptics::State state = hand_on(*scene, studio.picture());
  Controller& controller = studio.controller();
  studio.settle(state);
  studio.shoot(state);
  const Layout layout = layout_of(1280, 720, controller.settings());
  const auto point = [&](double u, double v) {
    controller.mouse_move(layout.detail.x + u * layout.detail.width, v * layout.detail.height, layout,
                          studio.picture().detail_view(), studio.picture().stage(), {});
  };
  const auto click = [&](double u, double v) {
    point(u, v);
    controller.mouse_button(0, true, 0);
    controller.mouse_button(0, false, 0);
    studio.settle(state);
  };
  const auto write = [&](Action action, const char* words) {
    controller.act(action);
    studio.settle(state);
    for (const char* c = words; *c != 0; ++c) controller.type(static_cast<char32_t>(*c));
    controller.press({key::kEnter});
    studio.settle(state);
  };
  studio.act(Action::measure);
  click(0.25, 0.25);
  click(0.42, 0.33);
  studio.act(Action::measure);
  click(0.70, 0.22);
  click(0.78, 0.35);
  click(0.66, 0.42);
  studio.act(Action::measure);
  click(0.22, 0.52);
  click(0.78, 0.58);
  studio.act(Action::measure);
  point(0.60, 0.30);
  write(Action::pin, "A chip, 1987");
  point(0.36, 0.72);
  write(Action::add_part, "Outer petal");
  studio.settle(state);
  studio.shoot(state);
  save(studio.shoot(state), folder / (name + "-marks.png"));
  for (const std::string& error : studio.gl_errors()) std::fprintf(stderr, "marks: %s\n", error.c_str());
}

void draw_all(const scene::ScenePointer& scene, const std::filesystem::path& folder, const std::string& name) {
  const auto shoot = [&](const char* what, const std::vector<Action>& actions, int width = 1280, int height = 720) {
    haptics::AnnouncementBoard board;
    Connections connections;
    connections.announcements = &board;
    connections.rescan = [](const Eigen::Matrix4d&) {};
    Studio studio(scene, settings_of(scene->description().config.viewer), connections);
    const haptics::State state = hand_on(*scene, studio.picture());
    studio.shoot(state, width, height);
    for (const Action action : actions) studio.act(action);
    studio.settle(state, width, height);
    studio.shoot(state, width, height);
    save(studio.shoot(state, width, height), folder / (name + "-" + what + ".png"));
    for (const std::string& error : studio.gl_errors()) std::fprintf(stderr, "%s: %s\n", what, error.c_str());
  };
  shoot("first", {});
  shoot("turned", std::vector<Action>(8, Action::turn_left));
  shoot("tilted", std::vector<Action>(12, Action::tilt_down));
  shoot("outline", {Action::outline});
  shoot("height", {Action::colour});
  std::vector<Action> steps;
  for (ColourMode mode = ColourMode::relief;;) {
    mode = next_mode(scene->description(), mode);
    if (mode == ColourMode::relief) break;
    steps.push_back(Action::colour);
    shoot(scene::ViewerConfig::kColourNames[static_cast<std::size_t>(mode)], steps);
  }
  shoot("anaglyph", {Action::stereo});
  shoot("anaglyph-grey", {Action::stereo, Action::stereo});
  shoot("side-by-side", {Action::stereo, Action::stereo, Action::stereo});
  shoot("raking", {Action::light_preset});
  shoot("help", {Action::help});
  shoot("question", {Action::rescan});
  shoot("contrast", {Action::contrast, Action::large_type});
  shoot("small", {Action::figures}, 640, 400);
  shoot("parallel", {Action::orthographic});
  for (int look = 1; look < kLooks; ++look) {
    std::vector<Action> looks(static_cast<std::size_t>(look), Action::look);
    shoot(std::array{"", "sky", "clay", "eye-dome"}[static_cast<std::size_t>(look)], looks);
    looks.insert(looks.end(), 12, Action::tilt_down);
    shoot(std::array{"", "sky-tilted", "clay-tilted", "eye-dome-tilted"}[static_cast<std::size_t>(look)], looks);
  }
  shoot("contours", {Action::contours_finer});
  shoot("section", {Action::section, Action::tilt_down, Action::tilt_down, Action::tilt_down, Action::tilt_down,
                    Action::tilt_down, Action::tilt_down, Action::tilt_down, Action::tilt_down, Action::turn_left,
                    Action::turn_left, Action::turn_left});
  draw_marks(scene, folder, name);
}

}  // namespace
}  // namespace sparsha::viewer::test

int main(int count, char** arguments) {
  using namespace sparsha;
  if (count < 2) {
    std::fputs("usage: viewer_pictures OUT [SCENE...] | viewer_pictures --reference FILE\n", stderr);
    return 2;
  }
  try {
    if (std::string(arguments[1]) == "--reference" && count == 3) {
      viewer::test::save(viewer::test::draw_sheet(), arguments[2]);
      return 0;
    }
    const std::filesystem::path folder = arguments[1];
    std::filesystem::create_directories(folder);
    if (count == 2)
      viewer::test::draw_all(viewer::test::scene_of(viewer::test::lotus, {801, 801, 0.0005, 3}), folder, "lotus");
    for (int k = 2; k < count; ++k)
      viewer::test::draw_all(scene::open_scene(arguments[k]), folder,
                             std::filesystem::path(arguments[k]).filename().string());
  } catch (const std::exception& error) {
    std::fprintf(stderr, "error: %s\n", error.what());
    return 1;
  }
  return 0;
}
